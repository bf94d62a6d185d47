"""Frames of the mesh [mesh 2]: 11 bytes of header, path, payload, CRC; hop acks are shorter."""

from innervate.protocol.mesh_words import (
    ACK,
    ACK_BYTES,
    BODY,
    CRC_BYTES,
    HEADER_BYTES,
    PATH_MAX,
)
from innervate.wire.crc import crc16

VERSION = 1
OK = 0
BAD_LENGTH = 1
BAD_CRC = 2
BAD_KIND = 3
BAD_VERSION = 4
REASONS = ("ok", "length", "crc", "kind", "version")


def encode(frame):
    n = frame.path_len
    if frame.kind == ACK:
        data = bytes((VERSION << 6 | ACK, frame.link_src, frame.link_dst, frame.origin,
                      frame.seq >> 8, frame.seq & 255, frame.rssi & 255))
    else:
        data = bytes((VERSION << 6 | frame.kind, frame.flags, frame.link_src, frame.link_dst,
                      frame.origin, frame.dest, frame.seq >> 8, frame.seq & 255,
                      frame.table_ver, frame.ttl, n, *frame.path[:n], *frame.body[:frame.length]))
    crc = crc16(data, len(data))
    return data + bytes((crc >> 8, crc & 255))


def decode(data, frame):
    size = len(data)
    if size < ACK_BYTES or size > HEADER_BYTES + CRC_BYTES + BODY + 1:
        return BAD_LENGTH
    body = size - CRC_BYTES
    if crc16(data, body) != data[body] << 8 | data[body + 1]:
        return BAD_CRC
    if data[0] >> 6 != VERSION:
        return BAD_VERSION
    kind = data[0] & 63
    if kind == ACK:
        if size != ACK_BYTES:
            return BAD_LENGTH
        frame.kind = ACK
        frame.link_src = data[1]
        frame.link_dst = data[2]
        frame.origin = data[3]
        frame.seq = data[4] << 8 | data[5]
        frame.rssi = data[6] - ((data[6] & 128) << 1)
        frame.path_len = 0
        frame.length = 0
        return OK
    if size < HEADER_BYTES + CRC_BYTES:
        return BAD_LENGTH
    n = data[10]
    if n > PATH_MAX or size < HEADER_BYTES + n + CRC_BYTES or size - HEADER_BYTES - n - CRC_BYTES > BODY:
        return BAD_LENGTH
    frame.kind = kind
    (frame.flags, frame.link_src, frame.link_dst, frame.origin, frame.dest) = data[1:6]
    frame.seq = data[6] << 8 | data[7]
    frame.table_ver = data[8]
    frame.ttl = data[9]
    frame.path_len = n
    frame.path[:n] = data[11 : 11 + n]
    frame.length = body - 11 - n
    frame.body[: frame.length] = data[11 + n : body]
    return OK
