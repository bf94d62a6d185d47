"""Frames of the mesh [mesh 2]: a common header, the path so far, a payload, a CRC; hop acks.

The tables here and in payloads.py are the one description: encoder, decoder and whatever else
speaks of the bytes read them. A payload has no length of its own: it ends where the CRC begins, so
that a medium must say where a frame ends (a CRC alone does not see a zero behind it).
"""

from innervate.networks.mesh.payloads import FIELDS, NAMES, describe, fits
from innervate.networks.mesh.protocol.constants import (
    ACK,
    ACK_BYTES,
    BODY,
    CRC_BYTES,
    HEADER_BYTES,
    PATH_MAX,
)
from innervate.wire.bits import put
from innervate.wire.crc import is_sealed, seal
from innervate.wire.layout import REST, pack, put_number, unpack

VERSION = 1
MTU_MAX = 127

HEAD = (("version", 0, 2, 0), ("kind", 0, 6, 0))
COMMON = (
    ("flags", 0, 8, 0),
    ("link_src", 0, 8, 0),
    ("link_dst", 0, 8, 0),
    ("origin", 0, 8, 0),
    ("dest", 0, 8, 0),
    ("seq", 0, 16, 0),
    ("table_ver", 0, 8, 0),
    ("ttl", 0, 8, 0),
    ("path_len", 0, 8, 0),
)
HOP_ACK = (
    ("link_src", 0, 8, 0),
    ("link_dst", 0, 8, 0),
    ("origin", 0, 8, 0),
    ("seq", 0, 16, 0),
    ("rssi", 0, 8, 1),
)
CRC = (("crc", 0, 16, 0),)
# The two forms of a whole frame.
PACKET = HEAD + COMMON + (("path", "path_len", 8, 0), ("payload", REST, 8, 0)) + CRC
WHOLE_ACK = HEAD + HOP_ACK + CRC
AT = 8  # bits of HEAD
PATH_LEN_AT = HEADER_BYTES - 1

# What decode says: read, or why not. Receivers count by these.
OK = 0
BAD_LENGTH = 1  # too short for its kind, or longer than the MTU
BAD_CRC = 2
BAD_VERSION = 3
BAD_KIND = 4
BAD_PATH = 5  # more than 24 nodes
BAD_PAYLOAD = 6  # not what its kind has
REASONS = ("ok", "length", "crc", "version", "kind", "path", "payload")


def size_of(frame: object) -> int:
    """Bytes of a frame record on the wire."""
    if frame.kind == ACK:  # type: ignore[attr-defined]
        return ACK_BYTES  # type: ignore[no-any-return]
    size = HEADER_BYTES + frame.path_len + frame.length + CRC_BYTES  # type: ignore[attr-defined]
    return size  # type: ignore[no-any-return]


def encode(frame: object, mtu: int = MTU_MAX) -> bytes:
    """The bytes of a frame record.

    Raises:
        ValueError: the kind is none of ours, a value does not fit, the frame is longer than the
            MTU; the caller's mistake.
    """
    kind = frame.kind  # type: ignore[attr-defined]
    if kind != ACK and kind not in FIELDS:
        raise ValueError("no packet of the mesh has this kind")
    for name, most in (("path_len", PATH_MAX), ("length", BODY)):
        if kind != ACK and not 0 <= getattr(frame, name) <= most:
            raise ValueError(name + " is more than a packet holds, or negative")
    size = size_of(frame)
    if size > mtu:
        raise ValueError("the frame is longer than the MTU")
    buffer = bytearray(size)
    put(buffer, 0, AT, VERSION << 6 | kind)
    if kind == ACK:
        pack(HOP_ACK, buffer, AT, frame)
    else:
        at = pack(COMMON, buffer, AT, frame)
        for name, count in (("path", "path_len"), ("body", "length")):
            items = getattr(frame, name)
            for i in range(getattr(frame, count)):
                put_number(buffer, at, 8, 0, items[i], name)
                at += 8
    return seal(buffer)


def reason_of(data: bytes | bytearray | memoryview, mtu: int = MTU_MAX) -> int:
    """OK if these bytes are a frame, else why not; any bytes at all will do."""
    size = len(data)
    if not ACK_BYTES <= size <= mtu:
        return BAD_LENGTH
    if not is_sealed(data):
        return BAD_CRC
    if data[0] >> 6 != VERSION:
        return BAD_VERSION
    kind = data[0] & 63
    if kind == ACK:
        return OK if size == ACK_BYTES else BAD_LENGTH
    if kind not in FIELDS:
        return BAD_KIND
    end = size - CRC_BYTES
    if end < HEADER_BYTES:
        return BAD_LENGTH
    if data[PATH_LEN_AT] > PATH_MAX:
        return BAD_PATH
    at = HEADER_BYTES + data[PATH_LEN_AT]
    if not at <= end <= at + BODY:
        return BAD_LENGTH
    return OK if fits(kind, data[1], data, at, end) else BAD_PAYLOAD


def decode(data: bytes | bytearray | memoryview, frame: object, mtu: int = MTU_MAX) -> int:
    """Read received bytes into a frame record; any bytes at all will do.

    Sets everything but `rssi`, which is the receiver's, and of `path` and `body` what is used. An
    ack has its own `rssi`, that of the frame it is for, and what it does not carry is set to 0,
    `dest` to whom it is for. Returns OK, or else the reason, with `frame` as it was.
    """
    reason = reason_of(data, mtu)
    if reason != OK:
        return reason
    frame.kind = data[0] & 63  # type: ignore[attr-defined]
    if frame.kind == ACK:  # type: ignore[attr-defined]
        for name in ("flags", "table_ver", "ttl", "path_len", "length"):
            setattr(frame, name, 0)
        unpack(HOP_ACK, data, AT, frame)
        frame.dest = frame.link_dst  # type: ignore[attr-defined]
        return OK
    unpack(COMMON, data, AT, frame)
    at = HEADER_BYTES
    for i in range(frame.path_len):  # type: ignore[attr-defined]
        frame.path[i] = data[at]  # type: ignore[attr-defined]
        at += 1
    frame.length = len(data) - CRC_BYTES - at  # type: ignore[attr-defined]
    for i in range(frame.length):  # type: ignore[attr-defined]
        frame.body[i] = data[at]  # type: ignore[attr-defined]
        at += 1
    return OK


def fields(frame: object) -> list:  # type: ignore[type-arg]
    """A frame record as (name, value) pairs in the order of the bytes, for display.

    Numbers, lists of numbers, and for groups lists of such pairs. A source route and failed nodes
    around the payload are pairs of their own; a payload that is too short is given as it is.
    """
    kind = frame.kind  # type: ignore[attr-defined]
    pairs = [("version", VERSION), ("kind", kind)]
    for name, _many, _bits, _signed in HOP_ACK if kind == ACK else COMMON:
        pairs.append((name, getattr(frame, name)))
    if kind != ACK:
        pairs.append(("path", list(frame.path[: frame.path_len])))  # type: ignore[attr-defined]
        body = bytes(list(frame.body[: frame.length]))  # type: ignore[attr-defined]
        pairs.extend(describe(kind, frame.flags, body))  # type: ignore[attr-defined]
    return pairs


def name_of(kind: int) -> str:
    """What a type of packet is called."""
    return "ack" if kind == ACK else NAMES.get(kind, "unknown")
