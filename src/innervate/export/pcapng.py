"""Captures in pcapng (draft-ietf-opsawg-pcapng), block by block: little-endian, times in ns.

Pure Python on the standard library, so that live nodes can be captured on a small computer. What a
block holds is in the draft's sections 4.1 (section header), 4.2 (interface), 4.3 (packet).
"""

import struct

SECTION, INTERFACE, PACKET, SIMPLE = 0x0A0D0D0A, 1, 6, 3
MAGIC = 0x1A2B3C4D
END, COMMENT = 0, 1
USER_APPLICATION = 4  # of a section
NAME, DESCRIPTION, RESOLUTION = 2, 3, 9  # of an interface
FLAGS = 2  # of a packet
INBOUND, OUTBOUND, CRC_ERROR = 1, 2, 1 << 24
NANOSECONDS = 9
UPPER_PDU = 252  # a link type of Wireshark's own: in front of a packet stands who reads it
DISSECTOR_TABLE, TABLE_NUMBER = 14, 32  # tags in front of such a packet
OPTION_MAX = 65_000

_HEAD = struct.Struct("<IIIIIII")
_FLAGS_OPTION = struct.Struct("<HHI")
_LENGTH = struct.Struct("<I")
_NO_MORE = b"\0\0\0\0"
_PADDING = (b"", b"\0\0\0", b"\0\0", b"\0")


def section(comment: str = "", application: str = "") -> bytes:
    """The block that a capture begins with."""
    body = struct.pack("<IHHq", MAGIC, 1, 0, -1)
    return _block(SECTION, body + _options((COMMENT, comment), (USER_APPLICATION, application)))


def interface(link_type: int, name: str, description: str = "") -> bytes:
    """An interface; they are numbered from 0 in order of their blocks."""
    body = struct.pack("<HHI", link_type, 0, 0)
    texts = ((NAME, name), (DESCRIPTION, description))
    return _block(INTERFACE, body + _options(*texts, (RESOLUTION, bytes((NANOSECONDS,)))))


def packet(number: int, time_ns: int, data: bytes, flags: int, comment: bytes = b"") -> bytes:
    """A frame.

    Args:
        number: of its interface.
        time_ns: when, from 1970 or from the start of a simulation.
        data: its bytes.
        flags: INBOUND or OUTBOUND, with CRC_ERROR if it could not be read.
        comment: UTF-8.
    """
    size = len(data)
    padded = data + _PADDING[size & 3]
    options = _FLAGS_OPTION.pack(FLAGS, 4, flags) + _NO_MORE
    if comment:
        count = len(comment)
        options = struct.pack("<HH", COMMENT, count) + comment + _PADDING[count & 3] + options
    total = 32 + len(padded) + len(options)
    head = _HEAD.pack(PACKET, total, number, time_ns >> 32, time_ns & 0xFFFFFFFF, size, size)
    return head + padded + options + _LENGTH.pack(total)


def for_dissector(table: str, number: int) -> bytes:
    """What stands in front of a packet of UPPER_PDU: in which of Wireshark's tables its reader is.

    Its dissectors have numbers there, as port 6696 of "udp.port".
    """
    padded = table.encode() + _PADDING[len(table) & 3]
    found = struct.pack(">HH", DISSECTOR_TABLE, len(padded)) + padded
    return found + struct.pack(">HHI", TABLE_NUMBER, 4, number) + _NO_MORE


def _options(*given: tuple[int, str | bytes]) -> bytes:
    parts = []
    for code, value in given:
        data = value.encode("utf-8", "replace") if isinstance(value, str) else value
        if data:
            data = data[:OPTION_MAX]
            parts.append(struct.pack("<HH", code, len(data)) + data + _PADDING[len(data) & 3])
    return b"".join(parts) + _NO_MORE


def _block(kind: int, body: bytes) -> bytes:
    total = 12 + len(body)
    return struct.pack("<II", kind, total) + body + _LENGTH.pack(total)
