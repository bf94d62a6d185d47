"""The summaries of all kinds of runs, as types."""

from __future__ import annotations

from innervate.networks.mesh.analysis.summary_keys import MeshSummary
from innervate.networks.radio.analysis.summary_keys import RadioSummary, SlottedSummary
from innervate.networks.skin.analysis.summary_keys import SkinSummary

__all__ = ["MeshSummary", "RadioSummary", "SkinSummary", "SlottedSummary", "Summary"]

# `kind` tells them apart; of radio's two, the slotted one has the key `level`.
Summary = SkinSummary | RadioSummary | SlottedSummary | MeshSummary
