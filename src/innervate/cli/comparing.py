"""`innervate compare`: what two runs have in common, and where they part."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from innervate.cli.options import Json

if TYPE_CHECKING:
    from innervate.running.compare import Comparison

DIFFERENCES_MAX = 40


def compare(first: Path, second: Path, /, *, as_json: Json = False) -> int:
    """Say what differs between two runs; 1 if anything happened otherwise.

    Args:
        first: A run folder.
        second: Another one.
        as_json: Print all that differs as JSON and nothing else.
    """
    from innervate.plot.words import headline_line
    from innervate.running import compare as room

    found = room(first, second)
    if as_json:
        print(json.dumps(_record(found, (first, second)), indent=2, ensure_ascii=False))
        return int(not found.same)
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
    return int(not found.same)


def _record(found: Comparison, runs: tuple[Path, Path]) -> dict[str, Any]:
    """A comparison for programs; values that are None are not set."""
    return {
        "same": found.same,
        "runs": [str(run) for run in runs],
        "headlines": found.headlines,
        "scenario": [{"key": key, "a": a, "b": b} for key, a, b in found.scenario],
        "summary": [{"key": key, "a": a, "b": b} for key, a, b in found.summary],
        "first_event_that_differs": None if found.divergence is None else str(found.divergence),
        "notes": found.notes,
    }


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
