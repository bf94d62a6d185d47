"""Frames of the mesh [mesh 2]: a common header, the path so far, a payload, a CRC; hop acks.

The tables here and in payloads.py are the one description: encoder, decoder and whatever else
speaks of the bytes read them. A payload has no length of its own: it ends where the CRC begins, so
that a medium must say where a frame ends (a CRC alone does not see a zero behind it).
"""

import struct
from typing import Any

from innervate.networks.mesh.payloads import FIELDS, fits
from innervate.networks.mesh.protocol.constants import (
    ACK,
    ACK_BYTES,
    ACK_MORE_BYTES,
    CRC_BYTES,
    HEADER_BYTES,
    MTU,
    PATH_MAX,
)
from innervate.wire.crc import crc16, is_sealed
from innervate.wire.layout import REST, pack, put_number

VERSION = 1

HEAD = (("version", 0, 2, 0), ("kind", 0, 6, 0))
COMMON = (
    ("flags", 0, 8, 0), ("link_src", 0, 8, 0), ("link_dst", 0, 8, 0), ("origin", 0, 8, 0),
    ("dest", 0, 8, 0), ("seq", 0, 16, 0), ("table_ver", 0, 8, 0), ("ttl", 0, 8, 0),
    ("path_len", 0, 8, 0),
)  # fmt: skip
HOP_ACK = (
    ("link_src", 0, 8, 0), ("link_dst", 0, 8, 0), ("origin", 0, 8, 0), ("seq", 0, 16, 0),
    ("rssi", 0, 8, 1),
)  # fmt: skip
# Hops that acknowledge several packets at once name the others behind the first.
MORE = (("more", REST, (("origin", 0, 8, 0), ("seq", 0, 16, 0)), 0),)
CRC = (("crc", 0, 16, 0),)
# The two forms of a whole frame.
PACKET = HEAD + COMMON + (("path", "path_len", 8, 0), ("payload", REST, 8, 0)) + CRC
WHOLE_ACK = HEAD + HOP_ACK + MORE + CRC
# The same for struct, which is quicker: HEAD and COMMON, HEAD and HOP_ACK.
PACKET_STRUCT = ">BBBBBBHBBB"
ACK_STRUCT = ">BBBBHb"
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


def size_of(frame: Any) -> int:
    """Bytes of a frame record on the wire."""
    if frame.kind == ACK:
        return int(ACK_BYTES + frame.length)
    size = HEADER_BYTES + frame.path_len + frame.length + CRC_BYTES
    return size  # type: ignore[no-any-return]


def encode(frame: Any, mtu: int = MTU) -> bytes:
    """The bytes of a frame record.

    Raises:
        ValueError: the kind is none of ours, a value does not fit, the frame is longer than the
            MTU; the caller's mistake.
    """
    kind = frame.kind
    if kind != ACK and kind not in FIELDS:
        raise ValueError("no packet of the mesh has this kind")
    for name, most in (("path_len", PATH_MAX), ("length", len(frame.body))):
        if kind != ACK and not 0 <= getattr(frame, name) <= most:
            raise ValueError(name + " is more than a packet holds, or negative")
    size = size_of(frame)
    if size > mtu:
        raise ValueError("the frame is longer than the MTU")
    try:
        data = (_ack if kind == ACK else _packet)(frame, VERSION << 6 | kind)
    except (struct.error, ValueError):
        check(frame)
        raise
    crc = crc16(data, len(data))
    return data + bytes((crc >> 8, crc & 255))


def _packet(frame: Any, first: int) -> bytes:
    # Field by field: by their names it takes half as long again, and every frame comes through.
    f = frame
    head = struct.pack(PACKET_STRUCT, first, f.flags, f.link_src, f.link_dst, f.origin, f.dest,
                       f.seq, f.table_ver, f.ttl, f.path_len)  # fmt: skip
    return head + bytes(f.path[: f.path_len]) + bytes(f.body[: f.length])


def _ack(frame: Any, first: int) -> bytes:
    f = frame
    head = struct.pack(ACK_STRUCT, first, f.link_src, f.link_dst, f.origin, f.seq, f.rssi)
    return head + bytes(f.body[: f.length])


def check(frame: Any) -> None:
    """Refuse, by its name, a value of a record that does not fit: a ValueError."""
    is_ack = frame.kind == ACK
    pack(HOP_ACK if is_ack else COMMON, bytearray(MTU), AT, frame)
    parts = (("body", frame.length), ("path", 0 if is_ack else frame.path_len))
    for name, count in parts:
        for item in getattr(frame, name)[:count]:
            put_number(bytearray(1), 0, 8, 0, item, name)


def reason_of(data: bytes | bytearray | memoryview, mtu: int = MTU) -> int:
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
        return OK if (size - ACK_BYTES) % ACK_MORE_BYTES == 0 else BAD_LENGTH
    if kind not in FIELDS:
        return BAD_KIND
    end = size - CRC_BYTES
    if end < HEADER_BYTES:
        return BAD_LENGTH
    if data[PATH_LEN_AT] > PATH_MAX:
        return BAD_PATH
    at = HEADER_BYTES + data[PATH_LEN_AT]
    if end < at:
        return BAD_LENGTH
    return OK if fits(kind, data[1], data, at, end) else BAD_PAYLOAD


def decode(data: bytes | bytearray | memoryview, frame: Any, mtu: int = MTU) -> int:
    """Read received bytes into a frame record; any bytes at all will do.

    Sets everything but `rssi`, which is the receiver's, and of `path` and `body` what is used. An
    ack has its own `rssi`, that of the frame it is for, and what it does not carry is set to 0,
    `dest` to whom it is for. Returns OK, or else the reason, with `frame` as it was.
    """
    reason = reason_of(data, mtu)
    if reason != OK:
        return reason
    if data[0] & 63 == ACK:
        decode_ack(data, frame)
        return OK
    if len(data) - CRC_BYTES - HEADER_BYTES - data[PATH_LEN_AT] > len(frame.body):
        return BAD_LENGTH
    f = frame
    (first, f.flags, f.link_src, f.link_dst, f.origin, f.dest,
     f.seq, f.table_ver, f.ttl, hops) = struct.unpack_from(PACKET_STRUCT, data)  # fmt: skip
    frame.kind = first & 63
    frame.path_len = hops
    at = HEADER_BYTES + hops
    frame.path[:hops] = list(data[HEADER_BYTES:at])
    frame.length = length = len(data) - CRC_BYTES - at
    frame.body[:length] = list(data[at : at + length])
    return OK


def decode_ack(data: bytes | bytearray | memoryview, frame: Any) -> None:
    """Read an ack that is one, as `decode` says."""
    f = frame
    (first, f.link_src, f.link_dst, f.origin,
     f.seq, f.rssi) = struct.unpack_from(ACK_STRUCT, data)  # fmt: skip
    frame.kind = first & 63
    frame.dest = frame.link_dst
    frame.flags = frame.table_ver = frame.ttl = frame.path_len = 0
    frame.length = length = len(data) - ACK_BYTES
    frame.body[:length] = list(data[ACK_BYTES - CRC_BYTES : len(data) - CRC_BYTES])


def acked(frame: Any) -> list:  # type: ignore[type-arg]
    """The packets, as (origin, seq), that an ack's record names."""
    pairs = [(frame.origin, frame.seq)]
    for at in range(0, frame.length, ACK_MORE_BYTES):
        pairs.append((frame.body[at], frame.body[at + 1] << 8 | frame.body[at + 2]))
    return pairs
