"""`innervate fit`: a scenario out of a capture."""

from __future__ import annotations

from pathlib import Path

from innervate.cli.errors import say
from innervate.export import files, fitting, measure


def fit(capture: Path, out: Path | None) -> int:
    """Write the scenario, or print it; say how well its simulation matches. 1 if links differ."""
    found = measure.measure(capture)
    text = fitting.scenario_of(found, capture.stem)
    if out is None:
        print(text, end="")
    else:
        files.write_text(out, text)
        print(f"Written: {out}. Run it with `innervate run {out}`.")
    pairs = {frozenset(key) for key in found.ways}
    tell = say if out is None else print
    seen = f"{found.packets} packets in {found.seconds:.3f} s: " if found.packets else ""
    tell(f"{seen}a {found.kind} of {len(pairs)} links")
    if found.cut:
        tell(f"cut for some time, and whole in the scenario: {', '.join(sorted(found.cut))}")
    for note in found.notes:
        tell(note)
    lines, same = fitting.check(text, found)
    for line in lines:
        tell(line)
    return 0 if same else 1
