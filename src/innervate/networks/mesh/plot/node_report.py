"""The table of a mesh report that has a line for every node."""

from __future__ import annotations

from typing import Any

from innervate.networks.mesh.analysis.nodes import nodes
from innervate.networks.mesh.plot.map import roles
from innervate.plot import svg, words
from innervate.plot.page import details, section, table

OPEN_MAX = 40  # a longer table is folded
HEAD = ("node", "role", "neighbours", "depth", "table", "control bytes", "forwarded", "on the air",
        "suspected")  # fmt: skip


def section_of(result: Any) -> str:
    """The section "Node by node"."""
    plan, role = result.plan, roles(result.plan)
    rows = []
    for node in nodes(result):
        leads = node.on and node.depth == 0 and plan.ranks[node.node] > 0
        said = (role[node.node], "leads" if leads else "", "" if node.on else "off")
        what = ", ".join(word for word in said if word)
        rows.append((
            svg.clean(plan.names[node.node]),
            what,
            f"{node.neighbours}",
            "unknown" if node.depth is None else f"{node.depth}",
            f"{node.version}" if node.version else "none",
            f"{node.control_bytes:,}",
            f"{node.forwarded:,}",
            words.share_words(node.share),
            f"{node.suspected:,}",
        ))  # fmt: skip
    made = table(HEAD, rows)
    if len(rows) > OPEN_MAX:
        made = details(f"All {len(rows)} nodes", made)
    return section("Node by node", made)
