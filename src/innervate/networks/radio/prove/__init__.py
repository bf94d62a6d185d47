"""What is proved of a radio station; most is not (docs/prove.md)."""
