"""Where the parts stand that several networks have at the same places in their folders."""

from typing import Any

# Of skin, radio and mesh.
PLACES: dict[str, Any] = {
    "check": "scenario.rules:check",
    "describe": "scenario.words:describe",
    "fault_words": "scenario.words:fault_words",
    "template": "innervate.scenario.bundled:template",
    "run": "run",
    "tables": "tables:TABLES",
    "capture": "export.capture",
    "graph": "export.graph:graph",
    "report": "plot.report:body",
    "notebook": "plot.report:notebook",
    "figures": "plot.figures:FIGURES",
    "summary_lines": "show:summary_lines",
    "demo": "demo",
    "frames": "frames",
    "fields": "protocol.fields",
    "live_node": "live.build:build",
    "live_words": "live.words",
    "papers": "papers",
    "verify": "verify.command",
    "prove": "prove.theories",
    "boards": "board:ROLES",
    "random": "verify.fuzz",
}
# Of those that are little more than a declared protocol.
DECLARED: dict[str, Any] = {
    "protocol": "protocol.node",
    "fields": "protocol.fields",
    "frames": "frames",
    "invariants": "invariants",
    "comparison": "comparison",
}
