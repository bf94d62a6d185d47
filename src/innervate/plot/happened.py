"""What a scenario did to a network that has no words of its own for it, in words."""

from typing import Any

from innervate.kernel.words import number_of
from innervate.network import networks
from innervate.plot.words import share_words
from innervate.scenario.cables import LOSS_ONE

NODES = {
    "begin": "switched on", "kill": "switched off", "leave": "told to leave",
    "restart": "restarted", "revive": "switched on again",
}  # fmt: skip


def event_words(plan: Any, fault: Any) -> str:
    """A fault, without its time: "node n3 switched off", "cable n1 E - n2 W cut"."""
    network = networks()[plan.kind]
    action = network.actions[fault.action]
    if network.medium != "cables":
        return _on_air(action, fault)
    graph = plan.graph
    if fault.end < 0:
        return f"node {graph.label(fault.node)} {NODES[action]}"
    ends = f"{graph.label_end(fault.end)} - {graph.label_end(graph.peer[fault.end])}"
    return f"cable {ends} {cable_words(action, fault)}"


def cable_words(action: str, fault: Any) -> str:
    """What happened to a cable: "cut"."""
    share = share_words(fault.loss_q15 / LOSS_ONE)
    return {
        "cut": "cut",
        "restore": "put back",
        "loose": f"loose, losing {share}" if fault.loss_q15 else "tight again",
        "lose": f"loses {number_of(fault.frames, 'frame')}",
    }[action]


def _on_air(action: str, fault: Any) -> str:
    node = f"node {fault.node}"
    if action in NODES:
        return f"{node} {NODES[action]}"
    if action in ("cut", "restore"):
        verb = "cut" if action == "cut" else "restored"
        return f"link {node} - node {fault.other} {verb}"
    loud = f"noise of {fault.value / 100:g} dBm at {node}"
    return loud if action == "jam" else f"no noise at {node} any more"
