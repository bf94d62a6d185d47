"""`innervate live recovery`: how a skin healed, from a capture."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path

from innervate.networks.skin.export.recovery import Healing, recoveries


def show(path: Path, as_json: bool) -> int:
    """Print what happened to a skin, and how soon all was well again."""
    found = recoveries(path)
    if as_json:
        print(json.dumps([asdict(one) for one in found]))
        return 0
    for one in found:
        print(f"{one.at_s:.3f} s: {one.what}{_text(one)}")
    if not found:
        print("nothing happened to this skin while it was captured")
    return 0


def _text(one: Healing) -> str:
    if not one.cells:
        return "; no cell had to find another way"
    words = ("first moved", "last wrong parent", "all routed", "all heard", "half of them heard")
    times = (one.first_ms, one.wrong_ms, one.routed_ms, one.heard_ms, one.heard_median_ms)
    parts = [f"{word} {'never' if at is None else f'{at:.0f} ms'}"
             for word, at in zip(words, times, strict=True)]  # fmt: skip
    return f"; {one.cells} cells: {', '.join(parts)}; {one.lost} samples lost"
