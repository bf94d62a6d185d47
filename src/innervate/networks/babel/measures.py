"""What a run of Babel measures beside what every network does."""

from typing import Any

REPORT_ROUTE, REPORT_DROP, REPORT_LINK = 1, 2, 3


def measures(nodes: Any, reports: Any, deliveries: Any, plan: Any) -> dict[str, float]:
    """Nodes that are on and have a route, route changes, links found down, data without a route."""
    found = {"routed_nodes": sum(node.parent >= 0 for node in nodes)}
    codes = [int(row["code"]) for row in reports]
    found["route_changes"] = codes.count(REPORT_ROUTE)
    found["lost_links"] = sum(
        int(row["code"]) == REPORT_LINK and int(row["b"]) == 0 for row in reports
    )
    found["dropped_data"] = codes.count(REPORT_DROP)
    return found
