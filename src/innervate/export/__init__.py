"""Networks and runs as files that other tools open: captures, recordings, graphs, tables."""
