"""The testbed of the mesh's figures [mesh 6]: networks, who dies and when, who sends to whom."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from innervate import scenario as scenarios
from innervate.networks.mesh.protocol.constants import END_TO_END
from innervate.networks.mesh.scenario.plan import MeshFault, MeshPlan, Offer
from innervate.networks.mesh.sim.simulate import MeshResult, simulate
from innervate.papers.experiment import Point, sized
from innervate.scenario.actions.field import KILL
from innervate.trace.streams import stream

Options = tuple[tuple[str, Any], ...]
GATEWAY = 0
BYTES = 16  # of a message
seeds = sized(4, 30)  # how many, each of one network
# The document to the letter: one transmission, another neighbour for the next packet, no second
# try from end to end.
LITERAL: Options = (
    ("failover", "random"), ("retry", False), ("reliable", False), ("transmissions", 1),
)  # fmt: skip
GRAPH: Options = (("failover", "graph"),)
HOPS: Options = (("reliable", False),)  # acks of hops alone, none from end to end


@dataclass(frozen=True, slots=True)
class MeshTestbed:
    """Networks of nodes anywhere in a square of 100 m, node 0 the gateway."""

    # nodes, degree: how many, and good links of a node in the mean
    nodes: int = 30
    degree: float = 8
    profile: str = "250k"  # of the radio
    protocol: Options = ()  # keys of [protocol]
    duration_s: float = 6.0  # of a run
    more: Options = ()  # other tables of the scenario, as (name, content)

    def __str__(self) -> str:
        """All of it in words."""
        words = [f"mesh n={self.nodes} degree={self.degree:g} {self.profile} {self.duration_s:g} s"]
        words += [f"{name}={value}" for name, value in (*self.protocol, *self.more)]
        return " ".join(words)

    def plan(self, seed: int) -> MeshPlan:
        """The plan of one network; nobody sends, nobody dies."""
        tables = {
            "kind": "mesh",
            "name": "papers",
            "seed": seed,
            "nodes": self.nodes,
            "gateway": GATEWAY,
            "duration_s": self.duration_s,
            "radio": {"profile": self.profile, "mean_degree": self.degree},
            "protocol": dict(self.protocol),
            **dict(self.more),
        }
        plan = scenarios.plan(scenarios.from_dict(tables))
        assert isinstance(plan, MeshPlan)
        return plan

    def run(self, seed: int) -> MeshResult:
        """Simulate the network of a seed to its end, compiled."""
        return simulate(self.plan(seed))

    def point(self, what: str, seeds: int, measure: Callable[..., Any], *args: Any) -> Point:
        """The point that measures so many seeds with `measure(testbed, *args, seed)`.

        Its key says `what` is measured with which arguments.
        """
        cost = 0.01 + 2e-4 * self.nodes * self.duration_s
        return Point.each(f"{what}: {self}", cost, seeds, measure, self, *args)


def dying(plan: MeshPlan, count: int, spared: Sequence[int] = (GATEWAY,)) -> list[int]:
    """Who dies: with one more death the same nodes and one more."""
    draw = stream(plan.seed, "papers/dying")
    free = [node for node in range(plan.nodes) if node not in spared]
    return [free.pop(draw.draw(len(free))) for _ in range(count)]


def kill(plan: MeshPlan, nodes: Sequence[int], at_us: int) -> None:
    """Have them die at that time."""
    plan.faults += [MeshFault(at_us, KILL, node, 0, 0, i) for i, node in enumerate(nodes)]
    plan.faults.sort(key=lambda fault: fault.at_us)


def correspondents(seed: int, nodes: Sequence[int]) -> dict[int, int]:
    """Whom every node writes to, always the same one; they write in the order of the keys."""
    draw = stream(seed, "papers/senders")
    left = list(nodes)
    order = [left.pop(draw.draw(len(left))) for _ in nodes]
    return {node: [n for n in nodes if n != node][draw.draw(len(nodes) - 1)] for node in order}


def send_rounds(
    plan: MeshPlan, nodes: Sequence[int], rounds: int, since_us: int, every_us: int
) -> None:
    """Every node sends to one other node of them, again in each round; rounds are flows.

    Sources follow each other in an order that is drawn, over three quarters of a round.
    """
    to, gap_us = correspondents(plan.seed, nodes), every_us * 3 // (4 * len(nodes))
    plan.offers += [
        Offer(since_us + k * every_us + i * gap_us, node, to[node], flags(plan), BYTES, k)
        for k in range(rounds)
        for i, node in enumerate(to)
    ]
    plan.offers.sort(key=lambda offer: offer.at_us)


def send_anywhere(plan: MeshPlan, from_s: int, until_s: int, every_s: int) -> None:
    """Every node sends to somebody drawn anew, at a drawn moment of each span."""
    draw = stream(plan.seed, "papers/senders")
    for since in range(from_s, until_s, every_s):
        for node in range(plan.nodes):
            dest = draw.draw(plan.nodes - 1)
            dest += dest >= node
            at = since * 1_000_000 + draw.draw(every_s * 1_000_000)
            plan.offers.append(Offer(at, node, dest, flags(plan), BYTES, 0))
    plan.offers.sort(key=lambda offer: offer.at_us)


def flags(plan: MeshPlan) -> int:
    """Of a message: whether it is acknowledged from end to end."""
    return END_TO_END if plan.params["reliable"] else 0
