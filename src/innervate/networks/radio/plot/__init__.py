"""Pictures and reports of a radio team."""
