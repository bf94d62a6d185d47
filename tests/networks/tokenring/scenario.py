"""Scenarios of a token ring, and their plans."""

from array import array
from typing import Literal

from msgspec import Struct

from innervate.scenario.actions.cables import ACTIONS
from innervate.scenario.cables import CablesPlan, Fault, Input
from innervate.topology.graph import Graph

PORTS, WEST, EAST = 4, 0, 1


class Event(Struct, frozen=True, forbid_unknown_fields=True):
    """Something that happens to a node, or to the cable from it to the next."""

    at_s: float
    action: str
    node: int


class RingScenario(Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A ring of nodes."""

    kind: Literal["tokenring"]
    schema: int = 1
    name: str = "ring"
    duration_s: float = 0.5
    seed: int = 1
    nodes: int = 4
    hold_us: int = 1000
    lost_us: int = 20_000
    loads: bool = False
    event: list[Event] = []


def check(source, model):
    """Everything that is in its range will do."""


def plan(scenario):
    """The plan of a scenario."""
    model = scenario.model
    names = tuple(f"n{node}" for node in range(model.nodes))
    graph = Graph(model.nodes, 0, array("i", [-1]) * (PORTS * model.nodes), names=names)
    for node in range(model.nodes):
        graph.connect(PORTS * node + EAST, PORTS * ((node + 1) % model.nodes) + WEST)
    faults = []
    for index, event in enumerate(model.event):
        action = ACTIONS.index(event.action)
        on_cable = event.action in ("cut", "restore", "loose", "lose")
        end, node = (PORTS * event.node + EAST, -1) if on_cable else (-1, event.node)
        loss = 16_384 if event.action == "loose" else 0
        at_us = round(1e6 * event.at_s)
        faults.append(Fault(at_us, action, end, node, loss, int(event.action == "lose"), index))
    inputs = [Input(1000 + 100 * n, n, 1, {"load": (n, 7)}) for n in range(model.nodes)]
    return CablesPlan(
        scenario=scenario,
        graph=graph,
        kind="tokenring",
        seed=model.seed,
        duration_us=round(1e6 * model.duration_s),
        params={"hold_us": model.hold_us, "lost_us": model.lost_us},
        drift_ppm=30,
        faults=faults,
        inputs=inputs if model.loads else [],
    )
