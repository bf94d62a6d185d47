"""Who is cabled to whom, and where cells lie: patches, cables, free graphs, robot bodies."""

from innervate.topology.body import body_graph, cells_from_urdf, normals_from_urdf
from innervate.topology.errors import TopologyError
from innervate.topology.free import free_graph
from innervate.topology.graph import Graph, from_patches, join_chain
from innervate.topology.patch import CELLS_MAX, PORT_NAMES, PORTS, Patch, port_number

__all__ = [
    "CELLS_MAX",
    "PORTS",
    "PORT_NAMES",
    "Graph",
    "Patch",
    "TopologyError",
    "body_graph",
    "cells_from_urdf",
    "free_graph",
    "from_patches",
    "join_chain",
    "normals_from_urdf",
    "port_number",
]
