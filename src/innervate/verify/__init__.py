"""The explorer: every interleaving of the very functions that run live, on small networks."""
