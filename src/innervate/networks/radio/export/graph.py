"""Who hears whom in a radio team as a graph, and after how long."""

from typing import Any

from innervate.export.graphs import Graph


def graph(plan: Any) -> Graph:
    """A plan's stations, and between those that hear each other the delay in us."""
    names = [f"station {i}" for i in range(plan.stations)]
    nodes = [(name, {"role": "station", "number": i}) for i, name in enumerate(names)]
    edges = [
        (names[i], names[j], {"delay_us": int(plan.delays_us[i][j])})
        for i in range(plan.stations)
        for j in range(plan.stations)
        if i != j and plan.delays_us[i][j] >= 0
    ]
    return Graph(True, nodes, edges)
