"""A mesh on real links."""
