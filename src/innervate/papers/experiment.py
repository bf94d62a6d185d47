"""What a published figure is here: simulations to run, a drawing, claims against measurements."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from importlib import import_module
from math import inf
from typing import Any, TypeVar

import numpy as np
from matplotlib.figure import Figure

HOLDS = "holds"
FAILS = "does not hold"
OURS = "ours"
T = TypeVar("T")

# Results of points by their keys: whatever JSON can hold.
Results = Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class Point:
    """One piece of work whose result is kept."""

    key: str  # says everything that decides the result; equal keys are run once
    work: Callable[[], Any]  # runs it; what it returns is plain numbers, texts, lists and dicts
    cost_s: float = 0.5  # about how long that takes, for the time left

    @classmethod
    def of(cls, key: str, cost_s: float, work: Callable[..., Any], *args: Any) -> Point:
        """The point that calls `work` with these arguments."""
        return cls(key, partial(work, *args), cost_s)

    @classmethod
    def each(
        cls, what: str, cost_s: float, seeds: int, measure: Callable[..., Any], *case: Any
    ) -> Point:
        """The series that calls `measure(*case, seed)` for the seeds 1 and following.

        Its result is a list of what came, or a list under each name where a dict came.

        Args:
            what: says the case, all of it; the seeds are added to it.
            cost_s: of one seed.
            seeds: how many.
            measure: runs a case with a seed and measures it.
            case: the first arguments of `measure`.
        """
        work = partial(columns, measure, case, range(1, seeds + 1))
        return cls(f"{what}, seeds 1-{seeds}", work, cost_s * seeds)


def columns(measure: Callable[..., Any], case: Sequence[Any], seeds: Sequence[int]) -> Any:
    """What is measured of every seed: a list, or a list under each name."""
    rows = [measure(*case, seed) for seed in seeds]
    if not isinstance(rows[0], dict):
        return rows
    return {name: [row[name] for row in rows] for name in rows[0]}


def sized(quick: T, full: T) -> Callable[[bool], T]:
    """What figures take in their small and their full size, as a function of `quick`."""
    return lambda is_quick: quick if is_quick else full


@dataclass(frozen=True, slots=True)
class Measured:
    """What the points of a figure gave, in its small or its full size."""

    values: Results
    quick: bool

    def __getitem__(self, point: Point) -> Any:
        """The result of a point."""
        return self.values[point.key]

    def floats(self, point: Point, name: str) -> Any:
        """An array of what each seed gave under a name; NaN where it gave None."""
        return np.array(self.values[point.key][name], float)


@dataclass(frozen=True, slots=True)
class Claim:
    """One row of the table: what the paper (or an issue) says, and what came out."""

    figure: str  # of the paper; "beyond" where the paper has none
    claim: str  # as the paper means it
    measurement: str  # with its unit and how many runs it is of
    # "holds", "holds with reading E..", "does not hold". Readings are those of the skin's errata
    # (E), of the radio's questions and findings (Q, F), of the mesh's ambiguities (A)
    verdict: str
    reason: str = ""  # why; empty where it simply holds
    # whose sentence it is: OURS, or the document's words (`quoted`); empty in a book that does not
    # tell them apart
    source: str = ""

    @property
    def whose(self) -> str:
        """Where it stands, in the words of page, tables and terminal."""
        if self.source == OURS:
            return f"{OURS}, {self.figure}"
        return self.source or self.figure


Claims = Iterator[Claim]


def quoted(section: str, words: str) -> str:
    """The source of a claim that is the document's: its section, and its own words."""
    return f'the document, {section}: "{words}"'


def beyond(claim: str, measurement: str, verdict: str, reason: str = "") -> Claim:
    """A claim that the paper does not make."""
    return Claim("beyond", claim, measurement, verdict, reason)


def summary(claims: Sequence[Claim]) -> str:
    """How many claims came out how, the document's and ours apart where they are told apart."""
    mine = [claim for claim in claims if claim.source == OURS]
    quoting = [claim for claim in claims if claim.source not in ("", OURS)]
    if not mine and not quoting:
        return f"{len(claims)} claims: {_counts(claims)}."
    return (
        f"{len(quoting)} claims of the document: {_counts(quoting)}. "
        f"{len(mine)} of ours: {_counts(mine)}."
    )


def _counts(claims: Sequence[Claim]) -> str:
    plain, fails = (sum(claim.verdict == way for claim in claims) for way in (HOLDS, FAILS))
    read = len(claims) - plain - fails
    return f"{plain} hold, {read} hold with a reading of ours, {fails} do not hold"


@dataclass(frozen=True, slots=True)
class Sheet:
    """A table for people: its title, its head, its rows, all of them text."""

    title: str
    head: tuple[str, ...]
    rows: Sequence[tuple[str, ...]]


@dataclass(frozen=True, slots=True)
class Experiment:
    """A figure: its points, its drawing, its rows of the table.

    As a module it is TITLE, CAPTION, `points(quick)`, and `draw`, `judge` and perhaps `sheets`,
    tables of its own, which take what was measured. Quick is fewer seeds and settings, the same
    code. Only what compares compiles what it runs by itself (`warm_up`).
    """

    name: str
    title: str
    caption: str
    points: Callable[[bool], list[Point]]
    draw: Callable[[Measured], Figure]
    judge: Callable[[Measured], Iterable[Claim]]
    sheets: Callable[[Measured], Iterable[Sheet]] = lambda got: ()
    warm_up: Callable[[], None] | None = None

    @classmethod
    def of(cls, book: str, name: str) -> Experiment:
        """The experiment that a module of a book is, loaded when it is asked for."""
        one = import_module(f"{book}.{name}")
        more = {"sheets": one.sheets} if hasattr(one, "sheets") else {}
        return cls(name, one.TITLE, one.CAPTION, one.points, one.draw, one.judge, **more)


@dataclass(frozen=True, slots=True)
class Span:
    """The values that a verdict accepts, both ends included."""

    low: float = -inf
    high: float = inf

    def has(self, *values: float) -> bool:
        """True if all lie inside, and there is one; what never happened (NaN) does not."""
        return bool(values) and all(self.low <= value <= self.high for value in values)

    def share(self, values: Any) -> float:
        """Which share of the values lies inside, 0 to 1; what never happened (NaN) does not."""
        return float(np.mean((self.low <= values) & (values <= self.high)))


def about(value: float) -> Span:
    """What counts as "about" a value: no more than a quarter off, up or down."""
    return Span(0.75 * value, 1.25 * value)


def reading(*errata: str) -> str:
    """The verdict of a claim that holds once those errata or questions are read as here."""
    return f"{HOLDS} with reading {', '.join(errata)}"


def verdict(passed: bool, *errata: str) -> str:
    """Holds (with these readings), or not."""
    if not passed:
        return FAILS
    return reading(*errata) if errata else HOLDS
