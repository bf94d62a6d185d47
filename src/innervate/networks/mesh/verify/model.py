"""What is explored of a mesh: a small network, its settings, what is offered, what may fail."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from innervate import scenario as scenarios
from innervate.networks.mesh.protocol import fields as mesh_fields
from innervate.scenario.emit import to_toml
from innervate.topology.placement import distances, neighbours
from innervate.verify.errors import VerifyError

NODES_MAX = 6
DOCUMENTS = ("random", "rssi", "heard")  # another neighbour takes the place of a next hop
FAILOVERS = ("search", "graph", "alternate", *DOCUMENTS)
NAMED = {
    "line": "0-1 1-2",
    "triangle": "0-1 0-2 1-2",
    "square": "0-1 0-2 1-3 2-3",
    "kite": "0-1 0-2 1-2 1-3 2-3",
    "house": "0-1 0-2 1-2 1-3 2-4 3-4",
    "spare": "0-1 0-2 1-3 2-3 3-4",
    "prism": "0-1 0-2 1-2 1-3 2-4 0-5 3-4 3-5 4-5",
}
# Times that suit nodes whose frames take no time; what is not here is the radio profile's. Where
# any event may be next, measured round trips change no order, but make many states of one.
BRISK = {
    "jitter_s": 0.02, "listen_s": 0.1, "spread_s": 0.1, "collect_s": 0.4, "copies": 1,
    "e2e_adapt": False,
}  # fmt: skip
# A message is tried twice in all, a hop once: what three transmissions can do to a hop, one can.
SHORT = (("e2e_tries", 1), ("transmissions", 1))
QUICK = (("period_s", 2.0), ("period_max_s", 2.0), ("dead_s", 3.0), ("dead_step_s", 1.0))
# Questions, each after a wait: all in vain before the next request could be missed.
ASKED = (("period_s", 6.0), ("period_max_s", 6.0), ("guard_s", 0.1))
FENCE = {
    "points": 4,
    "px": [0, 1000, 1000, 0] + [0] * (mesh_fields.POINTS - 4),
    "py": [0, 0, 1000, 1000] + [0] * (mesh_fields.POINTS - 4),
    "after": [1, 2, 3, 0] + [0] * (mesh_fields.POINTS - 4),
}


@dataclass(frozen=True, slots=True)
class MeshBudget:
    """How often what may fail."""

    deaths: int = 1  # nodes that die, with what they remember
    revivals: int = 0  # dead nodes that are switched on again
    # receptions that fail: of a frame by whom it is for, of a broadcast by one node
    frames: int = 1
    acks: int = 1  # hop acks that are lost
    ticks: int = 0  # beats of every node, untimed only; a timed search counts them by its `beats`


@dataclass(frozen=True)
class MeshModel:
    """What is explored of a mesh."""

    # who hears whom, both ways; nodes are numbered from 0, the gateway
    links: tuple[tuple[int, int], ...]
    # as in a scenario; those of DOCUMENTS take the document's other reading, too: no retry
    failover: str = "search"
    # messages (from, to), offered in this order, at any moment
    offers: tuple[tuple[int, int], ...] = ()
    robot: int = -1  # a node that finds itself outside the fence once, at any moment; -1 none
    standby: tuple[int, ...] = ()  # nodes that take over from a dead gateway, in order
    budget: MeshBudget = field(default_factory=MeshBudget)  # how often what may fail
    settings: tuple[tuple[str, Any], ...] = ()  # further keys of [protocol]
    reliable: bool = True  # messages are kept until acknowledged
    overhear: bool = True  # frames for others are heard, too
    # 0 = untimed: any order. Else every node's clock runs alike, for so many seconds
    beats: int = 0

    @property
    def nodes(self) -> int:
        """How many nodes the links join, the gateway included."""
        return 1 + max(max(link) for link in self.links)

    @property
    def protocol(self) -> dict[str, Any]:
        """Keys of [protocol] by which a scenario is the same network."""
        document = {"retry": False} if self.failover in DOCUMENTS else {}
        return {**BRISK, "failover": self.failover, **document, **dict(self.settings)}


def parse(text: str) -> tuple[tuple[int, int], ...]:
    """Links from a name, or from text like "0-1 1-2".

    Raises:
        VerifyError: the text names no network, or one that is not connected or too large.
    """
    links = set()
    for word in NAMED.get(text, text).replace(",", " ").split():
        ends = word.split("-")
        if len(ends) != 2 or not all(x.isascii() and x.isdigit() for x in ends):
            known = ", ".join(NAMED)
            raise VerifyError(f'"{word[:40]}" is no link; write "0-1 1-2" or take one of: {known}')
        a, b = sorted(map(int, ends))
        links.add((a, b))
    nodes = 1 + max((b for _, b in links), default=0)
    loops = any(a == b for a, b in links)
    if loops or not 3 <= nodes <= NODES_MAX or reach(nodes, links, 0) != set(range(nodes)):
        raise VerifyError(
            f'"{text[:60]}": a mesh joins the nodes 0, 1, ... by links: 3 to {NODES_MAX} of them'
        )
    return tuple(sorted(links))


def text_of(links: Any) -> str:
    """Pairs of nodes as "0-1 1-2"."""
    return " ".join(f"{a}-{b}" for a, b in links)


def reach(nodes: int, links: Any, start: int, dead: Any = ()) -> set[int]:
    """Who is connected to a live node over live nodes."""
    alive = [(a, b) for a, b in links if a not in dead and b not in dead]
    hops = distances(neighbours(nodes, alive), start)
    return {node for node, far in enumerate(hops) if far >= 0}


def scenario_text(
    model: MeshModel, name: str, duration_s: float, seed: int = 1, **more: Any
) -> str:
    """The network and its settings, and more tables, as a scenario file."""
    tables = {"kind": "mesh", "name": name, "duration_s": duration_s, "seed": seed,
              "nodes": model.nodes, "gateway": 0}  # fmt: skip
    if model.standby:
        tables["standby"] = list(model.standby)
    links = [{"a": a, "b": b} for a, b in model.links]
    return to_toml({**tables, "protocol": model.protocol, "link": links, **more})


def parameters(model: MeshModel) -> dict[str, Any]:
    """The protocol's parameters as a scenario of this network has them, in a class of its size.

    Raises:
        VerifyError: a setting cannot be.
    """
    if model.failover not in FAILOVERS:
        raise VerifyError(f"failover is one of {', '.join(FAILOVERS)}")
    try:
        plan = scenarios.plan(scenarios.loads(scenario_text(model, "explored", 10.0)))
    except scenarios.ScenarioError as error:
        raise VerifyError(str(error)) from error
    n = model.nodes
    own = {"width": n, "row": mesh_fields.row_bytes(n), "places": n}
    own["reliable"] = int(model.reliable)
    fence = FENCE | {"watch": 0} if model.robot >= 0 else {}
    return {**plan.params, **own, **fence}


def ranks(model: MeshModel) -> list[int]:
    """0 the gateway, 1.. standbys in order, -1 the others."""
    found = [0] + [-1] * (model.nodes - 1)
    for place, node in enumerate(model.standby, 1):
        found[node] = place
    return found
