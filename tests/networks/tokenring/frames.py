"""Frames of a token ring."""

KIND_BITS = 4
LAYOUTS = ((1, "token", (("lap", 0, 16, 0), ("load", 2, 8, 0))),)
