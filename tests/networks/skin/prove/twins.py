"""The skin's handlers as formulas beside themselves, for drawn calls."""

from __future__ import annotations

from innervate.dialect.arith import MASK30
from innervate.dialect.source import Change
from innervate.networks.skin.protocol import fields
from innervate.networks.skin.prove.neighbours import ENTRY
from tests.prove.parity import Twin, twin

DECLARED = {"cell": fields.CELL, "params": fields.PARAMS, "frame": fields.FRAME}
GIVEN = ("cell", "params", ("now", 0, MASK30))
HANDLERS = {
    "on_start": (("cause", 0, 1),),
    "on_frame": (("port", 0, 3), "frame"),
    "on_timer": (("timer", 0, 1),),
    "on_input": (("kind", 0, 2), "frame"),
}


def twins(change: Change | None = None) -> list[Twin]:
    """A cell's handlers, each beside its formula."""
    return [
        twin(ENTRY, handler, (*GIVEN, *told, "out"), DECLARED, change)
        for handler, told in HANDLERS.items()
    ]
