"""Where the handler calls of two runs begin to differ, without keeping them all."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from innervate.sim.tables import TRAIL


def first_difference(one: Iterator[Any], other: Iterator[Any]) -> tuple[Any, Any] | None:
    """The first rows in which two trails differ; None for the one that ends there.

    None alone if the trails are the same.
    """
    left, right = _Reader(one), _Reader(other)
    while True:
        a, b = left.look(), right.look()
        if len(a) == 0 or len(b) == 0:
            row_a, row_b = (part[0] if len(part) else None for part in (a, b))
            return None if row_a is None and row_b is None else (row_a, row_b)
        count = min(len(a), len(b))
        differs = np.zeros(count, np.bool_)
        for name in TRAIL:
            differs |= a[name][:count] != b[name][:count]
        places = np.flatnonzero(differs)
        if len(places):
            return a[places[0]], b[places[0]]
        left.skip(count)
        right.skip(count)


class _Reader:
    """Reads pieces as if they were one; `look` is empty only at the end."""

    def __init__(self, pieces: Iterator[Any]) -> None:
        self._pieces = pieces
        self._rest: Any = ()

    def look(self) -> Any:
        while len(self._rest) == 0:
            piece = next(self._pieces, None)
            if piece is None:
                return ()
            self._rest = piece
        return self._rest

    def skip(self, count: int) -> None:
        self._rest = self._rest[count:]
