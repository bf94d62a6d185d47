"""A skin on real links."""
