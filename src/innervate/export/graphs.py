"""A scenario's network as a graph: GraphML, and node-link JSON as networkx and d3 read it.

Links of a skin are cables, undirected; a mesh's and a radio team's are directed, as each way has a
quality or a delay of its own.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as tree

from innervate.export import files
from innervate.export.errors import ExportError
from innervate.topology import PORT_NAMES

SUFFIXES = (".graphml", ".json")
ONE = 32_768
NAMESPACE = "http://graphml.graphdrawing.org/xmlns"
TYPES = {bool: "boolean", int: "long", float: "double", str: "string"}

Attributes = dict[str, Any]
Node = tuple[str, Attributes]
Edge = tuple[str, str, Attributes]


def write(plan: Any, path: Path) -> None:
    """Write the graph of a plan; the file's suffix says how.

    Raises:
        ExportError: the suffix is neither, or the file cannot be written.
    """
    if path.suffix not in SUFFIXES:
        raise ExportError(f'{path}: a graph is a file "….graphml" or "….json"')
    nodes, edges = graph_of(plan)
    make = node_link if path.suffix == ".json" else graphml
    about = {"name": plan.scenario.name, "kind": plan.kind}
    files.write_text(path, make(about, plan.kind != "skin", nodes, edges))


def graph_of(plan: Any) -> tuple[list[Node], list[Edge]]:
    """Nodes and links with their attributes, by the names that reports show."""
    return {"skin": _skin, "mesh": _mesh, "radio": _radio}[plan.kind](plan)


def _skin(plan: Any) -> tuple[list[Node], list[Edge]]:
    graph = plan.graph
    nodes: list[Node] = []
    for cell, (x, y) in enumerate(graph.layout()):
        at: Attributes = {"x_mm": float(x), "y_mm": float(y)}
        if graph.positions:
            at = dict(zip(("x_mm", "y_mm", "z_mm"), graph.positions[3 * cell : 3 * cell + 3],
                          strict=True))  # fmt: skip
        hops = int(plan.depths[cell])
        nodes.append((graph.label(cell), {"role": "cell", "number": cell, "hops": hops, **at}))
    nodes.append((graph.label(graph.sink), {"role": "pc", "number": graph.sink, "hops": 0}))
    edges = [
        (graph.label(graph.node_of(a)), graph.label(graph.node_of(b)),
         {"port_a": _port(graph, a), "port_b": _port(graph, b)})
        for a, b in graph.links()
    ]  # fmt: skip
    return nodes, edges


def _port(graph: Any, end: int) -> str:
    port = graph.port_of(end)
    return str(port) if graph.node_of(end) == graph.sink else PORT_NAMES[port]


def _mesh(plan: Any) -> tuple[list[Node], list[Edge]]:
    nodes = []
    for i, name in enumerate(plan.names):
        role = "gateway" if plan.ranks[i] == 0 else "standby" if plan.ranks[i] > 0 else "node"
        about: Attributes = {"role": role, "number": i, "robot": bool(plan.robots[i])}
        if plan.positions_cm:
            about |= {"x_m": plan.positions_cm[i][0] / 100, "y_m": plan.positions_cm[i][1] / 100}
        nodes.append((name, about))
    good = {*plan.good, *((b, a) for a, b in plan.good)}
    edges = []
    for i, name in enumerate(plan.names):
        for j, other in enumerate(plan.names):
            at = i * plan.nodes + j
            if i != j and plan.radio.prob_q15[at]:
                quality = plan.radio.prob_q15[at] / ONE
                rssi = plan.radio.rssi_cdb[at] / 100
                is_good = (i, j) in good
                edges.append((name, other, {"quality": quality, "rssi_dbm": rssi, "good": is_good}))
    return nodes, edges


def _radio(plan: Any) -> tuple[list[Node], list[Edge]]:
    names = [f"station {i}" for i in range(plan.stations)]
    nodes = [(name, {"role": "station", "number": i}) for i, name in enumerate(names)]
    edges = [
        (names[i], names[j], {"delay_us": int(plan.delays_us[i][j])})
        for i in range(plan.stations)
        for j in range(plan.stations)
        if i != j and plan.delays_us[i][j] >= 0
    ]
    return nodes, edges


def node_link(about: Attributes, directed: bool, nodes: list[Node], edges: list[Edge]) -> str:
    """Node-link JSON; several cables between the same two nodes are several links."""
    content = {
        "directed": directed,
        "multigraph": True,
        "graph": about,
        "nodes": [{"id": name, **of} for name, of in nodes],
        "edges": [{"source": a, "target": b, "key": i, **of} for i, (a, b, of) in enumerate(edges)],
    }
    return json.dumps(content, indent=1, ensure_ascii=False) + "\n"


def graphml(about: Attributes, directed: bool, nodes: list[Node], edges: list[Edge]) -> str:
    """GraphML, every attribute with its type."""
    root = tree.Element("graphml", {"xmlns": NAMESPACE})
    keys: dict[tuple[str, str], str] = {}
    parts: tuple[tuple[str, list[Attributes]], ...] = (
        ("graph", [about]),
        ("node", [of for _, of in nodes]),
        ("edge", [of for _, _, of in edges]),
    )
    for part, given in parts:
        for name, value in {name: value for of in given for name, value in of.items()}.items():
            key = keys[part, name] = f"d{len(keys)}"
            kind = TYPES[type(value)]
            named = {"id": key, "for": part, "attr.name": name, "attr.type": kind}
            tree.SubElement(root, "key", named)

    def tell(element: tree.Element, part: str, of: Attributes) -> None:
        for name, value in of.items():
            data = tree.SubElement(element, "data", {"key": keys[part, name]})
            data.text = str(value).lower() if isinstance(value, bool) else str(value)

    default = "directed" if directed else "undirected"
    graph = tree.SubElement(root, "graph", {"edgedefault": default})
    tell(graph, "graph", about)
    for name, of in nodes:
        tell(tree.SubElement(graph, "node", {"id": name}), "node", of)
    for i, (a, b, of) in enumerate(edges):
        edge = tree.SubElement(graph, "edge", {"id": str(i), "source": a, "target": b})
        tell(edge, "edge", of)
    tree.indent(root)
    return tree.tostring(root, encoding="unicode", xml_declaration=True) + "\n"
