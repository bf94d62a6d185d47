"""A radio team on real links."""
