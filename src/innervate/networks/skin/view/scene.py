"""Where the cells and interface ports of a skin are drawn, in cell pitches."""

import math
from typing import Any

import numpy as np

from innervate.topology import PORTS
from innervate.topology.layout import cell_places
from innervate.topology.patch import DOWN, UP, E, W

Floats = np.ndarray[Any, np.dtype[np.float64]]

_HIGH = math.sqrt(3) / 2
# Towards the six cells round a cell of a honeycomb.
_AROUND = ((-1.0, 0.0), (1.0, 0.0), (-0.5, -_HIGH), (0.5, -_HIGH), (-0.5, _HIGH), (0.5, _HIGH))
_TOWARDS = {W: (0,), E: (1,), UP: (3, 2), DOWN: (5, 4)}
NEAR = 0.7  # what is nearer than that overlaps


def places(graph: Any) -> Floats:
    """x, y of every cell, then of every interface port, one pitch apart."""
    cells = np.array(cell_places(graph), np.float64).reshape(-1, 2)
    cells /= _pitch(graph, cells)
    found = [(float(x), float(y)) for x, y in cells]
    centre = cells.mean(axis=0)
    for port in range(graph.interfaces):
        end = graph.peer[PORTS * graph.cells + port]
        cell = end // PORTS
        found.append(_beside(cells[cell], end % PORTS, centre, np.array(found)))
    return np.array(found)


def _pitch(graph: Any, cells: Floats) -> float:
    """The usual distance of two cells that are cabled."""
    pairs = np.array(
        [(a // PORTS, b // PORTS) for a, b in graph.links() if b < PORTS * graph.cells], np.int64
    ).reshape(-1, 2)
    apart = np.hypot(*(cells[pairs[:, 0]] - cells[pairs[:, 1]]).T)
    apart = apart[apart > 0]
    return float(np.median(apart)) if len(apart) else 14.0


def _beside(cell: Floats, port: int, centre: Floats, others: Floats) -> tuple[float, float]:
    """A free place beside a cell, towards its port, or else away from the middle."""
    away = cell - centre
    order = sorted(range(6), key=lambda i: -float(np.dot(_AROUND[i], away)))
    best, most = (float(cell[0]), float(cell[1])), -1.0
    for direction in (*_TOWARDS[port], *order):
        dx, dy = _AROUND[direction]
        place = (float(cell[0]) + dx, float(cell[1]) + dy)
        room = float(np.min(np.hypot(others[:, 0] - place[0], others[:, 1] - place[1])))
        if room >= NEAR:
            return place
        if room > most:
            best, most = place, room
    return best
