"""The mesh's functions that are proved as formulas beside themselves, for drawn calls."""

from __future__ import annotations

from innervate.dialect.arith import MASK16
from innervate.dialect.source import Change
from innervate.networks.mesh.protocol import fields
from innervate.networks.mesh.protocol.constants import SEARCH
from innervate.networks.mesh.prove import hops
from innervate.networks.mesh.prove.theories import DELIVERED, ENTRY, ORIGINS
from innervate.prove.records import Declaration
from tests.prove.parity import Twin, twin

PACKETS = fields.packets(ORIGINS)
PACKET = (("origin", 0, 254), ("seq", 0, MASK16), ("who", 0, 254))


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


HOPS = {
    "choose_by_search": ("node", "params", 0),
    "add_hop": ("node", 0),
    "store": ("node", 0, "frame"),
    "skip": ("node", *PACKET),
    "record_return": ("node", "frame"),
}


def hop_twin(name: str, change: Change | None = None) -> Twin:
    """One of the functions that decide on hops, beside its formula."""
    size = hops.SIZE
    fixed = {"places": (size, size), "width": (size, size), "failover": (SEARCH, SEARCH)}
    queue = _within(fields.queued(1), {"q_dest": (0, size - 1)})
    cache = tuple(field for field in PACKETS if field[0].startswith(("done_", "skip_")))
    own = tuple(field for field in fields.node(size) if field[0] == "number")
    node = {
        "choose_by_search": (*fields.node(size), *fields.neighbours(size), *fields.tables(size),
                             *fields.packets(size), *queue),
        "add_hop": (*own, *queue),
        "store": (*own, *queue),
    }  # fmt: skip
    declared = {"node": node.get(name, cache), "params": _within(fields.PARAMS, fixed),
                "frame": fields.FRAME}  # fmt: skip
    told = HOPS[name]
    given = {record: fields_ for record, fields_ in declared.items() if record in told}
    return twin(ENTRY, name, told, given, change)


def _within(declaration: Declaration, ranges: dict[str, tuple[int, int]]) -> Declaration:
    """A declaration where some fields lie in narrower ranges."""
    return tuple(
        (name, length, *ranges.get(name, (low, high)), unit, meaning)
        for name, length, low, high, unit, meaning in declaration
    )
