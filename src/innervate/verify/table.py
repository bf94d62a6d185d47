"""The tables of a search: arrays for compiled code, views of the same memory for plain Python."""

from collections.abc import Callable
from typing import Any

import numpy as np

from innervate.kernel import tables
from innervate.verify import search as s

SLOTS = 1 << 18


def zeros(count: int, plain: bool, kind: type = np.int64) -> Any:
    """So many numbers; the memory is taken as it is used."""
    made: Any = np.zeros(count, kind)
    return made.data if plain else made


def row(width: int, plain: bool) -> tuple[Any, Any]:
    """`width` bytes, and the same memory as 64-bit words."""
    memory = np.zeros(width, np.uint8)
    words = memory.view(np.int64)
    return (memory.data, words.data) if plain else (memory, words)


class Table:
    """States, each kept once as a row of words.

    Args:
        lay: the layout of a row.
        plain: for uncompiled code.
        limit: how many there is room for.
        body: see `Search.body`.
        rows: states that are there already; None = none.

    Attributes:
        search: what there is (see search.py).
        seen: the same as functions are given it.
    """

    def __init__(
        self, lay: Any, plain: bool, limit: int, body: list[int], rows: Any = None
    ) -> None:
        self.plain, self.words = plain, lay.width // 8
        mask = np.array(body, np.uint8).view(np.int64)
        search = s.Search(
            run=zeros(s.NUMBERS, plain),
            rows=zeros(limit * self.words, plain) if rows is None else rows,
            table=zeros(SLOTS, plain),
            before=zeros(limit, plain, np.int32),
            body=mask.data if plain else mask,
        )
        run = search.run
        run[s.COUNT] = 0 if rows is None else len(rows) // self.words
        run[s.LIMIT], run[s.SLOTS], run[s.WORDS] = limit, SLOTS, self.words
        run[s.WIDTH], run[s.IMAGES] = lay.width, len(lay.images()) // lay.width
        self._take(search)

    def _take(self, search: s.Search) -> None:
        self.search = search
        self.seen = search if self.plain else tables.borrowed(search)

    def grow(self, refill: Callable[[Any], None]) -> None:
        """A table with twice the places, into which `refill` enters all rows."""
        run = self.search.run
        run[s.SLOTS] = 2 * int(run[s.SLOTS])
        self._take(self.search._replace(table=zeros(int(run[s.SLOTS]), self.plain)))
        refill(self.seen)

    @property
    def count(self) -> int:
        """How many states were found."""
        return int(self.search.run[s.COUNT])

    def row(self, index: int) -> bytes:
        """The state of this index, as bytes."""
        part = self.search.rows[index * self.words : (index + 1) * self.words]
        return bytes(part.tobytes())
