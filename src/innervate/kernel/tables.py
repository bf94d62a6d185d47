"""Tables as compiled code sees them: a bare address and a length, without reference counting.

A tuple of dozens of NumPy arrays costs an atomic count up and down for each at every call between
compiled functions: a microsecond an event. A `Table` borrows the memory of an array that the caller
keeps alive. `table[i]` is a number, or a record whose fields are read and written in place;
negative indices are not supported.
What compiled code does with them is in
lowering.py.
"""

from typing import Any

import numpy as np


class Table:
    """Borrows a contiguous one-dimensional array; keeps a reference to it."""

    __slots__ = ("address", "array", "length")

    def __init__(self, array: np.ndarray[Any, Any]) -> None:
        if not array.flags.c_contiguous:
            raise ValueError("a table needs contiguous memory")
        self.array = array
        self.address = int(array.ctypes.data)
        self.length = len(array)


def fetch(table: Any, index: int, line: int) -> None:
    """Have the processor fetch a cache line of table[index]; changes nothing."""


def borrowed(value: Any) -> Any:
    """A (nested) tuple of arrays as the same tuple of tables."""
    if isinstance(value, np.ndarray):
        return Table(value)
    return type(value)(*(borrowed(part) for part in value))


class Lending:
    """A compiled loop over a world's arrays: (world, until_us, budget of events).

    What is to be known of a world, its tables and their types, takes a quarter of a millisecond,
    and is worked out once: the world that was there last is kept.
    """

    def __init__(self, compiled: Any) -> None:
        self.compiled = compiled
        self._last: tuple[Any, Any, Any] = (None, None, None)

    def __call__(self, world: Any, until: int, budget: int) -> None:
        """Advance a world to a time, or by so many events."""
        known, lent, entry = self._last  # as one: other threads may have other worlds
        if world is not known:
            lent = borrowed(world)
            entry = self._entry(tuple(map(self.compiled.typeof_pyval, (lent, 0, 0))))
            self._last = world, lent, entry
        entry(lent, until, budget)

    def _entry(self, kinds: tuple[Any, ...]) -> Any:
        made = self.compiled.overloads.get(kinds)
        return self.compiled.compile(kinds) if made is None else made.entry_point
