"""What a run of Babel measures beside what every network does."""

from typing import Any

from innervate.networks.babel.protocol.constants import REPORT_DROP, REPORT_LINK, REPORT_ROUTE


def measures(nodes: Any, reports: Any, deliveries: Any, plan: Any) -> dict[str, float]:
    """Nodes that are on and have a route, route changes, links found down, data without a route."""
    codes = [int(row["code"]) for row in reports]
    lost = [row for row in reports if row["code"] == REPORT_LINK and row["b"] == 0]
    return {
        "routed_nodes": sum(node.parent >= 0 for node in nodes),
        "route_changes": codes.count(REPORT_ROUTE),
        "lost_links": len(lost),
        "dropped_data": codes.count(REPORT_DROP),
    }
