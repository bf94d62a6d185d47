"""What single networks bring to programs, with types, in one place.

The registry knows networks only when a program runs; type checkers and editors want to know before
what `run.skin` holds. Nothing is loaded from here but by who asks for one of these names.
"""

from __future__ import annotations

from innervate.networks.mesh.analysis.summary_keys import MeshSummary
from innervate.networks.radio.analysis.summary_keys import RadioSummary, SlottedSummary
from innervate.networks.skin.analysis.summary_keys import SkinSummary
from innervate.networks.skin.sizing import Answer, Question, size

__all__ = [
    "Answer",
    "MeshSummary",
    "Question",
    "RadioSummary",
    "SkinSummary",
    "SlottedSummary",
    "Summaries",
    "Summary",
    "size",
]

# `kind` tells them apart; of radio's two, the slotted one has the key `level`.
Summary = SkinSummary | RadioSummary | SlottedSummary | MeshSummary


class Summaries:
    """A run's `summary` with its keys known; each but its own is an AttributeError."""

    skin: SkinSummary
    radio: RadioSummary
    slotted: SlottedSummary
    mesh: MeshSummary
