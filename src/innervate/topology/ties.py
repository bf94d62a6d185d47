"""Cells that are as far from one interface port as from another: those that can balance."""

from __future__ import annotations

from collections import Counter, deque

from innervate.topology.graph import Graph
from innervate.topology.patch import PORTS


def tied_at(graph: Graph) -> Counter[int]:
    """How many cells have their least distance to two or more interface ports, by that distance.

    Distances in hops to the PC, 1 at a root cell [skin II-B.4, E14].
    """
    ways = [_distances(graph, port) for port in range(graph.interfaces)]
    found: Counter[int] = Counter()
    for cell in range(graph.cells):
        hops = sorted(way[cell] for way in ways if cell in way)
        if len(hops) > 1 and hops[0] == hops[1]:
            found[hops[0]] += 1
    return found


def _distances(graph: Graph, port: int) -> dict[int, int]:
    """Hops of every cell to the PC through one interface port."""
    end = graph.peer[PORTS * graph.cells + port]
    if end < 0:
        return {}
    root = end // PORTS
    hops, queue = {root: 1}, deque([root])
    while queue:
        cell = queue.popleft()
        for peer in graph.peer[PORTS * cell : PORTS * (cell + 1)]:
            other = peer // PORTS
            if peer >= 0 and other < graph.cells and other not in hops:
                hops[other] = hops[cell] + 1
                queue.append(other)
    return hops
