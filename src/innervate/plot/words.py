"""Numbers of any run in plain words, for people."""

from collections.abc import Mapping
from typing import Any

from innervate.analysis.words import figure_words as figure_words
from innervate.analysis.words import share_words as share_words


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
