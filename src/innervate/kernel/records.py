"""Record types and plain twins from field declarations."""

from collections.abc import Callable
from functools import cache
from itertools import groupby
from typing import Any, NamedTuple

import numpy as np

CACHE_LINE = 64
LONG = 64  # words of one range, from which on they are a span of their own

Field = tuple[str, int | str, int, int, str, str]
Declaration = tuple[Field, ...]
Limits = tuple[int, int]
# What a record without fields holds: compiled, none is empty.
NOTHING: Declaration = (("nothing", 0, 0, 0, "", "not used"),)
Test = Callable[[Any], bool]


@cache
def dtype(declaration: Declaration, itemsize: int = 0, word: Any = np.int32) -> np.dtype[Any]:
    """The NumPy record of a declaration: `word` throughout, padded to `itemsize` bytes if given.

    One without fields has a word that nobody reads. The same for all that ask: NumPy keeps the hash
    of a record that it knows, and Numba looks records up by it, before every run.
    """
    names: list[str] = []
    formats: list[Any] = []
    offsets: list[int] = []
    offset = 0
    for name, length, *_ in declaration or NOTHING:
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


class Span(NamedTuple):
    """Neighbouring words of a record that are checked in one go.

    Attributes:
        end: the first word behind them; they begin where those before end.
        low, high: the range of all; low > high = each has its own.
    """

    end: int
    low: int
    high: int


MIXED = (1, 0)


def spans(declaration: Declaration) -> list[Span]:
    """A record's words as spans: long ones of one range, and what lies between them."""
    found: list[Span] = []
    end = 0
    low, high = (bound.tolist() for bound in bounds(declaration))
    for limits, words in groupby(zip(low, high, strict=True)):
        count = len(list(words))
        end += count
        if count < LONG:
            limits = MIXED
            if found and found[-1][1:] == MIXED:
                found.pop()
        found.append(Span(end, *limits))
    return found


@cache
def _places(declaration: Declaration) -> list[tuple[str, int]]:
    """Field of each word, and its place in it; place -1: the field is no array."""
    return [
        (name, i) if int(length) else (name, -1)
        for name, length, *_ in declaration
        for i in range(max(int(length), 1))
    ]


@cache
def _limits(declaration: Declaration) -> tuple[Test, Callable[[Any], list[Any]], list[Limits]]:
    """If an object's single numbers are in range, written out; its arrays, and their limits."""
    numbers = (one for one in declaration if not int(one[1]))
    text = " and ".join(f"{low} <= it.{name} <= {high}" for name, _, low, high, *_ in numbers)
    arrays = [(name, low, high) for name, length, low, high, *_ in declaration if int(length)]
    values = ", ".join(f"it.{name}" for name, *_ in arrays)
    return (
        eval(compile(f"lambda it: {text or True}", "declared ranges", "eval")),
        eval(compile(f"lambda it: [{values}]", "arrays", "eval")),
        [(low, high) for _, low, high in arrays],
    )


class Words:
    """A plain object's fields as one row of numbers, in order of declaration."""

    __slots__ = ("_arrays_of", "_known", "_limits", "_numbers_are_declared", "_target", "_where")

    def __init__(self, target: Any, declaration: Declaration) -> None:
        self._target = target
        self._where = _places(declaration)
        self._numbers_are_declared, self._arrays_of, self._limits = _limits(declaration)
        self._known: list[Any] = [None] * len(self._limits)  # as they were seen to be in range

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

    def are_declared(self) -> bool:
        """True if each lies in its declared range; of arrays those are looked at that changed."""
        if not self._numbers_are_declared(self._target):
            return False
        known, arrays = self._known, self._arrays_of(self._target)
        if arrays == known:
            return True
        for place, value in enumerate(arrays):
            if value != known[place]:
                low, high = self._limits[place]
                if min(value) < low or max(value) > high:
                    return False
                known[place] = list(value)
        return True


def within(words: Any, low: Any, high: Any) -> bool:
    """True if every word of a record lies in its declared range; lowering.py compiles it."""
    if isinstance(words, Words):
        return words.are_declared()
    return all(least <= word <= most for least, word, most in zip(low, words, high, strict=False))


def within_spans(words: Any, low: Any, high: Any, spans: Any) -> bool:
    """The same of long records with 64-bit words, three fifths of whose time were their bounds."""
    return within(words, low, high)
