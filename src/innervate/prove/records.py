"""What handlers work on, while they are turned into formulas: records, arrays, the outbox."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from innervate.dialect.source import Function
from innervate.prove.terms import Term, Terms

Declaration = Iterable[tuple[str, Any, int, int, str, str]]
PORTS = "ports"  # the length of an array that is as long as a node has ports


class Record:
    """A record with declared fields."""

    def __init__(self, name: str, declaration: Declaration = (), ports: int = 0) -> None:
        self.name = name  # its unknowns are called by it
        self.fields = {  # (length or 0, low, high) of each
            field: (ports if length == PORTS else length, low, high)
            for field, length, low, high, _unit, _meaning in declaration
        }
        self.parts: dict[str, tuple[Record, ...]] = {}  # records within it, by name

    def places(self) -> Iterator[tuple[Key, int, int]]:
        """The place of every value, with its range."""
        for name, (length, low, high) in self.fields.items():
            if length:
                for i in range(length):
                    yield (self, name, i), low, high
            else:
                yield (self, name, None), low, high
        for inner in self.parts.values():
            for record in inner:
                yield from record.places()


Key = tuple[Record, str, "int | None"]
Store = dict[Key, Term]


def name_of(key: Key) -> str:
    """A place as text: cell.dist[2]."""
    record, name, index = key
    return f"{record.name}.{name}" + ("" if index is None else f"[{index}]")


def unknowns(terms: Terms, record: Record) -> Store:
    """Any values in their declared ranges."""
    return {key: terms.unknown(name_of(key), low, high) for key, low, high in record.places()}


@dataclass(frozen=True, slots=True)
class Array:
    """An array of a record."""

    record: Record
    name: str
    length: int


@dataclass(frozen=True, slots=True)
class Either:
    """One reference where a truth holds, else another."""

    if_: Term
    a: Any
    b: Any


class Partly(NamedTuple):
    """What has a value only where a truth holds: a name, or what a call returned."""

    where: Term
    value: Any


@dataclass(eq=False, slots=True)
class Action:
    """An action of the outbox: it is there where `guard` holds."""

    kind: int
    guard: Term
    a: Term
    b: Term
    c: Term
    frame: Record
    where: str


class Frames:
    """The table `out.frame`; what `send` and `deliver` return stands for a place in it."""


@dataclass(slots=True)
class Outbox:
    """The actions of a call in order; each is there where its guard holds."""

    frame: Declaration
    limit: int
    actions: list[Action] = field(default_factory=list)


@dataclass(slots=True)
class State:
    """The state on some of a function's paths."""

    names: dict[str, Any]  # its local names
    store: Store  # values of all records
    path: Term  # which of the function's paths
    call: Call  # of the function

    def fork(self, path: Term) -> State:
        """The same, to go on with by itself."""
        return State(dict(self.names), dict(self.store), path, self.call)


@dataclass(frozen=True, slots=True)
class Demand:
    """Something that must hold wherever `guard` does."""

    what: str
    guard: Term
    holds: Term
    where: str


@dataclass(slots=True)
class Call:
    """A call that is being followed."""

    function: Function  # that is called
    under: Term  # where it is called at all
    # (state, value) of its paths that have ended
    returned: list[tuple[State, Any]] = field(default_factory=list)
    # broken, continued: states of the innermost loop's paths that left a pass
    broken: list[State] = field(default_factory=list)
    continued: list[State] = field(default_factory=list)


def merged(terms: Terms, if_: Term, a: State, b: State, path: Term) -> State:
    """State `a` where a truth holds, else `b`."""
    store, other = a.store, b.store
    for key, value in other.items():
        mine = store.get(key)
        if mine is None:
            store[key] = value
        elif mine is not value:
            store[key] = terms.pick(if_, mine, value)
    names, others = a.names, b.names
    for name in [*names, *(name for name in others if name not in names)]:
        one, its = names.get(name), others.get(name)
        if one is not its:
            names[name] = either(terms, if_, one, its)
    return State(names, store, path, a.call)


def either(terms: Terms, if_: Term, a: Any, b: Any) -> Any:
    """One value or reference where a truth holds, else another; None is no value."""
    if a is b or a == b:
        return b
    if isinstance(a, Term) and isinstance(b, Term):
        return terms.pick(if_, a, b)
    if a is None or b is None or isinstance(a, Partly) or isinstance(b, Partly):
        return _partly(terms, if_, a, b)
    return Either(if_, a, b)


def _partly(terms: Terms, if_: Term, a: Any, b: Any) -> Any:
    """The same where one of them has no value on some paths."""
    one, other = (x if isinstance(x, Partly) else Partly(terms.truth_of(x is not None), x)
                  for x in (a, b))  # fmt: skip
    where = terms.pick(if_, one.where, other.where)
    values = [x.value for x in (one, other) if x.value is not None]
    value = either(terms, if_, *values) if len(values) == 2 else values[0]
    return value if where is terms.true else Partly(where, value)


def of_each(terms: Terms, ref: Any, read: Callable[[Any], Any]) -> Any:
    """What is read of all that a reference may stand for, each where it does."""
    found: Any = None
    for where, one in each_of(terms, ref, terms.true):
        value = read(one)
        found = value if found is None else either(terms, where, value, found)
    return found


def each_of(terms: Terms, ref: Any, under: Term) -> Iterator[tuple[Term, Any]]:
    """All that a reference may stand for, and where."""
    if isinstance(ref, Either):
        yield from each_of(terms, ref.a, terms.all(under, ref.if_))
        yield from each_of(terms, ref.b, terms.all(under, terms.negated(ref.if_)))
    else:
        yield under, ref
