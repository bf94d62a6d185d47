"""What a published figure is here: simulations to run, a drawing, claims against measurements."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from math import inf
from typing import Any

from matplotlib.figure import Figure

HOLDS = "holds"
FAILS = "does not hold"

# Results of points by their keys: whatever JSON can hold.
Results = Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class Point:
    """One piece of work whose result is kept.

    Attributes:
        key: says everything that decides the result; equal keys are run once.
        work: runs it; what it returns is plain numbers, texts, lists and dicts.
        cost_s: about how long that takes, for the time left.
    """

    key: str
    work: Callable[[], Any]
    cost_s: float = 0.5

    @classmethod
    def of(cls, key: str, cost_s: float, work: Callable[..., Any], *args: Any) -> Point:
        """The point that calls `work` with these arguments."""
        return cls(key, partial(work, *args), cost_s)


@dataclass(frozen=True, slots=True)
class Claim:
    """One row of the table: what the paper (or an issue) says, and what came out.

    Attributes:
        figure: of the paper; "beyond" where the paper has none.
        claim: as the paper means it.
        measurement: with its unit and how many runs it is of.
        verdict: "holds", "holds with reading E..", "does not hold". Readings are
            those of the skin's errata (E), of the radio's questions and findings (Q, F), of the
            mesh's ambiguities (A).
        reason: why; empty where it simply holds.
    """

    figure: str
    claim: str
    measurement: str
    verdict: str
    reason: str = ""


@dataclass(frozen=True, slots=True)
class Experiment:
    """A figure: its points, its drawing, its rows of the table.

    All three take `quick`: fewer seeds and settings, the same code.
    """

    name: str
    title: str
    caption: str
    points: Callable[[bool], list[Point]]
    draw: Callable[[Results, bool], Figure]
    judge: Callable[[Results, bool], list[Claim]]


@dataclass(frozen=True, slots=True)
class Span:
    """The values that a verdict accepts, both ends included."""

    low: float = -inf
    high: float = inf

    def has(self, *values: float) -> bool:
        """True if all lie inside, and there is one; what never happened (NaN) does not."""
        return bool(values) and all(self.low <= value <= self.high for value in values)


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
