"""Payloads of the mesh's packets [mesh 2], by type, and what forwarding puts around them."""

from innervate.networks.mesh.protocol import constants as const
from innervate.wire.layout import PAIRS, REST, is_fixed, read, width

NEIGHBOUR = (("id", 0, 8, 0), ("rssi", 0, 8, 1))
GROUP = (("next", 0, 8, 0), ("alt", 0, 8, 0), ("count", 0, 8, 0), ("dests", "count", 8, 0))
MOVING = (("x", 0, 16, 1), ("y", 0, 16, 1), ("vx", 0, 8, 1), ("vy", 0, 8, 1))
VERSION = (("epoch", 0, 8, 0), ("table_version", 0, 16, 0))
PART = VERSION + (("fragment", 0, 4, 0), ("fragments", 0, 4, 0))
ROUTE = (("route_len", 0, 8, 0), ("route", "route_len", 8, 0))

ASKING = (
    ("gateway", 0, 8, 0), ("epoch", 0, 8, 0), ("round", 0, 16, 0), ("active", 0, 16, 0),
    ("jitter", 0, 8, 0), ("asked", REST, 8, 0),
)  # fmt: skip
ANSWERING = (
    ("epoch", 0, 8, 0), ("round", 0, 16, 0), ("mode", 0, 4, 0), ("listed", 0, 4, 0),
    ("neighbours", REST, NEIGHBOUR, 0),
)  # fmt: skip
RAISED = (("robot", 0, 8, 0), ("fence", 0, 8, 0), ("number", 0, 8, 0), ("alarm", 0, 8, 0))

# A payload: value of the type, name, fields (see layout.py).
LAYOUTS = (
    (const.REQUEST, "request", ASKING),
    (const.RESPONSE, "response", ANSWERING),
    (const.TABLE, "table", ROUTE + PART + (("groups", REST, GROUP, 0),)),
    (const.TABLE_ACK, "table ack", VERSION + (("parts", 0, 16, 0),)),
    (const.ACTIVATE, "activate", VERSION),
    (const.DATA, "data", (("data", REST, 8, 0),)),
    (const.E2E_ACK, "end-to-end ack", (("acked", REST, 16, 0),)),
    (const.ALARM, "alarm", RAISED + MOVING + (("time", 0, 32, 0), ("margin", 0, 16, 1))),
    (const.POSITION, "position", (("robot", 0, 8, 0),) + MOVING + (("said", 0, 8, 0),)),
    (const.GRAPH, "graph", PART + (("part", REST, 8, 0),)),
)
# The payload of an ORDERED packet that is a piece of a message: no message is PIECE_AHEAD numbers
# ahead of the one before it, which is what stands there else.
PIECE = (
    ("mark", 0, 16, 0), ("message", 0, 16, 0), ("in_order", 0, 8, 0), ("at", 0, 16, 0),
    ("size", 0, 16, 0), ("data", REST, 8, 0),
)  # fmt: skip
PIECE_STRUCT = ">HHBHH"  # the same for struct, without its data
PIECE_AHEAD = 16_384
# What the parts of a graph are when put together: the links of every pair a < b, row by row.
WHOLE_GRAPH = (("nodes", 0, 8, 0), ("ids", "nodes", 8, 0), ("links", PAIRS, 1, 0))

NAMES = {kind: name for kind, name, _fields in LAYOUTS}
FIELDS = {kind: fields for kind, _name, fields in LAYOUTS}
# Bytes of payloads of fixed length; the others are read to the end.
SIZES = {kind: (width(fields) + 7) // 8 for kind, _name, fields in LAYOUTS if is_fixed(fields)}


def begin_of(flags: int, data: bytes | bytearray | memoryview, at: int, end: int) -> int:
    """Where the origin's own payload begins: behind a source route [mesh 8]."""
    return at + 1 + data[at] if flags & const.SOURCE_ROUTE and at < end else at


def end_of(kind: int, flags: int, data: bytes | bytearray | memoryview, at: int, end: int) -> int:
    """Where it ends: in front of the failed nodes and their number, if there are any [mesh 8].

    With tables DETOURED is a mark and nothing else. No frame says whether there are tables: where
    both can be, we take the last bytes for failed nodes.
    """
    if flags & const.DETOURED and at < end and data[end - 1] > 0:
        stop = end - 1 - data[end - 1]
        if is_whole(kind, data, at, stop):
            return stop
    return end


def is_whole(kind: int, data: bytes | bytearray | memoryview, at: int, end: int) -> bool:
    """True if bytes `at` to `end` are exactly a payload of this kind."""
    if kind in SIZES:
        return end - at == SIZES[kind]
    if kind == const.E2E_ACK:  # the most frequent of them
        return at <= end and (end - at) % 2 == 0
    return at <= end and read(FIELDS[kind], data, 8 * at, 8 * end, []) == 8 * end


def fits(kind: int, flags: int, data: bytes | bytearray | memoryview, at: int, end: int) -> bool:
    """True if bytes `at` to `end` are a payload of this kind and what forwarding puts around."""
    begin = begin_of(flags, data, at, end)
    if kind == const.DATA:
        return begin <= end
    return is_whole(kind, data, begin, end_of(kind, flags, data, begin, end))


def is_piece(flags: int, seq: int, data: bytes) -> bool:
    """True if the payload of ORDERED packet `seq` to one recipient is a piece of a message."""
    if flags & const.SOURCE_ROUTE or 8 * len(data) <= width(PIECE):
        return False
    return int.from_bytes(data[:2], "big") == (seq + PIECE_AHEAD) & 65_535
