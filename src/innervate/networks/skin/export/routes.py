"""Cables of a skin that was captured, and the ways that its cells' parents make."""

from typing import NamedTuple

from innervate.export.links import Place
from innervate.networks.skin import frames as skin
from innervate.wire.layout import width

PC = "pc"


def _bit_of(fields: tuple[tuple[str, int, int, int], ...], name: str) -> int:
    """Where a field begins in a frame, in bits."""
    return skin.KIND_BITS + width(fields[: [field[0] for field in fields].index(name)])


PARENT_AT = _bit_of(skin.ROUTE, "parent")
CELL_AT = _bit_of(skin.TOUCH, "cell")
SEQ_AT = _bit_of(skin.TOUCH, "seq")
CELL_BITS, SEQ_BITS = 16, 8


class End(NamedTuple):
    """An end of a cable: a cell, or the PC, and its port."""

    node: str
    port: int


def end_of(place: Place) -> End | None:
    """The end that an interface of a capture is at; None if its description does not say it all."""
    if place.what not in ("pc", "cell") or place.port < 0 or not place.here:
        return None
    return End(PC if place.what == "pc" else f"c{place.number}", place.port)


class Network:
    """Cables and nodes as they are at a moment of a capture, and the parents that cells name.

    Attributes:
        peer: the other end of a cable.
        parent: port of every cell's parent, as its beacons said; None = it has none.
        away: nodes that do not run.
        cut: ends of cables that carry nothing.
    """

    def __init__(self) -> None:
        self.peer: dict[End, End] = {}
        self.parent: dict[str, int | None] = {}
        self.away: set[str] = set()
        self.cut: set[End] = set()
        self._of_address: dict[str, End] = {}
        self._far: dict[End, str] = {}

    def cable(self, end: End, here: str, there: str) -> None:
        """An end, with its own address and that of the other end."""
        self._of_address[here] = end
        self._far[end] = there
        other = self._of_address.get(there)
        if other is not None and self._far.get(other) == here:
            self.peer[end], self.peer[other] = other, end
        if end.node != PC:
            self.parent.setdefault(end.node, None)

    def carries(self, end: End) -> bool:
        """True if what leaves here arrives."""
        other = self.peer.get(end)
        if other is None or self.cut & {end, other}:
            return False
        return not self.away & {end.node, other.node}

    def way(self, cell: str) -> list[End] | None:
        """The ends by which a cell's samples leave, up to the PC; None = they do not get there."""
        ends: list[End] = []
        seen = set()
        while cell != PC:
            port = self.parent.get(cell)
            if cell in seen or port is None or not self.carries(End(cell, port)):
                return None
            seen.add(cell)
            ends.append(End(cell, port))
            cell = self.peer[ends[-1]].node
        return ends

    def joined(self) -> set[str]:
        """Cells that have cables to the PC, over cells that run."""
        found = {PC} - self.away
        waiting = list(found)
        near: dict[str, list[End]] = {}
        for end in self.peer:
            near.setdefault(end.node, []).append(end)
        while waiting:
            for end in near.get(waiting.pop(), ()):
                other = self.peer[end].node
                if other not in found and self.carries(end):
                    found.add(other)
                    waiting.append(other)
        return found - {PC}
