"""Maps of skins too large to draw cell by cell: squares that stand for many cells."""

from typing import Any

import numpy as np

from innervate.networks.skin.plot.history import Moment, hops_of
from innervate.networks.skin.plot.sheet import Sheet
from innervate.plot import svg
from innervate.plot.theme import shade

SQUARES = 48  # along the longer side
TIPS_MAX = 300


class Grid:
    """Squares over a sheet of cells."""

    def __init__(self, sheet: Sheet) -> None:
        inner = sheet.points - sheet.margin + sheet.pitch / 2
        across = max(sheet.width, sheet.height) - 2 * sheet.margin + sheet.pitch
        self.margin = sheet.margin
        self.size = max(across / SQUARES, sheet.pitch)
        where = (inner / self.size).astype(np.int64)
        self.columns = int(where[:, 0].max()) + 1
        self.squares = self.columns * (int(where[:, 1].max()) + 1)
        self.place = where[:, 1] * self.columns + where[:, 0]  # the square of every cell
        self.cells = self.count()  # how many cells each square has

    def count(self, weights: Any = None) -> Any:
        """Sum of one number per cell over the cells of each square."""
        return np.bincount(self.place, weights, minlength=self.squares)

    def mean(self, values: Any, there: Any) -> tuple[Any, Any]:
        """(mean over the cells that are `there`, how many these are) of each square."""
        count = self.count(there)
        total = self.count(np.where(there, values, 0.0))
        return np.divide(total, count, out=np.zeros(self.squares), where=count > 0), count

    def draw(self, drawing: svg.Drawing, kinds: list[str], tips: list[str], lacking: Any) -> None:
        """The squares that have cells; those `lacking` something are crossed and have a tip."""
        side, half = self.size - 0.6, self.size / 2
        corners = [(0.0, 0.0), (side, 0.0), (side, side), (0.0, side)]
        together: dict[str, list[str]] = {}
        marks: list[str] = []
        for i in np.flatnonzero(self.cells).tolist():
            row, column = divmod(i, self.columns)
            x, y = self.margin + column * self.size, self.margin + row * self.size
            square = svg.polygon(x, y, corners)
            if lacking[i] and len(marks) < TIPS_MAX:
                drawing.path(square, kinds[i], tips[i])
            else:
                together.setdefault(kinds[i], []).append(square)
            if lacking[i]:
                marks.append(svg.cross(x + half, y + half, min(4.0, half / 2)))
        for kind, squares in together.items():
            drawing.path("".join(squares), kind)
        drawing.path("".join(marks), "lack")


def route_map(sheet: Sheet, moment: Moment, label: str) -> svg.Drawing:
    """Mean hops to the PC as shades; crossed where some cell has no route."""
    drawing = svg.Drawing(sheet.width, sheet.height, label)
    grid = Grid(sheet)
    mean, routed = grid.mean(hops_of(moment, sheet.graph.sink), moment.server >= 0)
    most = float(mean.max())
    kinds = ["none" if n == 0 else f"d{shade(m, most)}" for m, n in zip(mean, routed, strict=True)]
    tips = [
        f"{n} cells, {m:.1f} hops on average, {n - int(r)} without a way to the PC"
        for n, m, r in zip(grid.cells.tolist(), mean, routed, strict=True)
    ]
    grid.draw(drawing, kinds, tips, routed < grid.cells)
    return drawing


def value_map(sheet: Sheet, values: Any, most: float, label: str) -> svg.Drawing:
    """Mean of one number per cell as shades; crossed where it is missing (NaN) for some."""
    drawing = svg.Drawing(sheet.width, sheet.height, label)
    grid = Grid(sheet)
    mean, came = grid.mean(values, ~np.isnan(values))
    kinds = ["none" if n == 0 else f"h{shade(m, most)}" for m, n in zip(mean, came, strict=True)]
    tips = [
        f"samples from {int(r)} of {n} cells"
        for n, r in zip(grid.cells.tolist(), came, strict=True)
    ]
    grid.draw(drawing, kinds, tips, came < grid.cells)
    return drawing
