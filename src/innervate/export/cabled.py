"""Any network of cables as a capture and as a graph, from its plan's `graph` and frame layouts."""

from collections.abc import Callable
from typing import Any

import numpy as np

from innervate.export import bulk, links
from innervate.export.graphs import Graph
from innervate.folders import MEDIA_ON_AIR
from innervate.network import Network
from innervate.topology import PORT_NAMES
from innervate.topology.layout import cell_places
from innervate.wire.layout import width

Word = Callable[[Any, int], tuple[str, int]]


def as_node(_graph: Any, node: int) -> tuple[str, int]:
    """What a capture calls a node, and its number."""
    return "node", node


def interfaces(plan: Any, word: Word = as_node) -> list[tuple[str, str]]:
    """(name, description) of every port that has a cable, in order."""
    graph, found = plan.graph, []
    for end in _cabled(graph):
        cable = (graph.label_end(end), graph.label_end(graph.peer[end]))
        what, number = word(graph, graph.node_of(end))
        found.append((cable[0], links.describe(what, number, graph.port_of(end), cable)))
    return found


def numbers(plan: Any) -> Any:
    """Which interface a tap's row is of, by its column `at`."""
    found = np.zeros(len(plan.graph.peer), np.int64)
    cabled = _cabled(plan.graph)
    found[cabled] = np.arange(len(cabled))
    return found


def _cabled(graph: Any) -> list[int]:
    """Ends that have a cable."""
    return [end for end, peer in enumerate(graph.peer) if peer >= 0]


def on_air(plan: Any) -> list[tuple[str, str]]:
    """(name, description) of every node on a channel, in order."""
    return [(f"node {i}", links.describe("node", i)) for i in range(plan.nodes)]


def stations(plan: Any) -> Any:
    """As `numbers`, for nodes on a channel."""
    return np.arange(plan.nodes)


def packed(layouts: Any, kind_bits: int, kept: Any) -> list[bytes]:
    """The bytes of frames of a type, the type's fields and a CRC, from an array of records."""
    return bulk.by_kind(kept, {
        kind: (fields, kind, kind_bits, (kind_bits + width(fields) + 7) // 8 + bulk.CRC_BYTES)
        for kind, _name, fields in layouts
    })  # fmt: skip


class Captured:
    """What a network without a part `capture` has in its place."""

    LATE_US = 0  # a row is told at its moment

    def __init__(self, network: Network) -> None:
        self.simulate = network.run.simulate
        self.interfaces: Any = interfaces
        self.numbers: Any = numbers
        if network.medium in MEDIA_ON_AIR:
            self.interfaces, self.numbers = on_air, stations
        self._layouts = network.frames.LAYOUTS if network.has("frames") else ()
        self._kind_bits = network.frames.KIND_BITS if self._layouts else 0

    def refusal(self, plan: Any) -> str:
        """Why there is no capture of a plan; "" if there is one."""
        if not hasattr(plan, "graph") and self.interfaces is not on_air:
            return f"a {plan.kind} has no cables, and says nothing of its frames on another medium"
        return "" if self._layouts else f"a {plan.kind} does not say how its frames are laid out"

    def frames(self, _rows: Any, kept: Any) -> list[bytes]:
        """The bytes of frames, given as an array of records."""
        return packed(self._layouts, self._kind_bits, kept)


def graph(plan: Any) -> Graph:
    """Nodes, with their places if they have any, and cables; a plan without cables has none."""
    if not hasattr(plan, "graph"):
        pairs: list[Any] = [(f"node {a}", f"node {b}", {}) for a, b in getattr(plan, "good", ())]
        found: list[Any] = [(f"node {i}", {"number": i}) for i in range(plan.nodes)]
        for (_, about), (x, y) in zip(found, getattr(plan, "positions_cm", ()), strict=False):
            about.update(x_m=x / 100, y_m=y / 100)
        return Graph(False, found, pairs)
    made = plan.graph
    has_places = bool(made.patches or made.positions)
    places = cell_places(made) if has_places else [()] * made.cells
    nodes = [
        (made.label(cell), dict(zip(("number", "x_mm", "y_mm"), (cell, *place), strict=False)))
        for cell, place in enumerate(places)
    ]
    if made.interfaces:
        nodes.append((made.label(made.sink), {"number": made.sink}))
    return Graph(False, nodes, edges(made))


def edges(graph: Any) -> list[Any]:
    """Every cable, with the ports that it joins."""
    return [
        (graph.label(graph.node_of(a)), graph.label(graph.node_of(b)),
         {"port_a": _port(graph, a), "port_b": _port(graph, b)})
        for a, b in graph.links()
    ]  # fmt: skip


def _port(graph: Any, end: int) -> str:
    port = graph.port_of(end)
    return str(port) if graph.node_of(end) == graph.sink else PORT_NAMES[port]
