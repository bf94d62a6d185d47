"""What a sweep came to: its tables as polars frames, means with intervals, pairs, figures."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from importlib import import_module
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any

from innervate.analysis.intervals import mean_interval, quantile
from innervate.sweeping import tables
from innervate.sweeping.errors import SweepError
from innervate.sweeping.plan import Point, SweepPlan
from innervate.trace.provenance import SCHEMA
from innervate.trace.sources import stamp
from innervate.trace.tables import arrays, to_pandas

if TYPE_CHECKING:
    import polars

LEVEL = 0.95
# What is shown if nobody says: of these, those that the runs have.
SHOWN = (
    "recoveries.routed_ms", "cut_off.most", "data.loss_ratio",
    "throughput", "delay_slots.p50",
    "delivery_ratio", "latency_ms.p50",
)  # fmt: skip
SHOWN_MAX = 3
COMPARED = ("mean_one", "mean_other", "difference", "low", "high")  # of two variants


@dataclass(eq=False, repr=False)
class Sweep:
    """A sweep that was run.

    Attributes:
        plan: what was wanted.
        results: a row for every run, by point and repeat: settings, seed, status, reason, the
            command that runs it again, and all figures of its summary.
        timings: how long every run took, and where.
        complete: nothing is missing.
        ran: runs that were done now rather than earlier.
        others: runs that the folder keeps besides, of other points or repeats.
        torn: rows of the job table that were found torn, in words.
        written: the folder, if there is one.
    """

    plan: SweepPlan
    results: polars.DataFrame
    timings: polars.DataFrame
    complete: bool = True
    ran: int = 0
    others: int = 0
    torn: tuple[str, ...] = ()
    written: Path | None = field(default=None)

    def __repr__(self) -> str:
        """Short: how much there is."""
        count = len(self.plan.points)
        return f"Sweep({self.plan.name!r}, {count} points, {self.results.height} runs)"

    @property
    def failed(self) -> polars.DataFrame:
        """The rows of the runs that failed."""
        return self.results.filter(self.results["status"] == "failed")

    @property
    def measures(self) -> list[str]:
        """Columns of the results that are figures."""
        return tables.measures(self.results, self.plan.keys)

    def numpy(self) -> dict[str, Any]:
        """The results as NumPy arrays by the names of their columns."""
        return arrays(self.results)

    def pandas(self) -> Any:
        """The results as a pandas data frame; needs pandas."""
        return to_pandas(self.results)

    def _repr_html_(self) -> str:
        """In a notebook: what its runs came to, the means as pictures and of every point."""
        room: Any = import_module("innervate.sweeping.report")
        return str(room.in_cell(self))

    def report(self, wanted: Sequence[str] = ()) -> str:
        """Its page as HTML, one file that needs nothing else: headline, means, runs not well.

        Args:
            wanted: the measures that pictures are of; those of to_show() if left out.
        """
        room: Any = import_module("innervate.sweeping.report")
        return str(room.render(self, wanted))

    def to_show(self, wanted: Sequence[str] = ()) -> list[str]:
        """The measures that somebody sees first: all those wanted, valued or not; or a few."""
        asked = [one for one in wanted if one not in self.plan.keys]
        height = self.results.height
        there = [one for one in self.measures if self.results[one].null_count() < height]
        return asked or ([one for one in SHOWN if one in there] or there)[:SHOWN_MAX]

    def without_value(self) -> dict[str, list[int]]:
        """By measure of `until`, the points that have runs of which none has a value of it."""
        found = {}
        done = self.results.filter(self.results["status"] == "done")
        for measure in dict.fromkeys(rule.measure for rule in self.plan.until):
            there = done.drop_nulls(measure) if measure in done.columns else done.clear()
            found[measure] = sorted({*done["point"]} - {*there["point"]})
        return {measure: points for measure, points in found.items() if points}

    @property
    def provenance(self) -> dict[str, Any]:
        """What the results come from."""
        return {
            "schema": SCHEMA,
            "sources": stamp("running"),
            "identity": self.plan.identity(),
            "runs": self.results.height,
            "failed": self.failed.height,
            "complete": self.complete,
        }

    def points(self, measures: str | Iterable[str] = (), level: float = LEVEL) -> polars.DataFrame:
        """A row for every point and measure: runs, mean, its interval (low, high), quantiles.

        Args:
            measures: which; all if left out.
            level: of Student's confidence interval, between 0 and 1; 0.95.

        Raises:
            SweepError: no such measure.
        """
        wanted = [measures] if isinstance(measures, str) else list(measures)
        for name in wanted:
            self._check(name)
        return tables.points(self.results, self.plan.points, wanted or self.measures, level)

    def quantiles(self, measure: str, shares: Sequence[float]) -> polars.DataFrame:
        """A row for every point: the measure's quantiles, in columns q0.5, q0.95, ...

        Raises:
            SweepError: no such measure, or a share outside 0..1.
        """
        self._check(measure)
        if not all(0 <= share <= 1 for share in shares):
            raise SweepError("shares of quantiles lie between 0 and 1")
        rows = []
        for point in self.plan.points:
            values = list(self._by_repeat(point.index, measure).values())
            found = {f"q{s:g}": quantile(values, s) if values else None for s in shares}
            rows.append({"point": point.index, **point.columns, "runs": len(values)} | found)
        return tables.frame(rows, numbers=[f"q{s:g}" for s in shares])

    def compare(
        self, key: str, one: Any, other: Any, measure: str, level: float = LEVEL
    ) -> polars.DataFrame:
        """Two variants on common seeds: a row for every setting of the rest, `other` minus `one`.

        Differences are taken run by run, which is much sharper than two intervals side by side;
        the sweep must have been made with this key `paired`.

        Args:
            key: in which the two differ.
            one: its value in one variant.
            other: its value in the other.
            measure: what is compared.
            level: of the interval, between 0 and 1; 0.95.

        Returns:
            The other keys, pairs, mean_one, mean_other, difference, low, high.

        Raises:
            SweepError: the key is not varied, not paired, has no such value; no such measure.
        """
        self._check(measure)
        if key not in self.plan.keys:
            raise SweepError(f"{key} is not varied; {', '.join(self.plan.keys)} are")
        ones, others = (self._variant(key, value) for value in (one, other))
        common = [place for place in ones if place in others]
        if not common:
            raise SweepError(f"{key} is not paired; sweep with paired={key!r} (--paired {key})")
        rows = []
        for place in common:
            for a, b in product(ones[place], others[place]):
                rest = {k: v for k, v in a.columns.items() if k != key}
                rows.append(rest | self._pairs(a.index, b.index, measure, level))
        return tables.frame(rows, numbers=COMPARED)

    def _variant(self, key: str, value: Any) -> dict[Any, list[Point]]:
        """The points that have this value, by the stream of their seeds and the other settings."""
        bound = self._bound_to(key)
        free = [k for axis in self.plan.axes for k in axis.keys if k not in bound]
        found: dict[Any, list[Point]] = {}
        for point in self.plan.points:
            if point.columns[key] == value:
                rest = tuple(point.columns[k] for k in free)
                found.setdefault((point.stream, rest), []).append(point)
        if not found:
            raise SweepError(f"no point has {key}={value}")
        return found

    def _bound_to(self, key: str) -> set[str]:
        """The keys that change together with one, and, if it is derived, those it follows from."""
        found = {key}
        for name, formula in reversed(self.plan.derived):
            found |= set(formula.keys) if name in found else set()
        together = [axis.keys for axis in self.plan.axes if found.intersection(axis.keys)]
        return found.union(*together)

    def plot(self, x: str, y: str, by: str = "", kind: str = "band", title: str = "") -> Any:
        """A matplotlib figure: means of `y` over `x` with bands, a line for each value of `by`.

        Args:
            x: a varied key, or a measure (then every run is a dot).
            y: a measure.
            by: another varied key; of a heat map the second axis.
            kind: "band" or "heat".
            title: above it.

        Raises:
            SweepError: no such column, or nothing to draw.
        """
        room: Any = import_module("innervate.plot.sweeps")
        for name in filter(None, (x, y, by)):
            self._check(name)
        if self.results[y].null_count() == self.results.height:
            raise SweepError(f'no run has a value of "{y}"')
        numbers = [*self.measures, *self.plan.keys]
        if y not in numbers or kind not in room.KINDS or (kind == "heat" and not by):
            raise SweepError(
                f"a figure takes a measure as y, kind {' or '.join(room.KINDS)}, heat also by"
            )
        over = self.averaged(x, by) if x in self.plan.keys else None
        columns = self.results.to_dict(as_series=False)
        return room.draw(columns, room.Shown(x, y, by, kind, title), over)

    def averaged(self, *axes: str) -> dict[str, int]:
        """Over what else than its axes a figure takes its means: varied keys, how many values."""
        shown = [key for key in axes if key in self.plan.keys]
        found: dict[str, int] = {}
        for key in self.plan.keys:
            values: dict[tuple[Any, ...], set[str]] = {}
            for point in self.plan.points:
                place = tuple(point.columns[name] for name in shown)
                values.setdefault(place, set()).add(repr(point.columns[key]))
            most = max(map(len, values.values()), default=0)
            if key not in shown and most > 1:
                found[key] = most
        return found

    def _pairs(self, a: int, b: int, measure: str, level: float) -> dict[str, Any]:
        one, other = (self._by_repeat(index, measure) for index in (a, b))
        both = [repeat for repeat in one if repeat in other]
        if not both:
            return {"pairs": 0} | dict.fromkeys(COMPARED)
        found = mean_interval([other[r] - one[r] for r in both], level)
        means = (sum(side[r] for r in both) / len(both) for side in (one, other))
        return {"pairs": len(both)} | dict(zip(COMPARED, (*means, *found), strict=True))

    def _by_repeat(self, index: int, measure: str) -> dict[int, float]:
        mine = self.results.filter(self.results["point"] == index)
        rows = zip(mine["repeat"].to_list(), mine[measure].to_list(), strict=True)
        return {repeat: value for repeat, value in rows if value is not None}

    def _check(self, name: str) -> None:
        if name not in self.results.columns:
            near = [c for c in self.results.columns if c.split(".")[-1] == name.split(".")[-1]]
            some = near or self.measures
            raise SweepError(f'there is no column "{name}"; there are {", ".join(some[:8])}, ...')
