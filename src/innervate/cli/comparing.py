"""`innervate compare`: what two runs or sweeps have in common, and where they part."""

from __future__ import annotations

from pathlib import Path
from typing import Any

DIFFERENCES_MAX = 40


def compare(first: Path, second: Path) -> int:
    """Say what differs between two runs."""
    from innervate.plot.words import headline_line
    from innervate.running import compare as room

    found = room(first, second)
    for name, headline in zip((first, second), found.headlines, strict=True):
        if headline is not None:
            print(f"{name}: {headline_line(headline)}")
    if not found.scenario and found.same:
        print("The two runs are the same, event by event.")
    _print("Scenario", found.scenario)
    _print("Summary", found.summary)
    if found.divergence is not None:
        print(f"First event that differs: {found.divergence}")
    elif found.scenario or found.summary:
        print("No event differs.")
    for note in found.notes:
        print(f"Note: {note}")
    return 0


def _print(head: str, differences: list[tuple[str, Any, Any]]) -> None:
    """A list of keys with both values."""
    if not differences:
        return
    print(f"{head}:")
    width = min(40, max(len(key) for key, _, _ in differences[:DIFFERENCES_MAX]))
    for key, a, b in differences[:DIFFERENCES_MAX]:
        print(f"  {key:<{width}}  {_value(a)} -> {_value(b)}")
    if len(differences) > DIFFERENCES_MAX:
        print(f"  ... and {len(differences) - DIFFERENCES_MAX} more")


def _value(value: Any) -> str:
    if value is None:
        return "not set"
    return f"{value:.6g}" if isinstance(value, float) else str(value)
