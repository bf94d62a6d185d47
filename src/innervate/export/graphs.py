"""A scenario's network as a graph: GraphML, and node-link JSON as networkx and d3 read it.

Links of a skin are cables, undirected; a mesh's and a radio team's are directed, as each way has a
quality or a delay of its own.
"""

import json
from pathlib import Path
from typing import Any, NamedTuple
from xml.etree import ElementTree as tree

from innervate.export import files
from innervate.export.errors import ExportError
from innervate.network import networks

SUFFIXES = (".graphml", ".json")
NAMESPACE = "http://graphml.graphdrawing.org/xmlns"
TYPES = {bool: "boolean", int: "long", float: "double", str: "string"}

Attributes = dict[str, Any]
Node = tuple[str, Attributes]
Edge = tuple[str, str, Attributes]


class Graph(NamedTuple):
    """Nodes and links with their attributes, by the names that reports show."""

    directed: bool  # a link has a direction, and the way back attributes of its own
    nodes: list[Node]  # (name, attributes)
    edges: list[Edge]  # (name of one end, of the other, attributes)


def write(plan: Any, path: Path) -> None:
    """Write the graph of a plan; the file's suffix says how.

    Raises:
        ExportError: the suffix is neither, or the file cannot be written.
    """
    if path.suffix not in SUFFIXES:
        raise ExportError(f'{path}: a graph is a file "….graphml" or "….json"')
    graph: Graph = networks()[plan.kind].graph(plan)
    make = node_link if path.suffix == ".json" else graphml
    about = {"name": plan.scenario.name, "kind": plan.kind}
    files.write_text(path, make(about, graph.directed, graph.nodes, graph.edges))


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
