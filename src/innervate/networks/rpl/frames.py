"""Frames of RPL: its messages without IPv6 addresses and options, which all nodes know.

A hop's addresses and number are as in IEEE 802.15.4, a node's address in a packet one byte. A
source route has room for 4 hops or for 16, without the first.
"""

KIND_BITS = 4
ADDRESS = (("to", 0, 16, 0), ("src", 0, 8, 0))
NUMBERED = (*ADDRESS, ("", 0, 4, 0), ("dsn", 0, 8, 0))
PACKET = (  # with the RPL Packet Information [RFC 6550, 11.2]
    *NUMBERED, ("origin", 0, 8, 0), ("dest", 0, 8, 0), ("hops", 0, 8, 0), ("down", 0, 1, 0),
    ("error", 0, 1, 0), ("back", 0, 1, 0), ("", 0, 5, 0), ("sender_rank", 0, 16, 0),
)  # fmt: skip
BODY = (("body", 8, 16, 0),)
LENGTH = (("length", 0, 8, 0), ("next", 0, 8, 0))
NEAR = (*LENGTH, ("near", 4, 8, 0))
FAR = (*NEAR, ("far", 12, 8, 0))
PATH = (("path", 0, 8, 0),)
INFO = (("info", 0, 8, 0),)
ENDS = ("src", "to", 65535)  # of a hop
DIO = (
    *ADDRESS, ("", 0, 1, 0), ("mop", 0, 3, 0), ("version", 0, 8, 0), ("rank", 0, 16, 0),
    ("dtsn", 0, 8, 0),
)  # fmt: skip
LAYOUTS = (
    (1, "dio", DIO),
    (2, "dis", ADDRESS),
    (3, "dao", (*NUMBERED, ("life", 0, 8, 0), ("targets", 4, 8, 0), ("paths", 4, 8, 0))),
    (4, "ack", NUMBERED),
    (5, "data", (*PACKET, *BODY)),
    (6, "data near", (*PACKET, *NEAR, *BODY)),
    (7, "data far", (*PACKET, *FAR, *BODY)),
    (8, "dao ack", (*PACKET, *PATH)),
    (9, "dao ack near", (*PACKET, *NEAR, *PATH)),
    (10, "dao ack far", (*PACKET, *FAR, *PATH)),
    (11, "dao up", (*PACKET, *INFO, *PATH)),
    (12, "route error", (*PACKET, *INFO)),
)
