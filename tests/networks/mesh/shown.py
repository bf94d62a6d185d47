"""Frames and payloads as pairs of names and values in the order of the bytes, by the layouts."""

from innervate.networks.mesh.frames import COMMON, HOP_ACK, VERSION, acked
from innervate.networks.mesh.payloads import FIELDS, PIECE, begin_of, end_of, fits, is_piece
from innervate.networks.mesh.protocol.constants import ACK, ALL, DATA, ORDERED, SOURCE_ROUTE
from innervate.wire.layout import read


def fields(frame):
    """A frame record: numbers, lists of numbers, and for groups lists of such pairs.

    A source route and failed nodes around the payload are pairs of their own.
    """
    kind = frame.kind
    pairs = [("version", VERSION), ("kind", kind)]
    for name, _many, _bits, _signed in HOP_ACK if kind == ACK else COMMON:
        pairs.append((name, getattr(frame, name)))
    if kind == ACK and frame.length:
        pairs.append(("more", [[("origin", who), ("seq", seq)] for who, seq in acked(frame)[1:]]))
    if kind != ACK:
        pairs.append(("path", list(frame.path[: frame.path_len])))
        body = bytes(list(frame.body[: frame.length]))
        is_ordered = kind == DATA and frame.flags & ORDERED and frame.dest != ALL
        if is_ordered and is_piece(frame.flags, frame.seq, body):
            read(PIECE, body, 0, 8 * len(body), pairs)
        else:
            pairs.extend(describe(kind, frame.flags, body))
    return pairs


def describe(kind, flags, data):
    """A payload; one that does not fit is ("payload", its bytes)."""
    end = len(data)
    if kind not in FIELDS or not fits(kind, flags, data, 0, end):
        return [("payload", list(data))]
    begin = begin_of(flags, data, 0, end)
    stop = end_of(kind, flags, data, begin, end)
    found = []
    if flags & SOURCE_ROUTE:
        found.append(("source_route", list(data[1:begin])))
    read(FIELDS[kind], data, 8 * begin, 8 * stop, found)
    if stop < end:
        found.append(("failed", list(data[stop : end - 1])))
    return found
