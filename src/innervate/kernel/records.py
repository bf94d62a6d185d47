"""Record types and plain twins from field declarations."""

from __future__ import annotations

from typing import Any

import numpy as np

CACHE_LINE = 64

Field = tuple[str, int | str, int, int, str, str]
Declaration = tuple[Field, ...]


def dtype(declaration: Declaration, itemsize: int = 0, word: Any = np.int32) -> np.dtype[Any]:
    """The NumPy record of a declaration: `word` throughout, padded to `itemsize` bytes if given."""
    names: list[str] = []
    formats: list[Any] = []
    offsets: list[int] = []
    offset = 0
    for name, length, *_ in declaration:
        count = int(length)
        names.append(name)
        formats.append((word, (count,)) if count else word)
        offsets.append(offset)
        offset += np.dtype(word).itemsize * max(count, 1)
    size = max(offset, itemsize)
    layout: Any = {"names": names, "formats": formats, "offsets": offsets, "itemsize": size}
    return np.dtype(layout, align=True)


def zeros(
    declaration: Declaration, count: int, itemsize: int = 0, word: Any = np.int32
) -> np.ndarray[Any, Any]:
    """`count` records, each field at the value in range nearest 0; the first on a cache line."""
    kind = dtype(declaration, itemsize, word)
    memory = np.zeros(count * kind.itemsize + CACHE_LINE, np.uint8)
    start = -memory.ctypes.data % CACHE_LINE
    records = memory[start : start + count * kind.itemsize].view(kind)
    for name, _length, low, high, *_ in declaration:
        start = min(max(0, low), high)
        if start:
            records[name] = start
    return records


def bounds(declaration: Declaration) -> tuple[np.ndarray[Any, Any], np.ndarray[Any, Any]]:
    """Lowest and highest value of every 32-bit word of a record, for range checks."""
    low: list[int] = []
    high: list[int] = []
    for _name, length, lowest, highest, *_ in declaration:
        words = max(int(length), 1)
        low += [lowest] * words
        high += [highest] * words
    return np.array(low, np.int32), np.array(high, np.int32)


class Words:
    """A plain object's fields as one row of numbers, in order of declaration."""

    def __init__(self, target: Any, declaration: Declaration) -> None:
        self._target = target
        self._where = [
            (name, i) if int(length) else (name, -1)
            for name, length, *_ in declaration
            for i in range(max(int(length), 1))
        ]

    def __getitem__(self, index: int) -> int:
        name, i = self._where[index]
        value = getattr(self._target, name)
        return int(value if i < 0 else value[i])

    def __setitem__(self, index: int, word: int) -> None:
        name, i = self._where[index]
        if i < 0:
            setattr(self._target, name, word)
        else:
            getattr(self._target, name)[i] = word
