"""Scenarios of a token ring, and their plans."""

from array import array
from typing import Annotated, Any, Literal, NamedTuple

from msgspec import Meta, Struct

from innervate.scenario.actions import cables
from innervate.topology.graph import Graph

PORTS = 4
WEST, EAST = 0, 1


class Event(Struct, frozen=True, forbid_unknown_fields=True):
    """Something that happens to the cable from a node to the next."""

    at_s: float
    action: Literal["cut", "restore"]
    node: int


class RingScenario(Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A ring of nodes."""

    kind: Literal["ring"]
    name: str = ""
    duration_s: float = 4.0
    seed: int = 1
    nodes: Annotated[int, Meta(ge=3)] = 4
    hold_us: int = 1000
    lost_us: int = 200_000
    event: list[Event] = []


class Fault(NamedTuple):
    """An event of the plan."""

    at_us: int
    action: int
    end: int
    node: int
    index: int


class Plan(NamedTuple):
    """What is run."""

    kind: str
    scenario: Any
    graph: Graph
    params: dict[str, int]
    faults: list[Fault]


def check(source, model):
    """Everything that is in its range will do."""


def plan(scenario):
    """The plan of a scenario."""
    model = scenario.model
    graph = Graph(model.nodes, 0, array("i", [-1]) * (PORTS * model.nodes))
    for node in range(model.nodes):
        graph.connect(PORTS * node + EAST, PORTS * ((node + 1) % model.nodes) + WEST)
    params = {"hold_us": model.hold_us, "lost_us": model.lost_us, "silent_us": 4 * model.lost_us}
    actions = {"cut": cables.CUT, "restore": cables.RESTORE}
    faults = [
        Fault(round(1e6 * event.at_s), actions[event.action], PORTS * event.node + EAST, -1, i)
        for i, event in enumerate(model.event)
    ]
    return Plan("ring", scenario, graph, params, faults)
