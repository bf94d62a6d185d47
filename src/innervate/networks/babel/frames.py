"""Frames of Babel on cables: the kind, then these fields, most significant bit first, and a CRC.

So it is simulated, and between boards: what stands in a Hello, an IHU and an Update of RFC 8966, in
the form of frames like the skin's, so that both have the same wire. The longest has 149 bits. Live
nodes send the RFC's own packets (`packets.py`).
"""

KIND_BITS = 4
ROUTE = (("seq", 0, 16, 0), ("metric", 0, 16, 0), ("update", 0, 16, 0))
WHO = (("source", 0, 16, 0),)
# Hello and IHU, perhaps with an Update; the IHU interval is three times the Hello's [appendix B].
HELLO = (("hello_no", 0, 16, 0), ("hello", 0, 16, 0), ("rxcost", 0, 16, 0), ("has_update", 0, 1, 0))
LAYOUTS = (
    (1, "hello", (*WHO, *HELLO, *ROUTE)),
    (2, "update", (*WHO, *ROUTE)),
    (3, "route request", WHO),
    (4, "seqno request", (*WHO, ("seq", 0, 16, 0), ("hops", 0, 8, 0))),
    (5, "data", (*WHO, ("hops", 0, 8, 0), ("value", 0, 16, 0))),
    (6, "ihu", (*WHO, ("hello", 0, 16, 0), ("rxcost", 0, 16, 0))),
    (7, "ack request", (*WHO, ("value", 0, 16, 0), ("hello", 0, 16, 0))),
    (8, "ack", (*WHO, ("value", 0, 16, 0))),
)
