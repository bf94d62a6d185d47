"""Frames of managed flooding: Meshtastic's header with the short addresses that our fields have."""

KIND_BITS = 4
HEADER = (
    ("want", 0, 1, 0), ("hops", 0, 3, 0), ("start", 0, 3, 0), ("", 0, 5, 0),
    ("origin", 0, 8, 0), ("dest", 0, 8, 0), ("id", 0, 16, 0),
)  # fmt: skip
ENDS = ("origin", "dest", 255)  # of the whole way: who passes a packet on is not in it
LAYOUTS = ((1, "packet", (*HEADER, ("body", 8, 16, 0))), (2, "ack", (*HEADER, ("ack", 0, 16, 0))))
