"""The graph: who is cabled to whom, as one flat table of ends.

An END numbers a cable socket: `4 * cell + port` for cells (ports W, E, up, down = 0..3) and
`4 * cells + i` for interface port i of the PC, the sink. `peer[end]` is the other end or -1.
Cells are the nodes 0 .. cells-1; the PC is node `cells`.
"""

from __future__ import annotations

from array import array
from bisect import bisect_right
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

from innervate.topology.errors import TopologyError
from innervate.topology.patch import CELLS_MAX, NOTHING, PORT_NAMES, PORTS, Patch, port_number, wire

UNREACHABLE = -1


@dataclass(slots=True)
class Graph:
    """Cells, interface ports and cables."""

    cells: int  # how many cells there are, 0..4,000,000
    interfaces: int  # how many interface ports the PC has
    peer: array[int]  # length 4 * cells + interfaces; the end on the other side, or -1
    # The patches, in order of their cells; empty for free graphs and bodies.
    patches: tuple[Patch, ...] = ()
    names: tuple[str, ...] = ()  # one name a cell for free graphs and bodies; empty for patches
    # x, y, z in mm per cell, flat, for bodies; empty otherwise.
    positions: array[float] = field(default_factory=lambda: array("d"))

    @property
    def sink(self) -> int:
        """The PC's number: that behind the last cell's."""
        return self.cells

    @property
    def nodes(self) -> int:
        """How many nodes there are: all cells and the PC."""
        return self.cells + 1

    def node_of(self, end: int) -> int:
        """The node an end belongs to."""
        return min(end // PORTS, self.cells)

    def port_of(self, end: int) -> int:
        """The end's port on its node: 0..3 on a cell, 0.. on the PC."""
        return end % PORTS if end < PORTS * self.cells else end - PORTS * self.cells

    def end(self, node: int, port: int) -> int:
        """The end of a node's port (the PC's ports follow those of all cells)."""
        return PORTS * node + port

    def ends_of(self, node: int) -> range:
        """All ends of a node."""
        count = PORTS if node < self.cells else self.interfaces
        return range(PORTS * node, PORTS * node + count)

    def free_ports(self, cell: int) -> list[int]:
        """Ports of a cell that carry no cable."""
        return [p for p in range(PORTS) if self.peer[PORTS * cell + p] == NOTHING]

    def neighbours(self, node: int) -> list[int]:
        """Nodes cabled to a node, in port order; one appears once per cable."""
        return [self.node_of(e) for e in (self.peer[x] for x in self.ends_of(node)) if e >= 0]

    def cells_around(self) -> list[list[int]]:
        """Per cell the cells that it is cabled to, in port order."""
        return [[other for other in self.neighbours(cell) if other < self.cells]
                for cell in range(self.cells)]  # fmt: skip

    def connect(self, end_a: int, end_b: int) -> None:
        """Plug a cable into two free ends.

        Raises:
            TopologyError: a port is cabled already, or both ends belong to one node.
        """
        if self.node_of(end_a) == self.node_of(end_b):
            raise TopologyError(
                f"a cable from {self.label_end(end_a)} to {self.label_end(end_b)} would join "
                f"{self.label(self.node_of(end_a))} to itself; name two different cells"
            )
        for here, there in ((end_a, end_b), (end_b, end_a)):
            if self.peer[here] != NOTHING:
                raise TopologyError(
                    f"port {self.label_end(here)} is already cabled to "
                    f"{self.label_end(self.peer[here])}, so {self.label_end(there)} cannot be "
                    f"joined to it; {self._free_in_words(self.node_of(here))}"
                )
        self.peer[end_a] = end_b
        self.peer[end_b] = end_a

    def add_interface(self, cell: int, port: int | str | None = None) -> int:
        """Give the PC one more interface port, cabled to a cell; its number comes back.

        Args:
            cell: the cell, 0 .. cells-1.
            port: the cell's port; None takes its first free one.

        Raises:
            TopologyError: the port is cabled, or the cell has no free one.
        """
        end = self.free_end(cell, port)
        self.peer.append(NOTHING)
        self.interfaces += 1
        try:
            self.connect(end, PORTS * self.cells + self.interfaces - 1)
        except TopologyError:
            self.peer.pop()
            self.interfaces -= 1
            raise
        return self.interfaces - 1

    def free_end(self, cell: int, port: int | str | None = None) -> int:
        """The end of a cell's port; without a port that of its first free one.

        Raises:
            TopologyError: no port of that name, or none is free.
        """
        if port is not None:
            return PORTS * cell + port_number(port)
        free = self.free_ports(cell)
        if not free:
            raise TopologyError(f"{self.label(cell)} has no free port; choose a border cell")
        return PORTS * cell + free[0]

    def links(self) -> Iterator[tuple[int, int]]:
        """All cables as pairs of ends (a, b), a < b, in order of a."""
        for end, other in enumerate(self.peer):
            if end < other:
                yield end, other

    def label(self, node: int) -> str:
        """A node in words: "p0 r3 c4", a cell's own name, or "pc"."""
        if node == self.cells:
            return "pc"
        if self.names:
            return self.names[node]
        index = self.patch_of(node)
        if index < 0:
            return f"cell {node}"
        row, column = self.patches[index].row_column(node)
        return f"p{index} r{row} c{column}"

    def label_end(self, end: int) -> str:
        """An end in words: "p0 r3 c4 E", "n1 W" or "pc.1"."""
        node, port = self.node_of(end), self.port_of(end)
        return f"pc.{port}" if node == self.cells else f"{self.label(node)} {PORT_NAMES[port]}"

    def patch_of(self, cell: int) -> int:
        """Index of the patch a cell belongs to, -1 if none."""
        return bisect_right(self.patches, cell, key=lambda patch: patch.first_cell) - 1

    def depths(self) -> array[int]:
        """Hops of every cell to the PC by breadth-first search; -1 where no cable leads there.

        A cell on an interface port has 1. The table has one entry a cell, none for the PC.
        """
        depth = array("i", [UNREACHABLE]) * (self.cells + self.interfaces // PORTS + 2)
        for i in range(self.cells, len(depth)):
            depth[i] = 0  # the PC's ends, and -1 >> 2 = -1 (no cable), look visited
        peer, hops = self.peer, 1
        front = []
        for end in self.ends_of(self.cells):
            cell = peer[end] >> 2
            if depth[cell] < 0:
                depth[cell] = 1
                front.append(cell)
        while front:
            hops += 1
            fresh: list[int] = []
            reached = fresh.append
            for cell in front:
                first = cell << 2
                for end in peer[first : first + PORTS]:
                    if depth[end >> 2] < 0:
                        depth[end >> 2] = hops
                        reached(end >> 2)
            front = fresh
        del depth[self.cells :]
        return depth

    def _free_in_words(self, node: int) -> str:
        if node == self.cells:
            return "use another interface port"
        free = [PORT_NAMES[p] for p in self.free_ports(node)]
        if not free:
            return f"{self.label(node)} has no free port"
        return f"free on {self.label(node)}: {', '.join(free)}"


def from_patches(shapes: Iterable[tuple[int, int, str]]) -> Graph:
    """A graph of patches not yet joined and without interface ports.

    Args:
        shapes: (columns, rows, wiring) of each patch; columns, rows >= 1, wiring "Z" or "S".

    Raises:
        TopologyError: more than 4,000,000 cells.
    """
    patches: list[Patch] = []
    peer = array("i")
    first = 0
    last: tuple[int, int, str] | None = None
    block: list[int] = []
    for shape in shapes:
        columns, rows, wiring = shape
        if columns < 1 or rows < 1 or wiring not in ("Z", "S"):
            raise TopologyError("a patch needs columns >= 1, rows >= 1 and wiring Z or S")
        if first + columns * rows > CELLS_MAX:
            raise TopologyError(f"more than {CELLS_MAX:,} cells; make the patches smaller", "count")
        patch = Patch(columns, rows, wiring, first)
        if shape != last:
            block, last = wire(patch).tolist(), shape
        offset = PORTS * first
        peer.extend([end + offset if end >= 0 else NOTHING for end in block])
        patches.append(patch)
        first += patch.cells
    return Graph(first, 0, peer, tuple(patches))


def join_chain(graph: Graph, first: int, count: int) -> None:
    """Cable `count` patches from index `first` on in a row: middle of E to middle of W.

    Raises:
        TopologyError: one of those ports is cabled already.
    """
    for index in range(first, first + count - 1):
        left, right = graph.patches[index], graph.patches[index + 1]
        a = left.cell(left.rows // 2, left.columns - 1)
        b = right.cell(right.rows // 2, 0)
        graph.connect(PORTS * a + 1, PORTS * b)
