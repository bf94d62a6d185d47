"""Frames of the skin [skin 2]: a type, fields packed most significant bit first, a CRC.

LAYOUTS is the one description: encoder, decoder and whatever else speaks of the bytes read it.
"""

from innervate.networks.skin.protocol.constants import BEACON, COMMAND, DATA, RESTART
from innervate.wire.bits import get, put
from innervate.wire.crc import is_sealed, seal
from innervate.wire.layout import SPARE, pack, unpack, width

KIND_BITS = 4
CRC_BYTES = 2

# Fields as layout.py has them.
ROUTE = (
    ("dist", 0, 8, 0), ("sq", 0, 16, 0), ("load", 0, 12, 0), ("size", 0, 12, 0),
    ("parent", 0, 1, 0),
)  # fmt: skip
TOUCH = (
    (SPARE, 0, 4, 0), ("cell", 0, 16, 0), ("seq", 0, 8, 0), ("hops", 0, 8, 0),
    ("proximity", 0, 16, 0), ("force", 3, 16, 0), ("temperature", 0, 8, 1), ("accel", 3, 10, 1),
    (SPARE, 0, 2, 0),
)  # fmt: skip
ORDER = (
    (SPARE, 0, 4, 0), ("cell", 0, 16, 0), ("sq", 0, 16, 0), ("hops", 0, 8, 0), ("dist", 0, 8, 0),
    ("proximity", 0, 16, 0),
)  # fmt: skip
# A frame: value of the type, name, fields after the type. A restart has the form of a beacon.
LAYOUTS = (
    (BEACON, "beacon", ROUTE),
    (DATA, "data", TOUCH),
    (RESTART, "restart", ROUTE),
    (COMMAND, "command", ORDER),
)
# What captures call a node, by its role.
INTERFACE_WORDS = {"sink": "pc", "cell": "cell"}

# What decode says: read, or why not. Receivers count by these.
OK = 0
BAD_LENGTH = 1
BAD_CRC = 2
BAD_KIND = 3
REASONS = ("ok", "length", "crc", "kind")

FIELDS = {kind: fields for kind, _name, fields in LAYOUTS}
# Bytes of a whole frame: type, fields, zeros up to a byte, CRC.
SIZES = {kind: (KIND_BITS + width(fields) + 7) // 8 + CRC_BYTES for kind, fields in FIELDS.items()}
SIZE_MIN = min(SIZES.values())
SIZE_MAX = max(SIZES.values())


def encode(frame: object) -> bytes:
    """The bytes of a frame record.

    Raises:
        ValueError: the kind is none of ours or a value does not fit; the caller's mistake.
    """
    kind: int = frame.kind  # type: ignore[attr-defined]
    if kind not in FIELDS:
        raise ValueError("no frame of the skin has this kind")
    buffer = bytearray(SIZES[kind])
    put(buffer, 0, KIND_BITS, kind)
    pack(FIELDS[kind], buffer, KIND_BITS, frame)
    return seal(buffer)


def decode(data: bytes | bytearray | memoryview, frame: object) -> int:
    """Read received bytes into a frame record; any bytes at all will do.

    Sets `kind` and the fields of that kind. Returns OK, or else the reason, with `frame` as it was.
    """
    size = len(data)
    if not SIZE_MIN <= size <= SIZE_MAX:
        return BAD_LENGTH
    if not is_sealed(data):
        return BAD_CRC
    kind = get(data, 0, KIND_BITS)
    if kind not in FIELDS:
        return BAD_KIND
    if size != SIZES[kind]:
        return BAD_LENGTH
    frame.kind = kind  # type: ignore[attr-defined]
    unpack(FIELDS[kind], data, KIND_BITS, frame)
    return OK
