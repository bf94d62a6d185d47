"""A network that no file of the toolkit knows: a token that goes round a ring of cables."""
