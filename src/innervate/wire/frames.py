"""Frames from their layouts alone: a kind, fields packed most significant bit first, a CRC."""

from innervate.wire.bits import get, put
from innervate.wire.crc import is_sealed, seal
from innervate.wire.layout import SPARE, pack, unpack, width

CRC_BYTES = 2

# What decode says: read, or why not. Receivers count by these.
OK = 0
BAD_LENGTH = 1
BAD_CRC = 2
BAD_KIND = 3
REASONS = ("ok", "length", "crc", "kind")


class Codec:
    """Encodes and decodes frame records of fixed length.

    Args:
        layouts: of every kind of frame: its number, a name, its fields (see layout.py).
        kind_bits: how many bits the kind has, at the beginning.

    Attributes:
        SIZE_MAX: bytes of the longest frame.
    """

    def __init__(self, layouts: tuple, kind_bits: int) -> None:  # type: ignore[type-arg]
        self.kind_bits = kind_bits
        self.fields = {kind: fields for kind, _name, fields in layouts}
        self.sizes = {kind: (kind_bits + width(fields) + 7) // 8 + CRC_BYTES
                      for kind, fields in self.fields.items()}  # fmt: skip
        self.SIZE_MAX = max(self.sizes.values())
        known = {name: many for fields in self.fields.values() for name, many, *_ in fields}
        self._others = {
            kind: [(name, known[name]) for name in known
                   if name != SPARE and name not in {one[0] for one in fields}]
            for kind, fields in self.fields.items()
        }  # fmt: skip

    def encode(self, frame: object) -> bytes:
        """The bytes of a frame record.

        Raises:
            ValueError: the kind is none of these, or a value does not fit; the caller's mistake.
        """
        kind: int = frame.kind  # type: ignore[attr-defined]
        if kind not in self.fields:
            raise ValueError("no frame has this kind")
        buffer = bytearray(self.sizes[kind])
        put(buffer, 0, self.kind_bits, kind)
        pack(self.fields[kind], buffer, self.kind_bits, frame)
        return seal(buffer)

    def decode(self, data: bytes | bytearray | memoryview, frame: object) -> int:
        """Read received bytes into a frame record; any bytes at all will do.

        Sets `kind` and the fields of that kind; those that only others have are 0, as nobody sent
        them. Returns OK, or else the reason, with `frame` as it was.
        """
        size = len(data)
        if not min(self.sizes.values()) <= size <= self.SIZE_MAX:
            return BAD_LENGTH
        if not is_sealed(data):
            return BAD_CRC
        kind = get(data, 0, self.kind_bits)
        if kind not in self.fields:
            return BAD_KIND
        if size != self.sizes[kind]:
            return BAD_LENGTH
        frame.kind = kind  # type: ignore[attr-defined]
        unpack(self.fields[kind], data, self.kind_bits, frame)
        for name, many in self._others[kind]:
            for i in range(many):
                getattr(frame, name)[i] = 0
            if not many:
                setattr(frame, name, 0)
        return OK
