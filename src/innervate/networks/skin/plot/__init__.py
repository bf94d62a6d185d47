"""Pictures and reports of a skin."""
