"""What of a scenario of managed flooding cannot work, told before it runs."""

from typing import Any

from innervate.topology.placement import distances, neighbours

SHOWN = 4


def foreseen(plan: Any) -> list[str]:
    """A sentence for each thing; none if all is well."""
    if not plan.inputs:
        return ["nobody sends anything: there is no [[input]]; add one"]
    near, most = neighbours(plan.nodes, plan.good), plan.params["hops"] + 1
    far = []
    for node, dest in dict.fromkeys((one.node, one.item.get("dest", 0)) for one in plan.inputs):
        hops = distances(near, node)[dest] if dest < plan.nodes else 0
        if hops > most:
            far.append(f"{node} to {dest} ({hops})")
    if not far:
        return []
    more = f" and {len(far) - SHOWN} more" if len(far) > SHOWN else ""
    return [
        f"protocol.hops = {most - 1} lets packets go {most} at most, and it is more over good "
        f"links from {', '.join(far[:SHOWN])}{more}"
    ]
