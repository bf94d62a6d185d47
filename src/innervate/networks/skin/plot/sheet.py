"""Where the cells and interface ports of a skin lie on a drawing."""

import math
from typing import Any

import numpy as np

from innervate.networks.skin.protocol.constants import PORTS
from innervate.plot.svg import Point
from innervate.topology import Graph
from innervate.topology.layout import cell_places

MARGIN = 40.0  # room for the ports' plugs; with less they are left out
PITCH_MAX = 28.0
PLUGS_MAX = 32  # more interface ports are not drawn one by one
TALL, WIDE = (320.0, 430.0), (480.0, 400.0)
NEAR = 1.6  # cables up to this many pitches long are between neighbours
_TOWARDS = ((-1.0, 0.0), (1.0, 0.0), (0.0, -1.0), (0.0, 1.0))
_SLANTS = tuple((math.cos(a * math.pi / 4), math.sin(a * math.pi / 4)) for a in (1, 3, 5, 7))

Floats = np.ndarray[Any, np.dtype[np.float64]]


class Sheet:
    """Places of a graph's cells and ports inside a box, in px."""

    def __init__(self, graph: Graph, box: Point = TALL, margin: float = MARGIN) -> None:
        self.graph = graph
        self.margin = margin  # px round the cells
        places = np.array(cell_places(graph), np.float64).reshape(-1, 2)
        low = places.min(axis=0)
        extent = places.max(axis=0) - low
        pitch_mm = _pitch(places)
        self.wide = bool(extent[0] > 1.4 * extent[1])  # its box then is WIDE where it would be TALL
        if self.wide and box == TALL:
            box = WIDE
        self.scale = min(  # px per mm
            (box[0] - 2 * margin) / max(extent[0], pitch_mm),
            (box[1] - 2 * margin) / max(extent[1], pitch_mm),
            PITCH_MAX / pitch_mm,
        )
        self.pitch = float(self.scale * pitch_mm)  # px between neighbours
        self.width = float(extent[0] * self.scale + 2 * margin)
        self.height = float(extent[1] * self.scale + 2 * margin)
        self._low = low
        self.points: Floats = (places - low) * self.scale + margin  # (cells, 2), centres
        radius = 0.96 * self.pitch / math.sqrt(3)
        self.corners = [  # of a cell's hexagon, relative to its centre
            (radius * math.sin(i * math.pi / 3), -radius * math.cos(i * math.pi / 3))
            for i in range(6)
        ]
        self.ports = self._place_ports() if margin >= MARGIN else []  # where plugs are

    def of_mm(self, x_mm: float, y_mm: float) -> Point:
        """A place of the layout on the drawing."""
        x, y = (np.array([x_mm, y_mm]) - self._low) * self.scale + self.margin
        return float(x), float(y)

    def cell(self, cell: int) -> Point:
        """Where a cell's centre is, in the sheet's units."""
        x, y = self.points[cell]
        return float(x), float(y)

    def end(self, end: int) -> Point:
        """Where the node of an end lies; for the PC the plug of the port."""
        cells = self.graph.cells
        return self.cell(end // PORTS) if end < PORTS * cells else self.ports[end - PORTS * cells]

    def root_of(self, port: int) -> int:
        """The cell that an interface port is cabled to, or -1."""
        end = self.graph.peer[PORTS * self.graph.cells + port]
        return end // PORTS if end >= 0 else -1

    def _place_ports(self) -> list[Point]:
        """Plugs stand beside their cells where most room is, preferably where the port looks."""
        graph = self.graph
        if graph.interfaces > PLUGS_MAX:
            roots = [self.root_of(port) for port in range(graph.interfaces)]
            return [self.cell(root) if root >= 0 else (0.0, 0.0) for root in roots]
        taken: list[Point] = []
        for port in range(self.graph.interfaces):
            end = self.graph.peer[PORTS * self.graph.cells + port]
            if end < 0:
                taken.append((MARGIN / 2, MARGIN / 2))
                continue
            cell, side = divmod(end, PORTS)
            centre = self.points[cell]
            away = max(1.2 * self.pitch, 20.0)
            others = np.delete(self.points, cell, axis=0)
            if taken:
                others = np.concatenate([others, np.array(taken)])
            best, room = (0.0, 0.0), -1.0
            for i, (dx, dy) in enumerate(_TOWARDS + _SLANTS):
                place = centre + away * np.array([dx, dy])
                free = float(np.abs(others - place).max(axis=1).min()) if len(others) else 1.0
                free += 0.25 * self.pitch if i == side and self.graph.patches else 0.0
                inside = 12 <= place[0] <= self.width - 12 and 9 <= place[1] <= self.height - 9
                if inside and free > room:
                    best, room = (float(place[0]), float(place[1])), free
            taken.append(best if room >= 0 else (float(centre[0]), float(centre[1])))
        return taken


def _pitch(places: Floats) -> float:
    """Distance between neighbours: the median over a sample of cells; 1 for a single one."""
    if len(places) < 2:
        return 14.0
    sample = places[:: max(1, len(places) // 200)]
    found = []
    for place in sample:
        apart = np.hypot(*(places - place).T)
        apart = apart[apart > 1e-9]
        if len(apart):
            found.append(float(apart.min()))
    return float(np.median(found)) if found else 14.0
