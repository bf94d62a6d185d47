"""Whom every node of a simulated mesh would hand a packet for the gateway, for all at once.

As `protocol/mesh_route.py` has it: the gateway itself if it is a strong neighbour, the table, its
alternate, the uplink; each only while it is not suspected. What a packet has been through besides
is nothing that a map could show.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from innervate.networks.mesh.protocol.constants import LIST, TABLES
from innervate.networks.mesh.protocol.neighbours import FREE, UNHEARD
from innervate.web.ways import NOWHERE, Numbers

FAR = 1 << 30


def hops(world: Any, plan: Any) -> Numbers:
    """The next hop of every node, NOWHERE without one."""
    count, params = plan.nodes, plan.params
    nodes = world.nodes[:count]
    near, suspect = nodes["near"], nodes["suspect"] == 1
    gateway = nodes["gateway"].astype(np.int64)
    who = np.arange(count)

    def usable(found: Any) -> Any:
        hit = (near == found[:, None]) & suspect
        return (found != FREE) & (found != who) & ~hit.any(axis=1)

    strong = ((near == gateway[:, None]) & (nodes["rssi"] >= 4 * params["min_rssi"])).any(axis=1)
    best = np.where(strong & usable(gateway), gateway, FREE)
    if params["mode"] == TABLES:
        place = nodes["bank"] * params["width"] + np.minimum(gateway, params["width"] - 1)
        for table in ("next", "alt"):
            way = nodes[table][who, place].astype(np.int64)
            best = np.where((best == FREE) & usable(way) & (gateway != FREE), way, best)
    best = np.where(best == FREE, _uplinks(nodes, params, suspect), best)
    found: Numbers = np.where((best == FREE) | (best >= count), NOWHERE, best)
    return found


def _uplinks(nodes: Any, params: Any, suspect: Any) -> Numbers:
    """The best of the neighbours that are nearer to the gateway; FREE without one."""
    near, depth = nodes["near"], nodes["round_depth"]
    up = (near != FREE) & (depth != UNHEARD) & (depth < nodes["depth"][:, None]) & ~suspect
    if params["discovery"] != LIST:
        up_parent = (up & (near == nodes["parent"][:, None])).any(axis=1)
    else:
        up_parent = np.zeros(len(nodes), np.bool_)
    weak = nodes["round_rssi"] < params["min_rssi"]
    cost = np.where(up, weak * 1_000_000 + depth * 1_000 - nodes["round_rssi"], FAR)
    place = cost.argmin(axis=1)
    found = np.where(up.any(axis=1), near[np.arange(len(nodes)), place], FREE)
    best: Numbers = np.where(up_parent, nodes["parent"], found).astype(np.int64)
    return best
