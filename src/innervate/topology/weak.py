"""Single cables and cells whose loss isolates others: bridges and articulation points.

One depth-first search from the PC [Tarjan 1972, low points]: as much work as there are cables.
"""

from typing import NamedTuple

from innervate.topology.graph import Graph
from innervate.topology.patch import NOTHING

NONE = -1


class Weak(NamedTuple):
    """A cable or a cell whose loss cuts off others from the PC."""

    isolated: int  # how many cells it cuts off, >= 1; a cell does not count itself
    end: int  # the cable's end on the PC's side; -1 for a cell
    node: int  # the cell; -1 for a cable


def weak_points(graph: Graph) -> list[Weak]:
    """All of them, those that isolate most first; then cables before cells, in order of number.

    Cells that no cable joins with the PC as it is do not count.
    """
    search = _Search(graph)
    search.run()
    found = [Weak(search.below[search.node_at(end)], end, NONE) for end in search.bridges]
    found += [Weak(count, NONE, cell) for cell, count in enumerate(search.cut_by) if count]
    return sorted(found, key=lambda weak: (-weak.isolated, weak.node, weak.end))


class _Search:
    """A depth-first search from the PC.

    Attributes:
        bridges: ends of the cables that isolate, on the PC's side.
        below: per node, how many cells the search found through it, itself included.
        cut_by: per cell, how many others it isolates.
    """

    def __init__(self, graph: Graph) -> None:
        self.graph = graph
        self.order = [0] * graph.nodes  # from 1 on, as they were found
        self.low = [0] * graph.nodes  # the first found that a way back leads to
        self.below = [1] * graph.nodes
        self.cut_by = [0] * graph.cells
        self.bridges: list[int] = []

    def node_at(self, end: int) -> int:
        """The node on the other side of an end's cable."""
        return self.graph.node_of(self.graph.peer[end])

    def run(self) -> None:
        """Search; a stack of its own, as skins are deeper than Python calls."""
        sink, found = self.graph.sink, 1
        self.order[sink] = self.low[sink] = 1
        stack = [(sink, NONE, iter(self.graph.ends_of(sink)))]
        while stack:
            node, came_by, ends = stack[-1]
            end = next((end for end in ends if self.graph.peer[end] != NOTHING), None)
            if end is None:
                stack.pop()
                if stack:
                    self._leave(node, stack[-1][0], self.graph.peer[came_by])
            elif end != came_by:  # a second cable to the same neighbour is a way back
                other = self.node_at(end)
                if self.order[other]:
                    self.low[node] = min(self.low[node], self.order[other])
                else:
                    found += 1
                    self.order[other] = self.low[other] = found
                    stack.append((other, self.graph.peer[end], iter(self.graph.ends_of(other))))

    def _leave(self, node: int, above: int, end: int) -> None:
        """All below a node is found; `end` is the one above's of the cable to it."""
        self.below[above] += self.below[node]
        self.low[above] = min(self.low[above], self.low[node])
        if self.low[node] > self.order[above]:
            self.bridges.append(end)
        if above < self.graph.cells and self.low[node] >= self.order[above]:
            self.cut_by[above] += self.below[node]
