"""States of nodes as tuples of numbers, and back."""

from typing import Any

from innervate.dialect.arith import HALF30 as HALF
from innervate.dialect.arith import MASK30
from innervate.dialect.plain import Row


def values(record: Any, declared: Any, left_out: Any = ()) -> tuple[Any, ...]:
    """The declared fields of a record; those left out as 0."""
    found = []
    for name, length, *_ in declared:
        value = getattr(record, name)
        found.append(0 if name in left_out else tuple(value) if length else value)
    return tuple(found)


def put(record: Any, declared: Any, given: tuple[Any, ...]) -> None:
    """Set the declared fields of a record."""
    for (name, length, *_), value in zip(declared, given, strict=True):
        setattr(record, name, Row(value) if length else value)


def with_one(row: tuple[Any, ...], place: int, value: Any) -> tuple[Any, ...]:
    """A row with another value at one place."""
    return (*row[:place], value, *row[place + 1 :])


def moved(at: Any, by: int) -> Any:
    """A moment, or each of several, so much later on a clock."""
    return [(one + by) & MASK30 for one in at] if isinstance(at, list) else (at + by) & MASK30


def ahead(at: int) -> int:
    """How far a moment is ahead of clock reading 0; negative if it is behind."""
    at &= MASK30
    return at - (1 << 30) if at >= HALF else at
