"""What differs between two run folders: scenario, summary, and the first event that differs."""

from __future__ import annotations

import os
import tomllib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from innervate import scenario as scenarios
from innervate.analysis.headline import HeadlineEntry
from innervate.network import known, networks
from innervate.running import folder as folders
from innervate.running.errors import RunError
from innervate.running.recorded import RecordedRun, time_of
from innervate.running.run import Run
from innervate.running.trail import first_difference

# What says nothing about the trajectory.
_ASIDE = ("wall_s", "events_per_s")

Difference = tuple[str, Any, Any]
Side = str | os.PathLike[str] | Run


@dataclass(frozen=True, slots=True)
class Divergence:
    """The first handler call that differs between two runs."""

    time_s: float  # when, the earlier of the two
    # The call in either run, in words; "nothing more" where one had ended.
    a: str
    b: str
    same_call: bool  # the same call in both, but with another outcome

    def __str__(self) -> str:
        if self.same_call:
            return f"{self.a}: the same call, but another outcome"
        return f"{self.a} against {self.b}"


@dataclass(frozen=True, slots=True)
class Comparison:
    """Two runs side by side.

    Attributes:
        scenario: (dotted key, value in a, value in b) of all keys that differ; None = not set.
        summary: the same for the summary, without what depends on the machine.
        divergence: the first handler call that differs; None if none does.
        notes: what to know besides, a sentence each.
        headlines: of both runs, as in their summaries; None of a run made before there were any.
    """

    scenario: list[Difference]
    summary: list[Difference]
    divergence: Divergence | None
    notes: list[str]
    headlines: tuple[HeadlineEntry | None, HeadlineEntry | None]

    @property
    def same(self) -> bool:
        """True if both runs were the same, event by event."""
        return self.divergence is None and not self.summary


@dataclass(frozen=True, slots=True)
class _Side:
    """What is compared of a run."""

    called: str
    summary: dict[str, Any]
    provenance: dict[str, Any]
    tables: dict[str, Any]  # its scenario
    plan: Callable[[], Any]

    @property
    def trajectory(self) -> dict[str, Any]:
        """The summary without what depends on the machine."""
        return {name: value for name, value in self.summary.items() if name not in _ASIDE}

    @property
    def fingerprint(self) -> Any:
        """The hash of all events, 16 hexadecimal digits; None if it has none."""
        return self.summary.get("fingerprint")

    @property
    def ended_us(self) -> int:
        """Simulated time the run came to, us."""
        ended = self.summary.get("interrupted_at_s", self.summary.get("duration_s"))
        return round(1e6 * time_of(ended, self.called))


def compare(a: Side, b: Side) -> Comparison:
    """What differs between two runs; if they differ, both are simulated again to find where.

    Args:
        a: a run, or the folder of one.
        b: another.

    Raises:
        RunError: one of them is not a run folder, or damaged.
    """
    one, other = _side(a), _side(b)
    divergence = None
    if one.fingerprint != other.fingerprint or one.ended_us != other.ended_us:
        divergence = _diverge(one, other)
    return Comparison(
        scenario=differences(one.tables, other.tables),
        summary=differences(one.trajectory, other.trajectory),
        divergence=divergence,
        notes=_notes(one, other),
        headlines=(one.summary.get("headline"), other.summary.get("headline")),
    )


def differences(a: Any, b: Any, key: str = "") -> list[Difference]:
    """All leaves in which two nested structures differ, by dotted key, in the order of `a`."""
    if isinstance(a, dict) and isinstance(b, dict):
        names = [*a, *(name for name in b if name not in a)]
        pairs = [(f"{key}.{n}" if key else n, a.get(n), b.get(n)) for n in names]
    elif isinstance(a, list) and isinstance(b, list) and any(isinstance(x, dict) for x in a + b):
        longest = max(len(a), len(b))
        left, right = (x + [None] * (longest - len(x)) for x in (a, b))
        pairs = [(f"{key}.{i}", left[i], right[i]) for i in range(longest)]
    else:
        return [] if a == b else [(key, a, b)]
    return [found for pair in pairs for found in differences(pair[1], pair[2], pair[0])]


def _side(given: Side) -> _Side:
    if not isinstance(given, Run):
        return _recorded(Path(given))
    tables = tomllib.loads(scenarios.dump(given.scenario))
    return _Side(repr(given), dict(given.summary), given.provenance, tables, lambda: given.plan)


def _recorded(folder: Path) -> _Side:
    if not folder.is_dir():
        what = "it is a file" if folder.exists() else "there is no such folder"
        raise RunError(f"{folder} is not a run folder: {what}")
    run = RecordedRun(folder)
    run.check_tables()
    path = run.scenario
    try:
        tables = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError):
        raise RunError(f"{path} is damaged; run the scenario again") from None
    kind = run.summary.get("kind")
    if not isinstance(kind, str):
        raise RunError(f"{folder / folders.SUMMARY} is damaged; run the scenario again")
    known(kind, folder)
    return _Side(str(folder), run.summary, run.provenance, tables, run.plan)


def _diverge(a: _Side, b: _Side) -> Divergence | None:
    plans = a.plan(), b.plan()
    rows = first_difference(
        *(
            networks()[plan.kind].run.trail(plan, min(run.ended_us, plan.duration_us))
            for plan, run in zip(plans, (a, b), strict=True)
        )
    )
    if rows is None:
        return None
    words = [_in_words(plan, row) for plan, row in zip(plans, rows, strict=True)]
    times = [int(row["time"]) for row in rows if row is not None]
    return Divergence(min(times) / 1e6, words[0], words[1], words[0] == words[1])


def _in_words(plan: Any, row: Any) -> str:
    """A row of the trail: "2.016000 s, p0 r3 c4: beacon period"."""
    if row is None:
        return "nothing more"
    return f"{int(row['time']) / 1e6:.6f} s, {networks()[plan.kind].run.call_words(plan, row)}"


def _notes(a: _Side, b: _Side) -> list[str]:
    notes = []
    for key in ("innervate", "commit", "packages", "python"):
        one, other = a.provenance.get(key), b.provenance.get(key)
        if one != other:
            notes.append(f"{key} differs: {one} and {other}")
    without = [networks()[run.summary["kind"]].without_events(run.summary) for run in (a, b)]
    notes += dict.fromkeys(filter(None, without))
    for run in (a, b):
        if "interrupted_at_s" in run.summary:
            notes.append(f"{run.called} was interrupted at {run.ended_us / 1e6:g} s")
    return notes
