"""Cells that are as far from one interface port as from another: those that can balance."""

from collections import Counter

from innervate.topology.graph import Graph
from innervate.topology.patch import PORTS
from innervate.topology.placement import distances


def tied_at(graph: Graph) -> Counter[int]:
    """How many cells have their least distance to two or more interface ports, by that distance.

    Distances in hops to the PC, 1 at a root cell [skin II-B.4, E14].
    """
    near = graph.cells_around()
    roots = [end // PORTS for end in graph.peer[PORTS * graph.cells :] if end >= 0]
    ways = [distances(near, root) for root in roots]
    found: Counter[int] = Counter()
    for cell in range(graph.cells):
        hops = sorted(1 + way[cell] for way in ways if way[cell] >= 0)
        if len(hops) > 1 and hops[0] == hops[1]:
            found[hops[0]] += 1
    return found
