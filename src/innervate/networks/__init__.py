"""The networks: one folder each, with the same plan inside."""
