"""Numbers of any run in plain words, for people."""

from collections import Counter
from collections.abc import Iterable, Mapping
from typing import Any

from innervate.analysis.words import figure_words as figure_words
from innervate.analysis.words import share_words as share_words

# What a measure's ending means, for axes.
UNITS = {"_ms": "ms", "_s": "s", "_us": "us", "_hz": "Hz", "_m": "m", "_slots": "slots"}


def headline_line(found: Mapping[str, object]) -> str:
    """A summary's headline in a line: "degraded: 1 of 91 messages was not delivered."."""
    return f"{found['level']}: {found['text']}"


def ms_words(value_ms: float) -> str:
    """A time: "8.43 ms", "17.0 ms", "1.25 s"."""
    if value_ms >= 1000:
        return f"{figure_words(value_ms / 1000)} s"
    return f"{value_ms:.1f} ms" if value_ms >= 10 else f"{value_ms:.3g} ms"


def wall_words(wall_s: float) -> str:
    """How long something took to compute: "0.13 s", "less than 0.01 s"."""
    return f"{wall_s:.2f} s" if wall_s >= 0.01 else "less than 0.01 s"


def simulated(result: Any, summary: Mapping[str, Any]) -> str:
    """How much of a run was simulated, and how long that took: "2 s simulated in 0.13 s"."""
    seconds = figure_words(result.ended_us / 1e6, 4)
    return f"{seconds} s simulated in {wall_words(summary['wall_s'])}"


def interrupted(summary: Mapping[str, Any]) -> list[str]:
    """A sentence on a run that was interrupted; none on another."""
    if "interrupted_at_s" not in summary:
        return []
    return [f"Interrupted at {summary['interrupted_at_s']:.3f} s of simulated time."]


def stood_words(value_ms: float) -> str:
    """How long something stood that was there: "17.0 ms", "less than 0.001 ms"."""
    return ms_words(value_ms) if value_ms > 0 else "less than 0.001 ms"


def count_words(value: float) -> str:
    """A count or a tick: "12", "12,000", "1.2 M", "0.5"."""
    if abs(value) >= 1e6:
        return f"{value / 1e6:.4g} M"
    return f"{round(value):,}" if abs(value) >= 10 else f"{value:g}"


def label(name: str) -> str:
    """A column in words, its unit at the end: "latency_ms.p50" is "latency p50 (ms)"."""
    parts, of = name.split("."), ""
    for i, part in enumerate(parts):
        for ending, unit in UNITS.items():
            if part.endswith(ending):
                parts[i], of = part.removesuffix(ending), f" ({unit})"
                break
    return " ".join(parts).replace("_", " ") + of


def averages(over: Mapping[str, int], points: Iterable[int]) -> str:
    """Over what means are taken: how many values of each key, and how often each was run.

    `points` has the point of every run.
    """
    several = ", ".join(f"{count} values of {key}" for key, count in over.items())
    alike = len(set(Counter(points).values())) < 2
    how = "all varied alike" if alike else "by how often each of them was run"
    return f"means over {several}, {how}"
