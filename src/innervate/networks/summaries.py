"""The summaries of all kinds of runs, as types: who writes programs knows their keys by these.

The one place where they stand together. A registry knows kinds only when a program runs; type
checkers and editors want to know them before.
"""

from __future__ import annotations

from typing import Any

from innervate.networks.mesh.analysis.summary_keys import MeshSummary
from innervate.networks.radio.analysis.summary_keys import RadioSummary, SlottedSummary
from innervate.networks.skin.analysis.summary_keys import SkinSummary

__all__ = [
    "MeshSummary",
    "RadioSummary",
    "SkinSummary",
    "SlottedSummary",
    "Summaries",
    "Summary",
]

# `kind` tells them apart; of radio's two, the slotted one has the key `level`.
Summary = SkinSummary | RadioSummary | SlottedSummary | MeshSummary


class Summaries:
    """What a run adds to its `summary`: the same with its keys known to type checkers.

    Each is the summary itself, or an AttributeError that says which it is.
    """

    summary: Any

    @property
    def skin(self) -> SkinSummary:
        """The summary of a skin's run."""
        found: SkinSummary = self._as("skin")
        return found

    @property
    def radio(self) -> RadioSummary:
        """The summary of a radio team's run."""
        found: RadioSummary = self._as("radio")
        return found

    @property
    def slotted(self) -> SlottedSummary:
        """The summary of a run of the slotted channel."""
        found: SlottedSummary = self._as("slotted")
        return found

    @property
    def mesh(self) -> MeshSummary:
        """The summary of a mesh's run."""
        found: MeshSummary = self._as("mesh")
        return found

    def _as(self, wanted: str) -> Any:
        own = self.summary.get("level", self.summary["kind"])
        if own == wanted:
            return self.summary
        raise AttributeError(f"this run has no summary {wanted!r}; run.{own} is its summary")
