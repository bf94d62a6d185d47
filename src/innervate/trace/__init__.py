"""What a run records: rows, tables, provenance, fingerprint, named random streams."""
