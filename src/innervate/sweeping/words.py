"""What a sweep came to, in sentences: for the terminal, for its page, for programs."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from innervate.analysis.headline import (
    DEGRADED,
    LEVELS,
    NO_DATA,
    OK,
    HeadlineEntry,
    part_of,
    sentence,
    verb,
)  # fmt: skip
from innervate.sweeping.tables import reasons

if TYPE_CHECKING:
    from innervate.sweeping.result import Sweep

REASONS_MAX = 5


def levels(done: Sweep) -> dict[str, int]:
    """How many runs have a headline of each level; none of those that failed."""
    table = done.results
    found = list(table["headline.level"]) if "headline.level" in table.columns else []
    return {level: found.count(level) for level in LEVELS}


def headline(done: Sweep) -> HeadlineEntry:
    """The worst that a run of the sweep came to, and how many runs came to what, worst first."""
    found, whole = levels(done), done.results.height
    shown = [
        (count, f"{verb(count, 'has' if level == NO_DATA else 'is')} {level}")
        for level, count in found.items() if count
    ]  # fmt: skip
    shown = [(done.failed.height, "failed")] * (done.failed.height > 0) + shown[::-1]
    worst = next((level for level in reversed(LEVELS) if found[level]), NO_DATA)
    if worst == OK and (done.failed.height or not done.complete):
        worst = DEGRADED
    parts = [f"{part_of(count, whole, 'run')} {what}" for count, what in shown]
    if not done.complete:
        parts.append("the sweep was interrupted, and the same command goes on" if parts else
                     "no run is done")  # fmt: skip
    return {"level": worst, "text": sentence(parts)}


def never_lines(done: Sweep) -> list[str]:
    """Which measures of --until have no value at some points, so that these end without one."""
    lines = []
    for measure, points in done.without_value().items():
        some = ", ".join(map(str, points[:REASONS_MAX]))
        more = f" and {len(points) - REASONS_MAX} more" if len(points) > REASONS_MAX else ""
        where = f" of point{'s' if len(points) > 1 else ''} {some}{more}"
        lines.append(f"--until {measure}: no run{where if len(done.plan.points) > 1 else ''} has a "
                     "value of it, so that there is no interval")  # fmt: skip
    return lines


def headline_lines(done: Sweep) -> list[str]:
    """How many runs are not well, by their headlines, with the first of each level."""
    table, lines = done.results, []
    for level, count in levels(done).items():
        if count and level != OK:
            first = table.filter(table["headline.level"] == level).row(0, named=True)
            lines.append(
                f"{count} of {table.height} runs: {level}; the first, point "
                f"{first['point']} with seed {first['seed']}: {first['headline.text']}"
            )
    return lines


def failed_lines(done: Sweep) -> list[str]:
    """How many runs failed, and why."""
    if not done.failed.height:
        return []
    counts = list(reasons(done.failed).items())
    lines = [f"{done.failed.height} of {done.results.height} runs failed:"]
    lines += [f"  {count} x {reason}" for reason, count in counts[:REASONS_MAX]]
    if len(counts) > REASONS_MAX:
        lines.append(f"  ... and {len(counts) - REASONS_MAX} other reasons, see results.parquet")
    return lines


def mean_words(row: dict[str, Any] | None, count: int) -> str:
    """Mean and half the interval's width, and of how many if not of all: "17.2 +- 0.6 of 3"."""
    if row is None or not row["runs"]:
        return "-"
    half = (row["high"] - row["low"]) / 2
    width = f" +- {half:.2g}" if row["runs"] > 1 else ""
    return f"{row['mean']:.4g}{width}" + (f" of {row['runs']}" if row["runs"] < count else "")
