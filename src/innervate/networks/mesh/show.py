"""A mesh run's summary for a terminal, in plain words."""

from __future__ import annotations

from typing import TYPE_CHECKING

from innervate.networks.mesh.plot import words as mesh_words
from innervate.plot import words

if TYPE_CHECKING:
    from innervate.running import Run


def summary_lines(run: Run) -> list[str]:
    """What a person wants to know first."""
    headline = words.headline_line(run.mesh["headline"])
    return [_first(run), headline, *mesh_words.sentences(run.result, run.summary)]


def _first(run: Run) -> str:
    summary = run.mesh
    took = words.simulated(run.result, summary)
    return f"{mesh_words.opening(summary)}; {took}, seed {summary['seed']}"
