"""What single networks bring to programs, with types, in one place.

The registry knows networks only when a program runs; type checkers and editors want to know before
what `run.skin` holds. Nothing is loaded from here but by who asks for one of these names.
"""

from innervate.networks.mesh.analysis.summary_keys import MeshSummary as MeshSummary
from innervate.networks.radio.analysis.summary_keys import RadioSummary as RadioSummary
from innervate.networks.radio.analysis.summary_keys import SlottedSummary as SlottedSummary
from innervate.networks.skin.analysis.summary_keys import SkinSummary as SkinSummary
from innervate.networks.skin.sizing import Answer as Answer
from innervate.networks.skin.sizing import Question as Question
from innervate.networks.skin.sizing import size as size

# `kind` tells them apart; of radio's two, the slotted one has the key `level`.
Summary = SkinSummary | RadioSummary | SlottedSummary | MeshSummary


class Summaries:
    """A run's `summary` with its keys known; each but its own is an AttributeError."""

    skin: SkinSummary
    radio: RadioSummary
    slotted: SlottedSummary
    mesh: MeshSummary
