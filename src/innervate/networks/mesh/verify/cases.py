"""What `innervate verify mesh` does: which networks, one after the other."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from innervate.networks.mesh.verify import model as mesh_model
from innervate.networks.mesh.verify import search as mesh_search
from innervate.networks.mesh.verify.model import MeshBudget, MeshModel
from innervate.verify.cases import budget_of
from innervate.verify.explore import MEMORY

# A message is tried twice in all, a hop once: what three transmissions can do to a hop, one can.
SHORT = (("e2e_tries", 1), ("transmissions", 1))
QUICK = (("period_s", 2.0), ("period_max_s", 2.0), ("dead_s", 3.0), ("dead_step_s", 1.0))
# Questions, each after a wait: all in vain before the next request could be missed.
ASKED = (("period_s", 6.0), ("period_max_s", 6.0), ("guard_s", 0.1))
DEATH_AND_ACK = MeshBudget(deaths=1, frames=0, acks=1)
LOST_ACK = MeshBudget(deaths=0, frames=0, acks=1)


@dataclass(frozen=True, slots=True)
class MeshWanted:
    """What was asked for (see `innervate verify --help`)."""

    failovers: tuple[str, ...] = ("search", "graph")
    links: tuple[tuple[int, int], ...] = ()
    budget: str = ""
    live: bool = True
    states: int = 0
    walks: int = 0
    seed: int = 1
    memory: int = MEMORY


def text_of(links: Any) -> str:
    """Pairs of nodes as "0-1 1-2"."""
    return " ".join(f"{a}-{b}" for a, b in links)


def models(wanted: MeshWanted) -> Iterator[tuple[str, MeshModel]]:
    """Everything that is asked for, in order."""
    line = wanted.links or mesh_model.parse("line")
    for failover in wanted.failovers:
        if failover == "random":
            how: dict[str, Any] = {"settings": SHORT, "reliable": False}
            budget = budget_of(wanted.budget, LOST_ACK)
            yield "two messages", MeshModel(line, failover, ((1, 0),) * 2, budget=budget, **how)
        else:
            yield from _messages(failover, wanted)
        if failover == "search":
            yield from _leaders(line, wanted)


def _messages(failover: str, wanted: MeshWanted) -> Iterator[tuple[str, MeshModel]]:
    """A message to the gateway, by a failover that keeps its promises."""
    shapes = ("line", "triangle", "square")
    for links in (wanted.links,) if wanted.links else map(mesh_model.parse, shapes):
        budget = budget_of(wanted.budget, DEATH_AND_ACK)
        far = ((max(b for _, b in links), 0),)
        yield "a message", MeshModel(links, failover, far, budget=budget, settings=SHORT)


def _leaders(
    links: tuple[tuple[int, int], ...], wanted: MeshWanted
) -> Iterator[tuple[str, MeshModel]]:
    """An alarm of the last node, and gateways that it stands by for."""
    last = max(b for _, b in links)
    asked: list[tuple[str, MeshBudget, dict[str, Any]]] = [
        ("an alarm", MeshBudget(0, 0, 0, 0), {"robot": last, "settings": SHORT}),
        ("gateways", MeshBudget(1, 1, 0, 0),
         {"standby": (last,), "settings": QUICK, "beats": 6}),
        ("gateways that are asked", MeshBudget(1, 0, 0, 0),
         {"standby": (last,), "settings": ASKED, "beats": 3}),
    ]  # fmt: skip
    for name, budget, how in asked:
        yield name, MeshModel(links, budget=budget_of(wanted.budget, budget), **how)


def run(model: MeshModel, wanted: MeshWanted, progress: mesh_search.Progress) -> mesh_search.Found:
    """Explore one model, or walk it at random, as is wanted; what came of it."""
    how: dict[str, Any] = {"live": wanted.live, "progress": progress}
    if wanted.walks:
        return mesh_search.wander(model, wanted.walks, seed=wanted.seed, **how)
    return mesh_search.explore(model, memory=wanted.memory, states=wanted.states, **how)
