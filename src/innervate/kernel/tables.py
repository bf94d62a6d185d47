"""Tables as compiled code sees them: a bare address and a length, without reference counting.

A tuple of dozens of NumPy arrays costs an atomic count up and down for each at every call between
compiled functions: a microsecond an event. A `Table` borrows the memory of an array that the caller
keeps alive. `table[i]` is a number, or a record whose fields are read and written in place;
negative indices are not supported.
What compiled code does with them is in
lowering.py.
"""

from __future__ import annotations

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
