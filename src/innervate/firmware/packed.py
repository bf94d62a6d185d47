"""Records as they lie in a board's memory: little-endian, each number as wide as its range."""

import struct
from array import array
from collections.abc import Callable, Iterable
from typing import Any

from innervate.firmware.records import BYTES, CODES, Field, layout


def _packing(code: str) -> Callable[[Iterable[int]], bytes]:
    """What makes bytes of an array's values."""
    pack = struct.Struct(code).pack
    return lambda values: pack(*values)


class Packed:
    """A record's bytes in C, from an object with its fields."""

    def __init__(self, fields: dict[str, Field]) -> None:
        self.fields = fields
        places, self.size = layout(fields)
        code, at = "<", 0
        for _name, (offset, kind, length) in places:
            width = BYTES[kind]
            code += f"{offset - at}x" + (f"{length * width}s" if length else CODES[kind])
            at = offset + max(1, length) * width
        self.struct = struct.Struct(f"{code}{self.size - at}x")
        self.arrays = [(name, CODES[kind] if length else "") for name, (_, kind, length) in places]
        self.packs = [
            (name, None if not length else bytes if CODES[kind] == "B"
             else _packing(f"<{length}{CODES[kind]}"))
            for name, (_, kind, length) in places
        ]  # fmt: skip

    def of(self, record: Any) -> bytes:
        """The bytes of a record.

        Raises:
            ValueError, struct.error: a value does not fit into its field.
        """
        values: list[Any] = []
        for name, pack in self.packs:
            value = getattr(record, name)
            values.append(pack(value) if pack else value)
        return self.struct.pack(*values)

    def put(self, data: bytes, record: Any) -> None:
        """Set a record's fields to what these bytes say, those that it has."""
        for (name, code), value in zip(self.arrays, self.struct.unpack(data), strict=True):
            if hasattr(record, name):
                setattr(record, name, list(array(code, value)) if code else value)

    def differences(self, mine: bytes, other: bytes) -> list[str]:
        """Names of the fields that differ, with both values."""
        pairs = zip(self.arrays, self.struct.unpack(mine), self.struct.unpack(other), strict=True)
        return [f"{name}: {list(a) if isinstance(a, bytes) else a} but in C "
                f"{list(b) if isinstance(b, bytes) else b}"
                for (name, _), a, b in pairs if a != b]  # fmt: skip
