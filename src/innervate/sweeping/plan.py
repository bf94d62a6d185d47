"""The plan of a sweep: its points, their seeds, how often each is repeated.

A point is known by its settings, not by its number, and so are its seeds: points and repeats that
are added later change nothing for those that were there.
"""

import hashlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from itertools import product
from math import prod
from typing import Any

import msgspec

from innervate.scenario import ScenarioError
from innervate.sweeping.base import Base, Settings
from innervate.sweeping.derive import Formula
from innervate.sweeping.errors import SweepError
from innervate.sweeping.sources import folder_mark
from innervate.sweeping.until import Until
from innervate.sweeping.vary import Axis, canonical, column, plain, shown
from innervate.trace.sources import stamp
from innervate.trace.streams import stream

POINTS_MAX = 1_000_000
REPEAT_MAX = 1_000_000
RUNS_MAX = 10_000_000  # tables of so many take 30 GB of memory
SEED_BITS = 48  # two of a million repeats of a point agree with a chance of 0.2 %
ALL = "all"


@dataclass(frozen=True, slots=True)
class Point:
    """One combination of what is varied."""

    index: int  # its place in the plan, from 0
    settings: Settings  # (dotted key, value), the derived ones last
    columns: dict[str, Any]  # what the results' columns say of them
    digest: str  # names it, by its settings alone
    stream: str  # names its random numbers; points that are compared in pairs share it

    @property
    def label(self) -> str:
        """The point's settings, as "a=1, b=2"."""
        return ", ".join(f"{key}={shown(value)}" for key, value in self.columns.items())


@dataclass(frozen=True)
class SweepPlan:
    """What is to be run."""

    base: Base  # the scenario
    # what is varied; the points are all combinations, the last axis changing fastest
    axes: tuple[Axis, ...] = ()
    # (key, formula) of values that follow from others
    derived: tuple[tuple[str, Formula], ...] = ()
    repeat: int = 1  # runs of every point, at most with `until`
    batch: int = 10  # repeats between two decisions of `until`
    until: tuple[Until, ...] = ()  # rules that end a point early once all of them are met
    root: int = 1  # the root seed
    # keys in which points differ that share their seeds, run by run; or ("all",)
    paired: tuple[str, ...] = ()
    name: str = "sweep"  # of the sweep
    plots: tuple[Any, ...] = field(default=())  # figures to draw of it

    @property
    def keys(self) -> tuple[str, ...]:
        """All keys that are varied or derived, in order."""
        return (*(key for axis in self.axes for key in axis.keys), *(k for k, _ in self.derived))

    @cached_property
    def points(self) -> tuple[Point, ...]:
        """All points in order; a SweepError if there are too many, or a key is varied twice."""
        keys = self.keys
        twice = [key for key in dict.fromkeys(keys) if keys.count(key) > 1]
        if twice:
            raise SweepError(f"{twice[0]} is varied twice; put its values into one list")
        count = prod(len(axis.steps) for axis in self.axes)
        if count > POINTS_MAX:
            raise SweepError(f"{count:,} points; a sweep takes at most {POINTS_MAX:,}")
        runs = count * self.first_block
        if runs > RUNS_MAX:
            raise SweepError(f"{runs:,} runs; a sweep takes at most {RUNS_MAX:,}")
        strange = [key for key in self.paired if key != ALL and key not in keys]
        if strange:
            raise SweepError(f"paired: {strange[0]} is not varied; it can pair nothing")
        tables = self._tables
        return tuple(
            self._point(i, steps, tables)
            for i, steps in enumerate(product(*(axis.steps for axis in self.axes)))
        )

    def _point(self, index: int, steps: tuple[Any, ...], tables: dict[str, Any]) -> Point:
        varied = [(key, value) for axis, step in zip(self.axes, steps, strict=True)
                  for key, value in zip(axis.keys, step, strict=True)]  # fmt: skip
        values = {key: plain(value) for key, value in varied}
        free = {k: v for k, v in values.items() if k not in self.paired and ALL not in self.paired}
        columns = {key: column(value) for key, value in varied}
        for key, formula in self.derived:
            values[key] = columns[key] = formula.value(lambda name: _look_up(name, values, tables))
        return Point(index, tuple(values.items()), columns, _digest(values), _digest(free))

    @property
    def _tables(self) -> dict[str, Any]:
        """The scenario's tables, for formulas; empty where they need none or it is not whole."""
        if not self.derived:
            return {}
        try:
            tables: dict[str, Any] = msgspec.to_builtins(self.base.scenario().model)
        except ScenarioError:
            return {}
        return tables

    def seed(self, point: Point, repeat: int) -> int:
        """The seed of a run, 0 .. 2^48-1."""
        numbers = stream(self.root, f"sweep/{point.stream}/{repeat}")
        return numbers.next64() >> (64 - SEED_BITS)

    @property
    def first_block(self) -> int:
        """Repeats that every point gets in any case."""
        return min(self.batch, self.repeat) if self.until else self.repeat

    def identity(self) -> dict[str, str]:
        """What may not change between two parts of a sweep: (in words, its mark)."""
        network = folder_mark(self.base.kind)
        own = {f"the network {self.base.kind}": network} if network else {}
        return own | {
            "the scenario": hashlib.sha256(self.base.text.encode()).hexdigest(),
            "what --set says": canonical([list(pair) for pair in self.base.settings]),
            "the root seed": str(self.root),
            "what is paired": canonical(list(self.paired)),
            "the version of innervate": stamp("running"),
        }


def _digest(values: Mapping[str, Any]) -> str:
    return hashlib.blake2b(canonical(dict(values)).encode(), digest_size=12).hexdigest()


def _look_up(name: str, values: Mapping[str, Any], tables: Any) -> Any:
    """A key's value: of the point, else of the scenario."""
    if name in values:
        return values[name]
    here = tables
    for part in name.split("."):
        here = here[int(part)] if isinstance(here, list) and part.isdigit() else here[part]
    return here


def blocks(plan: SweepPlan) -> Iterator[tuple[int, int]]:
    """(first, behind) of the batches of repeats that `until` decides on, in order."""
    size = plan.batch if plan.until else plan.repeat
    for first in range(0, plan.repeat, size):
        yield first, min(first + size, plan.repeat)
