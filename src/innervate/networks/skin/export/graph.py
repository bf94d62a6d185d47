"""A skin's cables as a graph."""

from typing import Any

from innervate.export.cabled import edges
from innervate.export.graphs import Attributes, Graph, Node
from innervate.topology.layout import cell_places


def graph(plan: Any) -> Graph:
    """A plan's cells with places in mm and hops, and its cables."""
    cells = plan.graph
    nodes: list[Node] = []
    for cell, (x, y) in enumerate(cell_places(cells)):
        at: Attributes = {"x_mm": float(x), "y_mm": float(y)}
        if cells.positions:
            at = dict(zip(("x_mm", "y_mm", "z_mm"), cells.positions[3 * cell : 3 * cell + 3],
                          strict=True))  # fmt: skip
        hops = int(plan.depths[cell])
        nodes.append((cells.label(cell), {"role": "cell", "number": cell, "hops": hops, **at}))
    nodes.append((cells.label(cells.sink), {"role": "pc", "number": cells.sink, "hops": 0}))
    return Graph(False, nodes, edges(cells))
