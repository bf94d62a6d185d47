"""Frames of ALOHA."""

KIND_BITS = 4
HEAD = (("slots", 0, 4, 0), ("source", 0, 10, 0))
TO = (("to", 0, 10, 0), ("seq", 0, 8, 0))
LAYOUTS = (
    (1, "beacon", HEAD),
    (2, "message", (*HEAD, *TO, ("value", 0, 8, 0))),
    (3, "ack", (*HEAD, *TO)),
)
