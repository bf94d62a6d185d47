"""Frames of the shared radio channel [radio 2, radio-practical 2]: for live media and captures.

On the air a slot is a byte, and what a frame costs is its `slots`, a field here: a channel of
processes times a frame by that, however many bytes stand for it. A CR-R is a bare slot of carrier,
the byte 0xC5 without a CRC. A data frame's second and third byte are the header that stations of
the practical mode need, exactly two bytes; behind it is what the medium and captures keep count by.
"""

from innervate.networks.radio.protocol.constants import CRR, DATA, OPEN, REPORT
from innervate.wire.bits import put
from innervate.wire.crc import is_sealed, seal
from innervate.wire.layout import SPARE, pack, unpack, width

VERSION = 1
CRC_BYTES = 2
CRR_BYTE = 0xC5
PAYLOAD_MAX = 1024  # bytes of packets in a data frame

HEAD = (("version", 0, 4, 0), ("kind", 0, 4, 0))
TURN = (
    ("pos", 0, 7, 0),
    ("next", 0, 7, 0),
    ("more", 0, 1, 0),
    ("ok", 0, 1, 0),
    ("wide", 0, 2, 0),
    (SPARE, 0, 2, 0),
    ("slots", 0, 12, 0),
    (SPARE, 0, 2, 0),
    ("source", 0, 10, 0),
    ("count", 0, 4, 0),
    ("handle", 0, 16, 0),
)
MINISLOTS = (
    ("pos", 0, 7, 0),
    ("base", 0, 7, 0),
    ("window", 0, 6, 0),
    ("span", 0, 10, 0),
    ("split", 0, 1, 0),
    ("wide", 0, 2, 0),
    ("kept", 0, 5, 0),
    (SPARE, 0, 6, 0),
    ("slots", 0, 12, 0),
    ("good", 2, 16, 0),
    ("bad", 2, 16, 0),
)
# A frame: value of the type, name, fields after the type; behind those of data and open packets.
LAYOUTS = (
    (DATA, "data", TURN),
    (OPEN, "open", TURN),
    (REPORT, "report", MINISLOTS),
)
AT = 8  # bits of HEAD
# What captures call a node, by its role.
INTERFACE_WORDS = {"station": "station"}

# What decode says: read, or why not. Receivers count by these.
OK = 0
BAD_LENGTH = 1
BAD_CRC = 2
BAD_VERSION = 3
BAD_KIND = 4
REASONS = ("ok", "length", "crc", "version", "kind")

FIELDS = {kind: fields for kind, _name, fields in LAYOUTS}
# Bytes of a frame without packets in it.
SIZES = {kind: (AT + width(fields)) // 8 + CRC_BYTES for kind, _name, fields in LAYOUTS}
SIZE_MIN = min(SIZES.values())


def encode(frame: object, payload: bytes | bytearray | memoryview = b"") -> bytes:
    """The bytes of a frame record, with the bytes of the packets in it.

    Raises:
        ValueError: the kind is none of ours, a value does not fit, a CR-R is longer than a slot,
            there are packets where none can be, or too many bytes of them; the caller's mistake.
    """
    kind = frame.kind  # type: ignore[attr-defined]
    if len(payload) > (PAYLOAD_MAX if kind in (DATA, OPEN) else 0):
        raise ValueError("payload does not fit into a frame of this kind")
    if kind == CRR:
        if frame.slots != 1:  # type: ignore[attr-defined]
            raise ValueError("slots of a CR-R must be 1")
        return bytes((CRR_BYTE,))
    if kind not in FIELDS:
        raise ValueError("no frame of the radio has this kind")
    buffer = bytearray(SIZES[kind] + len(payload))
    put(buffer, 0, AT, VERSION << 4 | kind)
    begin = pack(FIELDS[kind], buffer, AT, frame) // 8
    for i in range(len(payload)):
        buffer[begin + i] = payload[i]
    return seal(buffer)


def reason_of(data: bytes | bytearray | memoryview) -> int:
    """OK if these bytes are a frame, else why not; any bytes at all will do."""
    size = len(data)
    if size == 1:
        return OK if data[0] == CRR_BYTE else BAD_KIND
    if not SIZE_MIN <= size <= SIZES[DATA] + PAYLOAD_MAX:
        return BAD_LENGTH
    if not is_sealed(data):
        return BAD_CRC
    if data[0] >> 4 != VERSION:
        return BAD_VERSION
    kind = data[0] & 15
    if kind not in FIELDS:
        return BAD_KIND
    return BAD_LENGTH if kind == REPORT and size != SIZES[REPORT] else OK


def decode(data: bytes | bytearray | memoryview, frame: object) -> int:
    """Read received bytes into a frame record; any bytes at all will do.

    What the kind does not carry is set to 0. Returns OK, or else the reason, with `frame` as it
    was. The packets in the frame are `payload_of` the same bytes.
    """
    reason = reason_of(data)
    if reason != OK:
        return reason
    for layout in (TURN, MINISLOTS):
        for name, many, _bits, _signed in layout:
            for i in range(many):
                getattr(frame, name)[i] = 0
            if name != SPARE and not many:
                setattr(frame, name, 0)
    if len(data) == 1:
        frame.kind = CRR  # type: ignore[attr-defined]
        frame.slots = 1  # type: ignore[attr-defined]
    else:
        frame.kind = data[0] & 15  # type: ignore[attr-defined]
        unpack(FIELDS[frame.kind], data, AT, frame)  # type: ignore[attr-defined]
    return OK


def payload_of(data: bytes | bytearray | memoryview) -> bytes:
    """The bytes of the packets in a frame that decode found OK; empty where there are none."""
    if len(data) <= SIZES[DATA] or data[0] & 15 == REPORT:
        return b""
    return bytes(data[SIZES[DATA] - CRC_BYTES : len(data) - CRC_BYTES])
