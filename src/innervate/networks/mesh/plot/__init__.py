"""Pictures and reports of a mesh."""
