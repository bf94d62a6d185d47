"""A skin on matplotlib axes: cells, who sends through whom, interface ports."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection

from innervate.networks.skin.plot.sheet import Sheet
from innervate.networks.skin.protocol.constants import PORTS
from innervate.plot import style
from innervate.topology import Graph

NO_ROUTE = "#ffffff"
ARROWS_MAX = 600  # more get lines without heads


class SkinAxes:
    """Draws on `ax` in the coordinates of a sheet, y downwards."""

    def __init__(self, ax: Axes, graph: Graph) -> None:
        self.ax = ax
        self.graph = graph
        self.sheet = Sheet(graph)
        ax.set_aspect("equal")
        ax.axis("off")
        places = np.concatenate([self.sheet.points, np.array(self.sheet.ports).reshape(-1, 2)])
        low, high = places.min(axis=0), places.max(axis=0)
        room = 0.75 * self.sheet.pitch
        ax.set_xlim(low[0] - room, high[0] + room)
        ax.set_ylim(high[1] + room, low[1] - room)

    def cells(self, fills: Sequence[Any]) -> None:
        """Hexagons, one fill a cell; those without a route (NO_ROUTE) get a dashed edge."""
        corners = np.array(self.sheet.corners)
        shapes = self.sheet.points[:, None, :] + corners[None, :, :]
        hollow = [fill == NO_ROUTE if isinstance(fill, str) else False for fill in fills]
        self.ax.add_collection(
            PolyCollection(
                list(shapes),
                facecolors=list(fills),
                edgecolors=[style.SOFT if empty else "white" for empty in hollow],
                linewidths=[0.5 if empty else 0.4 for empty in hollow],
                linestyles=[(0, (2, 1.4)) if empty else "-" for empty in hollow],
                zorder=1,
            )
        )

    def tree(
        self, hops: Any, colour: str = style.INK, only: Any = None, strong: bool = False
    ) -> None:
        """A line with a head from every cell (or those in `only`) to its next hop."""
        places = self.sheet.points
        lines = []
        for cell in range(len(hops)) if only is None else only:
            hop = int(hops[cell])
            if hop >= 0:
                target = self._port_of(cell) if hop == self.graph.sink else places[hop]
                lines.append((places[cell], np.asarray(target)))
        if len(lines) > ARROWS_MAX:
            self.ax.add_collection(LineCollection(lines, colors=[colour], linewidths=[0.3]))
            return
        for here, there in lines:
            self._arrow(here, there, colour, strong)

    def _port_of(self, cell: int) -> Any:
        """Plug of the interface port that a cell is cabled to."""
        first = PORTS * self.graph.cells
        for port in range(self.graph.interfaces):
            if self.graph.peer[first + port] // PORTS == cell:
                return self.sheet.ports[port]
        return self.sheet.points[cell]

    def _arrow(self, here: Any, there: Any, colour: str, strong: bool) -> None:
        way = there - here
        start, end = here + 0.14 * way, here + (0.86 if strong else 0.8) * way
        self.ax.annotate(
            "",
            end,
            start,
            arrowprops={
                "arrowstyle": "-|>" if strong else "->",
                "color": colour,
                "lw": 1.7 if strong else 0.55,
                "shrinkA": 0,
                "shrinkB": 0,
                "mutation_scale": 8 if strong else 3.2,
            },
            zorder=4 if strong else 2,
        )

    def ports(self, cut: Sequence[int] = (), names: Sequence[str] = ()) -> None:
        """Plugs of the PC's interface ports and their cables; cut ones crossed."""
        for port, place in enumerate(self.sheet.ports):
            root = self.sheet.root_of(port)
            is_cut = port in cut
            if root >= 0:
                centre = self.sheet.points[root]
                line = LineCollection(
                    [[centre, place]],
                    colors=[style.VERMILION if is_cut else style.INK],
                    linestyles=[":" if is_cut else "-"],
                    linewidths=[1.2],
                    zorder=3,
                )
                self.ax.add_collection(line)
                if is_cut:
                    middle = 0.5 * (centre + np.asarray(place))
                    self.ax.plot(*middle, "x", color=style.VERMILION, ms=5, mew=1.4, zorder=6)
            self.ax.plot(*place, "s", color=style.INK, ms=7.5, zorder=5)
            words = names[port] if names else str(port)
            self.ax.text(
                *place, words, color="white", fontsize=5.5, ha="center", va="center_baseline",
                zorder=6,
            )  # fmt: skip
