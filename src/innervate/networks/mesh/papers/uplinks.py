"""Whom nodes heard first in a discovery round, and who of the nearer ones is the best [A2]."""

from typing import Any

import numpy as np

from innervate.networks.mesh.papers.testbed import MeshTestbed
from innervate.networks.mesh.protocol.neighbours import FREE, UNHEARD
from innervate.sim.tables import get

COUNTS = ("nodes", "other", "first", "best")


def measure(of: MeshTestbed, seed: int) -> dict[str, int]:
    """Nodes that heard a request; whose best is another; whose link to either is a good one."""
    result = of.run(seed)
    plan, table = result.plan, result.world.nodes
    good = {pair for a, b in plan.good for pair in ((a, b), (b, a))}
    counts = dict.fromkeys(COUNTS, 0)
    for node in range(1, plan.nodes):
        best = _best(table, node, plan.params["min_rssi"])
        if best is not None:
            first = int(get(table, node, "parent"))
            counts["nodes"] += 1
            counts["other"] += best != first
            counts["first"] += (node, first) in good
            counts["best"] += (node, best) in good
    return counts


def _best(table: Any, node: int, min_rssi: int) -> int | None:
    """As with discovery list: who is nearer to the gateway and not faint, nearest, loudest."""
    near, depth, rssi = (
        np.asarray(get(table, node, name)).astype(int).tolist()
        for name in ("neighbour", "round_depth", "round_rssi")
    )
    mine = int(get(table, node, "depth"))
    known = [k for k, who in enumerate(near) if who != FREE and depth[k] != UNHEARD]
    up = [(rssi[k] < min_rssi, depth[k], -rssi[k], k) for k in known if depth[k] < mine]
    return near[min(up)[-1]] if up and mine != UNHEARD else None
