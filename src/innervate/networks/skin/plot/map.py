"""Maps of a skin: cells as hexagons, links to parents, interface ports, cut cables, touch."""

from typing import Any

import numpy as np

from innervate.kernel.words import number_of
from innervate.networks.skin.plot import binned
from innervate.networks.skin.plot.history import Moment, hops_of
from innervate.networks.skin.plot.sheet import NEAR, PLUGS_MAX, Sheet
from innervate.networks.skin.protocol.constants import PORTS
from innervate.plot import svg
from innervate.plot.theme import PORT_COLOURS, shade

TIPS_MAX = 700
HEXAGONS_MAX = 1500
CELLS_MAX = 3000


def route_map(sheet: Sheet, moment: Moment, label: str, tips: bool = True) -> svg.Drawing:
    """Who sends through whom at one moment; cells without a route are hollow and crossed.

    `tips` says under the pointer what a cell is, as long as there are not too many.
    """
    if sheet.graph.cells > CELLS_MAX:
        return binned.route_map(sheet, moment, label)
    graph = sheet.graph
    drawing = svg.Drawing(sheet.width, sheet.height, label)
    hops = hops_of(moment, graph.sink)
    _cables(drawing, sheet)
    by_depth = shows_depth(graph.interfaces)
    most = int(hops.max()) if len(hops) else 0
    kinds = []
    for cell in range(graph.cells):
        server = int(moment.server[cell])
        if cell in moment.dead:
            kinds.append("off")
        elif server < 0:
            kinds.append("none")
        elif by_depth:
            kinds.append(f"cell d{shade(hops[cell] - 1, most)}")
        else:
            kinds.append(f"cell p{server % PORT_COLOURS}")
    _cells(drawing, sheet, kinds, _tips(sheet, moment, hops) if tips else [])
    _tree(drawing, sheet, moment)
    _crosses(drawing, sheet, [c for c in range(graph.cells) if kinds[c] in ("none", "off")])
    _plugs(drawing, sheet, moment)
    _cuts(drawing, sheet, moment)
    return drawing


def shows_depth(interfaces: int) -> bool:
    """True where colour stands for hops, because ports are one or too many to tell apart."""
    return interfaces < 2 or interfaces > PORT_COLOURS


def value_map(sheet: Sheet, values: Any, most: float, label: str, unit: str = "") -> svg.Drawing:
    """One number per cell as shades; NaN = nothing came: hollow and crossed."""
    if sheet.graph.cells > CELLS_MAX:
        return binned.value_map(sheet, values, most, label)
    drawing = svg.Drawing(sheet.width, sheet.height, label)
    missing = np.isnan(values)
    label_of = sheet.graph.label
    kinds, tips = [], []
    for cell, value in enumerate(values):
        kinds.append("none" if missing[cell] else f"cell h{shade(float(value), most)}")
        told = "nothing received" if missing[cell] else f"{value:g}{unit}"
        tips.append(f"{label_of(cell)}: {told}")
    _cells(drawing, sheet, kinds, tips)
    _crosses(drawing, sheet, np.flatnonzero(missing).tolist())
    return drawing


def touch_ring(drawing: svg.Drawing, sheet: Sheet, x_mm: float, y_mm: float, r_mm: float) -> None:
    """Where the touch really is."""
    drawing.circle(sheet.of_mm(x_mm, y_mm), r_mm * sheet.scale, "touch")


def _tips(sheet: Sheet, moment: Moment, hops: Any) -> list[str]:
    cells = sheet.graph.cells
    return [_tip(sheet, moment, hops, c) for c in range(cells)] if cells <= TIPS_MAX else []


def _tip(sheet: Sheet, moment: Moment, hops: Any, cell: int) -> str:
    name, server = sheet.graph.label(cell), int(moment.server[cell])
    if cell in moment.dead:
        return f"{name}: switched off"
    if server < 0:
        return f"{name}: no way to the PC"
    return f"{name}: {number_of(int(hops[cell]), 'hop')}, through port {server}"


def _cells(drawing: svg.Drawing, sheet: Sheet, kinds: list[str], tips: list[str]) -> None:
    """Hexagons; large skins get one path per kind."""
    if tips and len(kinds) <= TIPS_MAX:
        for cell, (kind, tip) in enumerate(zip(kinds, tips, strict=True)):
            drawing.path(svg.polygon(*sheet.cell(cell), sheet.corners), kind, tip)
        return
    wide, high = 0.48 * sheet.pitch, 0.41 * sheet.pitch
    bricks = [(-wide, -high), (wide, -high), (wide, high), (-wide, high)]
    corners = sheet.corners if len(kinds) <= HEXAGONS_MAX else bricks
    together: dict[str, list[str]] = {}
    for cell, kind in enumerate(kinds):
        together.setdefault(kind, []).append(svg.polygon(*sheet.cell(cell), corners))
    for kind, shapes in together.items():
        drawing.path("".join(shapes), kind)


def _crosses(drawing: svg.Drawing, sheet: Sheet, cells: list[int]) -> None:
    size = 0.17 * sheet.pitch
    drawing.path("".join(svg.cross(*sheet.cell(c), size) for c in cells), "lack")


def _cables(drawing: svg.Drawing, sheet: Sheet) -> None:
    """Cables that are longer than from neighbour to neighbour, or not on a honeycomb."""
    graph, lines = sheet.graph, []
    for a, b in graph.links():
        if b >= PORTS * graph.cells:
            continue
        start, end = sheet.end(a), sheet.end(b)
        apart = float(np.hypot(end[0] - start[0], end[1] - start[1]))
        if apart > NEAR * sheet.pitch or not graph.patches:
            lines.append(svg.polyline([start, end]))
    drawing.path("".join(lines), "cable")


def _tree(drawing: svg.Drawing, sheet: Sheet, moment: Moment) -> None:
    cells = sheet.graph.cells
    lines = [
        svg.polyline([sheet.cell(c), sheet.cell(int(moment.hop[c]))])
        for c in np.flatnonzero((moment.hop >= 0) & (moment.hop < cells)).tolist()
    ]
    width = max(0.5, min(2.4, 0.1 * sheet.pitch))
    if lines:
        drawing.add("path", class_="tree", d="".join(lines), stroke_width=width)


def _plugs(drawing: svg.Drawing, sheet: Sheet, moment: Moment) -> None:
    graph = sheet.graph
    if graph.interfaces > PLUGS_MAX:
        return
    for port, (x, y) in enumerate(sheet.ports):
        root = sheet.root_of(port)
        if root >= 0 and graph.peer[PORTS * graph.cells + port] not in moment.down:
            drawing.line(sheet.cell(root), (x, y), "plug")
        drawing.add("rect", class_="port", x=x - 9, y=y - 8, width=18, height=16, rx=4)
        drawing.text((x, y + 4), str(port), "portname", "middle")


def _cuts(drawing: svg.Drawing, sheet: Sheet, moment: Moment) -> None:
    """Cables that are down: dashed, a cross in the middle."""
    graph = sheet.graph
    for end in sorted(moment.down):
        far = graph.peer[end]
        if {graph.node_of(end), graph.node_of(far)} & moment.dead:
            continue
        (x0, y0), (x1, y1) = sheet.end(end), sheet.end(far)
        if far >= PORTS * graph.cells:  # stop at the plug's rim
            x1, y1 = x1 + 0.3 * (x0 - x1), y1 + 0.3 * (y0 - y1)
        drawing.line((x0, y0), (x1, y1), "cut")
        tip = f"{graph.label_end(end)} - {graph.label_end(far)}: cut"
        drawing.path(svg.cross((x0 + x1) / 2, (y0 + y1) / 2, 5.0), "gap", tip)
