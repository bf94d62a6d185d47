"""Robot bodies: cells at given places, each wired to its nearest neighbours.

A cell has four ports and a cable has a length. The shortest cables that hold everything together
come first (so that the skin is connected where it can be), then the shortest others while both
ends have a port left.
"""

import math
from array import array
from collections.abc import Sequence
from dataclasses import replace
from functools import cache, lru_cache
from pathlib import Path

from innervate.topology.cover import Cell, cells_on_surfaces
from innervate.topology.errors import TopologyError
from innervate.topology.graph import Graph
from innervate.topology.patch import NOTHING, PORTS
from innervate.topology.placement import distances
from innervate.topology.urdf import Vector, find_urdf, read_links, read_positions

CELLS_MAX = 5000
Pair = tuple[float, int, int]


def cells_from_urdf(
    urdf: str, pattern: str, folder: Path | None = None, pitch_mm: float | None = None
) -> tuple[list[str], list[Vector]]:
    """(names, positions in mm) of the cells of a robot description: its links, or on their meshes.

    Args:
        urdf: a path, relative to `folder`, or "package:<distribution>/<robot>".
        pattern: glob or regular expression for the names of the links.
        folder: where relative paths start; the working folder if left out.
        pitch_mm: put cells on the surfaces of those links, this far apart; None = they are cells.

    Raises:
        TopologyError: nothing to read, or nothing matches (see urdf.py, cover.py).
    """
    path = find_urdf(urdf, folder or Path())
    if pitch_mm is None:
        return read_positions(path, pattern)
    cells = _covered(path, _changed_ns(path), pattern, pitch_mm)
    return [name for name, _, _ in cells], [place for _, place, _ in cells]


def normals_from_urdf(
    urdf: str, pattern: str, folder: Path | None = None, pitch_mm: float | None = None
) -> list[Vector]:
    """Where the cells of a robot description face, vectors of length 1; see cells_from_urdf().

    A cell that is a link faces along the z axis of that link's frame, as iCub's do.
    """
    path = find_urdf(urdf, folder or Path())
    if pitch_mm is None:
        return [(turn[0][2], turn[1][2], turn[2][2]) for _, _, turn, _ in read_links(path, pattern)]
    return [normal for _, _, normal in _covered(path, _changed_ns(path), pattern, pitch_mm)]


def _changed_ns(path: Path) -> int:
    """When a file was changed last; 0 = it is not there, which is said by who reads it."""
    try:
        return path.stat().st_mtime_ns
    except OSError:
        return 0


@cache
def _covered(path: Path, _changed: int, pattern: str, pitch_mm: float) -> tuple[Cell, ...]:
    """Cells on surfaces; worked out once, since a sweep asks for them in every run."""
    return tuple(cells_on_surfaces(path, pattern, pitch_mm))


def body_graph(
    names: Sequence[str],
    positions: Sequence[Vector],
    reach_mm: float,
    interfaces: int | Sequence[str],
) -> Graph:
    """Cells at `positions` (mm), wired to their nearest neighbours, with interface ports.

    Args:
        names: one a cell.
        positions: x, y, z in mm, one a cell; at most 5,000.
        reach_mm: longest cable, > 0.
        interfaces: how many interface ports to propose, or the names of the cells to put them on.

    Raises:
        TopologyError: cells out of reach of the others, or no free port for an interface.
    """
    wanted = interfaces if isinstance(interfaces, int) else tuple(interfaces)
    made = _body_graph(tuple(names), tuple(positions), reach_mm, wanted)
    return replace(made, peer=made.peer[:])  # the kept one stays as it is


@lru_cache(maxsize=64)
def _body_graph(
    names: tuple[str, ...],
    positions: tuple[Vector, ...],
    reach_mm: float,
    interfaces: int | tuple[str, ...],
) -> Graph:
    """body_graph(), worked out once, since a sweep asks for it in every run."""
    if len(names) > CELLS_MAX:
        raise TopologyError(f"{len(names)} links match; at most {CELLS_MAX} can be cells", "links")
    wanted = interfaces if isinstance(interfaces, int) else len(interfaces)
    cells = len(names)
    flat = array("d", (value for point in positions for value in point))
    peer = array("i", [NOTHING]) * (PORTS * cells)
    graph = Graph(cells, 0, peer, (), tuple(names), flat)
    pairs = _pairs(positions, reach_mm)
    group = _hold_together(graph, pairs)
    _say_if_apart(graph, group, positions, reach_mm)
    _add_others(graph, pairs, wanted, wanted if isinstance(interfaces, int) else 0)
    chosen = propose(graph, interfaces) if isinstance(interfaces, int) else []
    for name in [] if isinstance(interfaces, int) else interfaces:
        if name not in names:
            raise TopologyError(f'interfaces names "{name}", which is no cell', "interfaces")
        chosen.append(list(names).index(name))
    for cell in chosen:
        try:
            graph.add_interface(cell)
        except TopologyError as error:
            raise TopologyError(str(error), "interfaces") from None
    return graph


def _pairs(positions: Sequence[Vector], reach_mm: float) -> list[Pair]:
    """All pairs (distance, a, b), a < b, within reach, nearest first."""
    count = len(positions)
    return sorted(
        (away, a, b)
        for a in range(count)
        for b in range(a + 1, count)
        if (away := _apart(positions[a], positions[b])) <= reach_mm
    )


def _apart(one: Vector, other: Vector) -> float:
    return round(math.dist(one, other), 6)


def _hold_together(graph: Graph, pairs: Sequence[Pair]) -> list[int]:
    """Plug the shortest cables that join separate groups; the group of every cell comes back."""
    group = list(range(graph.cells))
    for _, a, b in pairs:
        if group[a] == group[b]:
            continue
        free_a, free_b = graph.free_ports(a), graph.free_ports(b)
        if free_a and free_b:
            graph.connect(graph.end(a, free_a[0]), graph.end(b, free_b[0]))
            old, new = group[b], group[a]
            group = [new if g == old else g for g in group]
    return group


def _add_others(graph: Graph, pairs: Sequence[Pair], ports: int, cells: int) -> None:
    """Plug the shortest others, as long as so many ports, on so many cells, stay free."""
    spare = PORTS * graph.cells - 2 * (graph.cells - 1) - ports
    left = sum(bool(graph.free_ports(cell)) for cell in range(graph.cells)) - cells
    for _, a, b in pairs:
        free_a, free_b = graph.free_ports(a), graph.free_ports(b)
        filled = (len(free_a) == 1) + (len(free_b) == 1)
        if spare < 2 or not free_a or not free_b or filled > left or b in graph.neighbours(a):
            continue
        graph.connect(graph.end(a, free_a[0]), graph.end(b, free_b[0]))
        spare -= 2
        left -= filled


def _say_if_apart(
    graph: Graph, group: list[int], positions: Sequence[Vector], reach_mm: float
) -> None:
    """Raise if the cells are not one group, with the reach that would make them one."""
    if len(set(group)) <= 1:
        return
    biggest = max(sorted(set(group)), key=group.count)
    out = [graph.names[c] for c in range(graph.cells) if group[c] != biggest]
    some = ", ".join(out[:4]) + (f" and {len(out) - 4} more" if len(out) > 4 else "")
    raise TopologyError(
        f"cables of {reach_mm:g} mm leave out {some}; "
        f"reach_mm = {math.ceil(joining_reach(positions) * 10) / 10:g} would join them",
        "reach_mm",
    )


def propose(graph: Graph, count: int) -> list[int]:
    """Cells for `count` interface ports: far apart, with a free port, at the border first.

    An even number of hops between them is preferred: on a bipartite graph cells tied between two
    interface ports exist only then [skin E15].

    Raises:
        TopologyError: fewer cells with a free port than that.
    """
    free = [c for c in range(graph.cells) if graph.free_ports(c)]
    if len(free) < count:
        have = "1 cell has" if len(free) == 1 else f"{len(free)} cells have"
        message = f"only {have} a free port for {count} interfaces; ask for fewer"
        raise TopologyError(message, "interfaces")
    if count == 0:
        return []
    centre = [math.fsum(graph.positions[a::3]) / graph.cells for a in range(3)]
    away = {c: math.dist(graph.positions[3 * c : 3 * c + 3], centre) for c in free}
    chosen = [max(free, key=lambda c: (len(graph.free_ports(c)) > 1, away[c], -c))]
    nearest = _hops(graph, chosen[0])
    even = [d % 2 == 0 for d in nearest]
    while len(chosen) < count:
        left = [c for c in free if c not in chosen]
        best = max(left, key=lambda c: (nearest[c] - (0 if even[c] else 1.5), away[c], -c))
        chosen.append(best)
        hops = _hops(graph, best)
        nearest = [min(x, y) for x, y in zip(nearest, hops, strict=True)]
    return chosen


def _hops(graph: Graph, start: int) -> list[int]:
    """Hops from a cell to every cell, over cables between cells; more than any where none lead."""
    hops = distances(graph.cells_around(), start)
    return [graph.cells if far < 0 else far for far in hops]


def joining_reach(positions: Sequence[Vector]) -> float:
    """The longest cable that is needed to hold all cells together, mm.

    It may be longer than their distances ask for: a cell has no more than four ports.
    """
    cells = len(positions)
    extent = max((math.dist(positions[0], place) for place in positions), default=0.0)
    reach = max(1.0, extent / math.sqrt(max(1, cells)))
    while True:  # most pairs are far apart, and are looked at only where there is no other way
        graph = Graph(cells, 0, array("i", [NOTHING]) * (PORTS * cells), ())
        if len(set(_hold_together(graph, _pairs(positions, reach)))) <= 1:
            break
        reach *= 2
    ends = [(graph.node_of(a), graph.node_of(b)) for a, b in graph.links()]
    return max((_apart(positions[a], positions[b]) for a, b in ends), default=0.0)
