"""Tables of a simulation: arrays where it is compiled, lists of numbers and objects where not.

Records are declared like the protocols' (see the `fields.py` of a network's protocol), with 64-bit
fields where the simulator keeps true time.
"""

import hashlib
from collections.abc import Collection, Mapping, Sequence
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from innervate.dialect import plain
from innervate.kernel import records
from innervate.sim import taps

# Fields of records that have 64 bits; all others have 32.
WIDE = frozenset(
    {"time", "start", "busy", "offset", "rate", "inverse", "source", "at", "fingerprint"}
)
# A frame for a capture: when; when its sender began; whose interface (a cable's end, a node, a
# station); who sent it (mesh, radio); 1 = it left, 0 = it came in; why it got no further.
TAP = ("time", "start", "at", "sender", "out", "why")
ACTION = ("kind", "a", "b", "c")
# Rows that every kind of run keeps (see rows.py): what nodes report, what their users got, and
# all handler calls.
ROW = ("time", "node", "code", "a", "b")
DELIVERY = ("time", "node", "port", "kind", "latency")
TRAIL = ("time", "node", "handler", "port", "fingerprint")
ROWS = 1 << 16  # that a table holds before the loop stops for them to be moved out
PLAIN_ROWS = 1 << 11  # objects: dear to make


Name = str | tuple[str, int]  # of a field of rows; with a length, of an array
Names = tuple[Name, ...]


class Out(NamedTuple):
    """The outbox, as tables that are compiled with (see dialect/outbox.py)."""

    count: Any
    limit: Any
    overflow: Any
    action: Any
    frame: Any


class Tables:
    """Makes tables of one form: compiled (arrays) or plain (lists)."""

    def __init__(self, plain_form: bool, word: Any = np.int32) -> None:
        """`word` is what protocols' records consist of.

        32 bits save memory. 64 bits save compiling: functions that are not inlined are compiled
        for every mix of widths that they are called with.
        """
        self.plain = plain_form
        self.word = word
        self.rows = PLAIN_ROWS if plain_form else ROWS

    def numbers(self, count: int, value: int = 0, kind: type = np.int32) -> Any:
        """`count` whole numbers of a value: a list if plain, else an array."""
        if self.plain:
            return [value] * count
        return np.full(count, value, kind) if value else np.zeros(count, kind)

    def records(
        self, names: Names, count: int, fresh: bool = False, wide: Collection[str] = WIDE
    ) -> Any:
        """`count` simulator records; with `fresh` their content is not initialised.

        Fields in `wide` have 64 bits, all others 32.
        """
        if self.plain:
            made = _record(names)
            return [made() for _ in range(count)]
        dtype = row_dtype(names, wide)
        return np.empty(count, dtype) if fresh else np.zeros(count, dtype)

    def states(self, declaration: Any, count: int, itemsize: int = 0) -> Any:
        """`count` records of a protocol's declaration."""
        if self.plain:
            make = plain.make("State", declaration)
            return [make() for _ in range(count)]
        return records.zeros(declaration, count, itemsize, self.word)

    def given(self, values: Any, kind: type = np.int64) -> Any:
        """These whole numbers, row after row, as a list if plain, else as an array."""
        made: Any = np.ascontiguousarray(values, kind).ravel()
        return made.tolist() if self.plain else made

    def spans(self, declaration: Any) -> Any:
        """How a declaration's words are checked (see `kernel.records.spans`)."""
        spans = records.spans(declaration)
        table = self.records(records.Span._fields, len(spans), wide=records.Span._fields)
        for place, span in enumerate(spans):
            put(table, place, **span._asdict())
        return table

    def outbox(self, limit: int, frame: Any, wide: Collection[str] = WIDE) -> Out:
        """An empty outbox with room for `limit` actions."""
        return Out(
            count=self.numbers(1, 0, np.int64),
            limit=self.numbers(1, limit, np.int64),
            overflow=self.numbers(1, 0, np.int64),
            action=self.records(ACTION, limit, wide=wide),
            frame=self.states(frame, limit),
        )

    def words(self, states: Any, declaration: Any) -> Any:
        """The states as rows of words."""
        if self.plain:
            return [records.Words(state, declaration) for state in states]
        return states.view(self.word).reshape(len(states), -1)


@cache
def _record(names: Names) -> Any:
    """A class of records like dialect/plain.py's, all fields 0, of which thousands are made."""
    named = [_named(name) for name in names]
    lines = [f"  self.{name} = {f'[0] * {length}' if length else 0}" for name, length in named]
    made: dict[str, Any] = {}
    exec("\n".join(("def init(self):", *lines)), made)
    slots = tuple(name for name, _ in named)
    return type("Record", (), {"__init__": made["init"], "__slots__": slots})


def row_dtype(names: Names, wide: Collection[str] = WIDE) -> np.dtype[Any]:
    """The array form of simulator records with these fields."""
    return np.dtype([_column(name, wide) for name in names], align=True)


def _named(field: Name) -> tuple[str, int]:
    """Name and length of a field; length 0 is a single number."""
    return (field, 0) if isinstance(field, str) else field


def _column(field: Name, wide: Collection[str]) -> tuple[Any, ...]:
    name, length = _named(field)
    kind = np.int64 if name in wide else np.int32
    return (name, kind, (length,)) if length else (name, kind)


GAMMA = 0x9E3779B97F4A7C15
Numbers = np.ndarray[Any, np.dtype[np.int64]]


def uniform(seed: int, name: str, count: int, n: int) -> Numbers:
    """`count` integers 0 <= x < n <= 2^30 of the stream `name`; the same on any machine."""
    key = hashlib.blake2b(f"{seed}/{name}".encode(), digest_size=8).digest()
    z = np.arange(1, count + 1, dtype=np.uint64) * np.uint64(GAMMA)
    z += np.uint64(int.from_bytes(key, "big"))
    z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    z ^= z >> np.uint64(31)
    return (((z >> np.uint64(32)) * np.uint64(n)) >> np.uint64(32)).astype(np.int64)


def put(table: Any, place: int, /, **values: int | Sequence[int]) -> None:
    """Set fields of one record; those that are arrays, from a sequence."""
    for name, value in values.items():
        if isinstance(table, list):
            setattr(table[place], name, list(value) if isinstance(value, Sequence) else int(value))
        else:
            table[name][place] = value


def longer(table: Any, length: int) -> Any:
    """A table of so many records, the first ones those of `table`, the others 0."""
    if isinstance(table, list):
        make = (lambda: 0) if isinstance(table[0], int) else type(table[0])
        return table + [make() for _ in range(length - len(table))]
    made = np.zeros(length, table.dtype)
    made[: len(table)] = table
    return made


def hand_over(world: Any, tap: taps.Tap | None, now: int) -> None:
    """Give a tap the frames that were kept, and make room for more."""
    if tap is not None:
        count = int(get(world.run, 0, "taps"))
        tap(_as_rows(world.taps, count), _as_rows(world.tapped, count), now)
        put(world.run, 0, taps=0)


def _as_rows(table: Any, count: int) -> Any:
    """The first records of a table as rows of an array, whose fields have 64 bits if plain."""
    if not isinstance(table, list):
        return table[:count]
    first = table[0]
    kinds = [(name, np.int64, np.shape(getattr(first, name))) for name in first.__slots__]
    return _rows_of(table[:count], np.dtype(kinds))


def _rows_of(records: list[Any], kind: np.dtype[Any]) -> Any:
    """Plain records as rows of an array."""
    names = kind.names or ()
    return np.array([tuple(getattr(one, name) for name in names) for one in records], kind)


def move_rows(
    world: Any, parts: dict[str, list[Any]], fields: Mapping[str, Names], wide: Any
) -> None:
    """Move filled rows out of the loop's tables, so that these can stay small.

    Args:
        world: of a run; its record counts what is in the table of each name.
        parts: per table, the rows so far; these are added as one array each.
        fields: of the rows, per table.
        wide: fields of 64 bits.
    """
    for name, kept in parts.items():
        count, table = int(get(world.run, 0, name)), getattr(world, name)
        if isinstance(table, list):
            kept.append(_rows_of(table[:count], row_dtype(fields[name], wide)))
        else:
            kept.append(table[:count].copy())
        put(world.run, 0, **{name: 0})


def column(table: Any, name: str, count: int | None = None) -> Numbers:
    """A field of the first `count` records, or of all, compiled or plain."""
    if isinstance(table, list):
        return np.array([getattr(record, name) for record in table[:count]], np.int64)
    found: Numbers = table[name][:count].astype(np.int64)
    return found


def get(table: Any, place: int, name: str) -> Any:
    """A field of one record, compiled or plain."""
    return getattr(table[place], name) if isinstance(table, list) else table[name][place]


def timed(tables: Tables, names: tuple[str, ...], rows: Sequence[tuple[int, ...]]) -> Any:
    """A table of what happens, in order of time; never without a row."""
    table = tables.records(names, max(len(rows), 1), wide=names)
    for place, row in enumerate(rows):
        put(table, place, **dict(zip(names, row, strict=True)))
    return table
