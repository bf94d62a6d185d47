"""A mesh's links as a graph: each way has a quality of its own."""

from typing import Any

from innervate.export.graphs import Attributes, Graph

ONE = 32_768


def graph(plan: Any) -> Graph:
    """A plan's nodes with their roles and places in metres, and its links."""
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
    return Graph(True, nodes, edges)
