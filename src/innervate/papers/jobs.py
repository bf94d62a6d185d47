"""A comparison: one job, several protocols that do it, the same links, faults and seeds for all.

A network's part `comparison` is a module with JOBS, the jobs that it sets, and ENTRIES, what of it
does which job. An entry knows a job by its name and by what its cases give it, plain numbers and
texts; so no network knows another.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from math import inf
from typing import Any, NamedTuple

from innervate.analysis import intervals
from innervate.network import networks
from innervate.papers.experiment import Claim, Measured, Point, Sheet, verdict

MEDIAN, TAIL, MEAN, TOTAL, SHARE, MOST = "median", "tail", "mean", "total", "share", "most"
PERCENT = "percent"
TAIL_SHARE = 0.9
Given = Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class Column:
    """One column of a job's tables."""

    head: str  # with its unit
    name: str  # of the number in what entries measure; None there = it never happened
    # of all runs: MEDIAN, TAIL (90 % are no greater), MEAN, PERCENT (a mean of 0 to 100), each with
    # its 95 % interval; TOTAL, MOST; SHARE: how many are above 0, with Wilson's interval
    show: str = MEDIAN
    digits: int = 1  # behind the point


@dataclass(frozen=True, slots=True)
class Case:
    """One setting of a job, a table of its own."""

    name: str  # says all that decides its runs but the entry and the seed
    title: str  # of its table
    given: Given  # what entries are given: plain numbers, texts, lists, dicts
    seeds: range  # of its runs, the same for every entry
    columns: tuple[Column, ...]  # of its table


@dataclass(frozen=True, slots=True)
class Entry:
    """A protocol, as it is set, that does a job."""

    job: str  # which
    name: str  # a few words, as the tables call it
    what: str  # a sentence: which protocol, which settings
    # (what a case gives, seed) -> numbers by the columns' names; None = never happened
    measure: Callable[[Given, int], dict[str, Any]]
    warm_up: Callable[[], None]  # compiles what it runs
    cost_s: float = 0.2  # about how long a run takes
    # (what a case gives) -> True if it can be measured there
    does: Callable[[Given], bool] = field(default=lambda given: True)


@dataclass(frozen=True, slots=True)
class Job:
    """What all have to do."""

    name: str  # "skin"; what `--only` takes
    # title, caption: of its figure
    title: str
    caption: str
    cases: Callable[[bool], list[Case]]  # (quick) -> all cases, in order
    judge: Callable[[Compared], Iterator[Claim]]  # what is claimed of it: (compared) -> claims
    # column name that the figure shows, of all cases that have it, and its axis in words
    drawn: tuple[str, str]


def parts() -> list[Any]:
    """The parts `comparison` of all networks that have one, in the networks' order."""
    return [one.comparison for one in networks().values() if one.has("comparison")]


def jobs() -> dict[str, Job]:
    """All jobs by their names."""
    return {job.name: job for part in parts() for job in getattr(part, "JOBS", ())}


def entries(job: str) -> list[Entry]:
    """All that do a job."""
    return [one for part in parts() for one in getattr(part, "ENTRIES", ()) if one.job == job]


def runs(case: Case, entry: Entry) -> list[Point]:
    """The runs of an entry in a case, a point a seed: what is done stays where seeds are added."""
    what = f"{entry.job}, {case.name}: {entry.name}"
    return [Point.of(f"{what}, seed {seed}", entry.cost_s, entry.measure, case.given, seed)
            for seed in case.seeds]  # fmt: skip


def points(job: Job, quick: bool) -> list[Point]:
    """All runs of a job."""
    return [
        one for case in job.cases(quick) for entry in doing(job, case) for one in runs(case, entry)
    ]


def doing(job: Job, case: Case) -> list[Entry]:
    """All entries that can be measured in a case."""
    return [entry for entry in entries(job.name) if entry.does(case.given)]


@dataclass(frozen=True, slots=True)
class Compared:
    """What the runs of a job gave."""

    job: Job
    got: Measured

    def cases(self) -> list[Case]:
        """All cases of the job."""
        return self.job.cases(self.got.quick)

    def values(self, case: Case, entry: Entry, name: str) -> list[float]:
        """What every seed gave that gives it; what never happened is infinite."""
        return list(self._by_seed(case, entry, name).values())

    def _by_seed(self, case: Case, entry: Entry, name: str) -> dict[int, float]:
        found = zip(case.seeds, (self.got[run] for run in runs(case, entry)), strict=True)
        return {seed: inf if one[name] is None else float(one[name])
                for seed, one in found if name in one}  # fmt: skip

    def sheets(self) -> list[Sheet]:
        """The tables: one a case, a row an entry."""
        made = []
        for case in self.cases():
            rows = []
            for entry in doing(self.job, case):
                cells = (cell(self.values(case, entry, one.name), one) for one in case.columns)
                rows.append((entry.name, *cells))
            head = ("who", *(column.head for column in case.columns))
            made.append(Sheet(f"{case.title}; {len(case.seeds)} runs each", head, rows))
        return made

    def less(
        self, where: Mapping[str, Case], name: str, pair: tuple[str, str], words: Words
    ) -> Claim:
        """The claim that, seed by seed, the first of a pair of entries gives less than the second.

        It holds if in all cases, `where` by a word for each, the 95 % interval of the median
        difference lies below 0.
        """
        known = {one.name: one for one in entries(self.job.name)}
        holds, said = True, []
        for word, case in where.items():
            ours, its = (self._by_seed(case, known[who], name) for who in pair)
            both = [(ours[seed], its[seed]) for seed in ours if seed in its]
            differences = [a - b if a != b else 0.0 for a, b in both]
            between = intervals.median_interval(differences)
            holds = holds and between.high < 0
            fewer, more = sum(d < 0 for d in differences), sum(d > 0 for d in differences)
            counts = f"less in {fewer} and more in {more} of {len(differences)}"
            label = f"{word}: " if word else ""
            said.append(f"{label}{shown(between, words.digits)}, {counts}")
        why = "" if holds else words.why
        measured = f"median difference {'; '.join(said)}"
        return Claim(self.job.name, words.claim, measured, verdict(holds), why)


class Words(NamedTuple):
    """What a claim says; why, where it does not hold; digits of its differences."""

    claim: str
    why: str = ""
    digits: int = 1


def cell(values: list[float], column: Column) -> str:
    """What all runs of a case gave of one column, in words."""
    if not values:
        return "-"
    never = sum(value == inf for value in values)
    finite = [value for value in values if value < inf]
    digits = column.digits
    if column.show in (TOTAL, MOST):
        return f"{(sum if column.show == TOTAL else max)(values):.{digits}f}"
    if column.show == SHARE:
        hits = sum(value > 0 for value in values)
        return f"{hits} ({interval(intervals.wilson(hits, len(values)), 2)})"
    if not finite:
        return "never"
    if 2 * never > len(values) and column.show == MEDIAN:
        return f"never in {never} of {len(values)}"
    if column.show in (MEAN, PERCENT):
        found = intervals.mean_interval(finite)
        if column.show == PERCENT:
            found = intervals.Interval(found.value, max(found.low, 0.0), min(found.high, 100.0))
    else:
        found = intervals.quantile_interval(values, 0.5 if column.show == MEDIAN else TAIL_SHARE)
    return shown(found, digits) + (f", never in {never}" if never else "")


def shown(found: intervals.Interval, digits: int) -> str:
    """An estimate with its interval: "12.0 (11.2 to 12.9)"; "never" needs none."""
    if abs(found.value) == inf and found.low == found.high:
        return number(found.value, digits)
    return f"{number(found.value, digits)} ({interval(found, digits)})"


def interval(found: intervals.Interval, digits: int) -> str:
    """An interval without its estimate."""
    return f"{number(found.low, digits)} to {number(found.high, digits)}"


def number(value: float, digits: int) -> str:
    """A number, or that it never happened; in differences also that it never did by the other."""
    if value == -inf:
        return "never by the other"
    return "never" if value == inf else f"{value:.{digits}f}"
