"""The mesh's duplicate caches as formulas beside themselves, for drawn calls."""

from __future__ import annotations

from innervate.dialect.arith import MASK16
from innervate.dialect.source import Change
from innervate.networks.mesh.protocol import fields
from innervate.networks.mesh.prove.theories import DELIVERED, ENTRY, ORIGINS
from innervate.prove.parity import Twin, twin

PACKETS = fields.packets(ORIGINS)


def twins(change: Change | None = None) -> list[Twin]:
    """Delivery and passing on, each beside its formula."""
    window = tuple(field for field in PACKETS if field[0] in DELIVERED)
    cache = tuple(field for field in PACKETS if field[0].startswith(("done_", "skip_")))
    forget = tuple(field for field in fields.PARAMS if field[0] == "forget")
    head = tuple(field for field in fields.FRAME if field[0] not in ("path", "body"))
    told = (("origin", 0, ORIGINS - 1), ("seq", 0, MASK16), ("first", 0, 1))
    one = {"node": window, "params": forget}
    other = {"node": cache, "frame": head}
    return [
        twin(ENTRY, "accept", ("node", "params", *told), one, change),
        twin(ENTRY, "record_packet", ("node", "frame"), other, change),
    ]
