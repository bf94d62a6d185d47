"""What is proved of the mesh's duplicate caches, for any network (docs/prove.md)."""
