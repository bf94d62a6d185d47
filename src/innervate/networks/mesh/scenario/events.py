"""What happens to a mesh: from [[event]] tables to faults, in order of time."""

from collections.abc import Collection
from typing import Any

from innervate.networks.mesh.scenario.model import MeshEventTable, MeshScenario
from innervate.networks.mesh.scenario.nodes import Nodes, are, there_are
from innervate.networks.mesh.scenario.plan import MeshFault
from innervate.scenario.actions.field import ACTIONS, TABLE, TARGETS
from innervate.scenario.events import Harmed, at_us
from innervate.trace.streams import Stream, stream

NOISE_CDB = 2000  # a noise is so much above the 50 % point if nothing is said

Pair = tuple[int, int]


class _Tale(Harmed):
    """What random events may hit as events go by."""

    def __init__(
        self, nodes: Nodes, good: list[Pair], spared: Collection[int], absent: list[int]
    ) -> None:
        super().__init__(TABLE)
        self.nodes = nodes
        self.good = good
        self.spared = spared
        self.by["kill"] |= {node for node, away in enumerate(absent) if away}

    def candidates(self, word: str) -> list[Any]:
        """What a random event may hit: nodes, or links for cut and restore."""
        if self.actions[word].mends:
            return sorted(self.by[self.actions[word].mends])
        if word == "cut":
            return [link for link in self.good if link not in self.by["cut"]]
        return [node for node in range(len(self.nodes.names))
                if node not in self.spared and node not in self.by["kill"]]  # fmt: skip


def absent(model: MeshScenario, nodes: Nodes, roles: dict[str, int]) -> list[int]:
    """Per node 1 if it is away until its first event, a revive, switches it on."""
    found = [0] * len(nodes.names)
    seen = set()
    ordered = sorted(enumerate(model.event), key=lambda item: (_first(item[1]), item[0]))
    for index, event in ordered:
        if event.node is None or event.action not in ("kill", "revive", "restart"):
            continue
        if not nodes.is_here(event.node):
            continue
        node = _node(nodes, index, event.node, roles)
        if node not in seen:
            found[node] = int(event.action == "revive")
            seen.add(node)
    return found


def _first(event: MeshEventTable) -> float:
    return event.at_s[0] if isinstance(event.at_s, tuple) else event.at_s


def _node(nodes: Nodes, index: int, given: int | str, roles: dict[str, int]) -> int:
    if isinstance(given, str) and given in roles:
        return roles[given]
    return nodes.number(("event", index, "node"), given)


def faults(
    model: MeshScenario,
    nodes: Nodes,
    good: list[Pair],
    spared: Collection[int],
    roles: dict[str, int],
    rssi50_cdb: int,
) -> list[MeshFault]:
    """The faults of a run.

    Random cuts are drawn from the `good` links; random events leave `spared` nodes alone. `roles`
    are the nodes of "gateway" and "monitor"; the radio's 50 % point is in 0.01 dBm.

    Raises:
        ScenarioError: somebody who is not there, or too few to draw from.
    """
    tale = _Tale(nodes, good, spared, absent(model, nodes, roles))
    timed = []
    for index, event in enumerate(model.event):
        draw = stream(model.seed, f"event/{index}")
        timed.append((at_us(event, draw), index, event, draw))
    found = []
    for at, index, event, draw in sorted(timed, key=lambda item: item[:2]):
        noise = 0
        if event.action == "jam":
            noise = rssi50_cdb + NOISE_CDB if event.noise_dbm is None else (
                round(100 * event.noise_dbm)
            )  # fmt: skip
        for hit in _hits(model, tale, index, event, draw, roles):
            tale.note(event.action, hit)
            node, other = hit if isinstance(hit, tuple) else (hit, 0)
            found.append(MeshFault(at, ACTIONS.index(event.action), node, other, noise, index))
    return found


def _hits(
    model: MeshScenario,
    tale: _Tale,
    index: int,
    event: MeshEventTable,
    draw: Stream,
    roles: dict[str, int],
) -> list[Any]:
    """The nodes or links that an event happens to."""
    nodes = tale.nodes
    if event.random is not None:
        free = tale.candidates(event.action)
        if event.random > len(free):
            which = {
                "revive": "dead", "cut": "whole", "restore": "cut", "quiet": "jammed",
            }.get(event.action, "alive and no flow's end, robot, gateway or monitor")  # fmt: skip
            there = there_are(len(free), TARGETS[event.action])
            message = f"event.{index}.random = {event.random}, but {there} that "
            message += f"{are(len(free))} {which}"
            raise nodes.source.error(("event", index, "random"), message)
        return sorted(free.pop(draw.draw(len(free))) for _ in range(event.random))
    named = [event.node] if event.link is None else list(event.link)
    if not all(nodes.is_here(one) for one in named if one is not None):
        return []
    if event.link is not None:
        a, b = (nodes.number(("event", index, "link", i), end) if end not in roles else
                roles[str(end)] for i, end in enumerate(event.link))  # fmt: skip
        if a == b:
            message = f"event.{index}.link names {nodes.names[a]} twice; name two nodes"
            raise nodes.source.error(("event", index, "link"), message)
        if nodes.links and (min(a, b), max(a, b)) not in nodes.links:
            message = f"event.{index}: there is no link {nodes.names[a]} - {nodes.names[b]}"
            raise nodes.source.error(
                ("event", index, "link"), f"{message}; name one of those given"
            )
        return [(min(a, b), max(a, b))]
    assert event.node is not None
    return [_node(nodes, index, event.node, roles)]
