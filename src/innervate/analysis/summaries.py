"""The summaries of all kinds of runs, as types."""

from __future__ import annotations

from innervate.analysis.mesh_summary import MeshSummary
from innervate.analysis.radio_summary import RadioSummary, SlottedSummary
from innervate.analysis.skin_summary import SkinSummary

__all__ = ["MeshSummary", "RadioSummary", "SkinSummary", "SlottedSummary", "Summary"]

# `kind` tells them apart; of radio's two, the slotted one has the key `level`.
Summary = SkinSummary | RadioSummary | SlottedSummary | MeshSummary
