"""Small skins: all connected graphs of a PC and a few cells, one of each shape; symmetries."""

from collections.abc import Iterator
from itertools import combinations, permutations

from innervate.topology import Graph, free_graph
from innervate.topology.placement import UNREACHABLE, distances, neighbours
from innervate.verify.errors import VerifyError

CELLS_MAX = 5
PORTS = 4
PC = "pc"

NAMED = {
    "line": "pc-1 1-2 2-3",
    "star": "pc-1 1-2 1-3",
    "triangle": "pc-1 1-2 1-3 2-3",
    "ring": "pc-1 1-2 1-3 2-4 3-4",
    "pair": "pc-1 pc-2 1-2",
    "complete": "pc-1 pc-2 pc-3 1-2 1-3 2-3",
}

Edge = tuple[int, int]


def parse(text: str) -> Graph:
    """A graph from its name, or from cables like "pc-1 1-2 pc-2" (cells are numbered from 1).

    Raises:
        VerifyError: the text names no graph, or one that is not connected or too large.
    """
    cables = NAMED.get(text, text).replace(",", " ").split()
    edges = set()
    for cable in cables:
        a, dash, b = cable.partition("-")
        if not dash or not all(x == PC or (x.isascii() and x.isdigit()) for x in (a, b)) or a == b:
            known = ", ".join(NAMED)
            message = f'"{cable[:40]}" is no cable; write a graph like "pc-1 1-2" or take: {known}'
            raise VerifyError(message)
        ends = sorted(0 if x == PC else int(x) for x in (a, b))
        edges.add((ends[0], ends[1]))
    cells = max((b for _, b in edges), default=0)
    if not edges or cells > CELLS_MAX or not is_connected(cells, edges):
        message = f"a graph joins the PC and the cells 1, 2, ... (at most {CELLS_MAX})"
        raise VerifyError(f'"{text[:60]}": {message}, all of them by cables')
    for cell in range(1, cells + 1):
        if sum(cell in edge for edge in edges) > PORTS:
            raise VerifyError(f'"{text[:60]}": cell {cell} has more than {PORTS} cables')
    return from_edges(edges)


def from_edges(edges: set[Edge] | frozenset[Edge]) -> Graph:
    """The graph with these cables; 0 is the PC, the others are called n1, n2, ..."""

    def name(node: int) -> str:
        return PC if node == 0 else f"n{node}"

    return free_graph([(name(a), name(b)) for a, b in sorted(edges)])


def cables(graph: Graph) -> str:
    """A graph as text: "pc-1 1-2"."""

    def name(end: int) -> str:
        node = graph.node_of(end)
        return PC if node == graph.sink else graph.label(node)[1:]

    pairs = [sorted((name(a), name(b)), key=lambda x: (x != PC, x)) for a, b in graph.links()]
    return " ".join("-".join(pair) for pair in sorted(pairs, key=lambda p: (p[0] != PC, p)))


def is_connected(cells: int, edges: set[Edge] | frozenset[Edge]) -> bool:
    """True if cables join all cells to the PC (node 0)."""
    return UNREACHABLE not in distances(neighbours(cells + 1, list(edges)), 0)


def all_graphs(cells: int) -> Iterator[Graph]:
    """All connected graphs of a PC and so many cells, one of each shape; no double cables."""
    pairs = list(combinations(range(cells + 1), 2))
    orders = [(0, *order) for order in permutations(range(1, cells + 1))]
    seen: set[tuple[Edge, ...]] = set()
    for size in range(cells, len(pairs) + 1):
        for edges in combinations(pairs, size):
            if edges in seen:
                continue
            alike = {_renamed(edges, order) for order in orders}
            seen |= alike
            if is_connected(cells, set(edges)):
                yield from_edges(set(min(alike)))


def _renamed(edges: tuple[Edge, ...], order: tuple[int, ...]) -> tuple[Edge, ...]:
    moved = (sorted((order[a], order[b])) for a, b in edges)
    return tuple(sorted((a, b) for a, b in moved))


def symmetries(graph: Graph) -> list[list[int]]:
    """All renamings of cells that change no cable: lists of ends, where each end goes.

    The identity is the first.
    """
    place = {}
    for end, peer in enumerate(graph.peer):
        if peer >= 0:
            place[graph.node_of(end), graph.node_of(peer)] = end
    found = []
    for order in permutations(range(graph.cells)):
        to = [*order, graph.sink]
        if all((to[a], to[b]) in place for a, b in place):
            ends = list(range(len(graph.peer)))
            for (a, b), end in place.items():
                ends[end] = place[to[a], to[b]]
            found.append(ends)
    return found
