"""What `innervate verify mesh` does: which networks, one after the other."""

from collections.abc import Iterator
from dataclasses import asdict, dataclass
from typing import Any

from innervate.networks.mesh.verify import model as mesh_model
from innervate.networks.mesh.verify import search as mesh_search
from innervate.networks.mesh.verify import story as mesh_story
from innervate.networks.mesh.verify.model import MeshBudget, MeshModel
from innervate.networks.mesh.verify.search import Found
from innervate.verify.cases import budget_of as budget_of
from innervate.verify.explore import MEMORY
from innervate.verify.tally import Tally

# A message is tried twice in all, a hop once: what three transmissions can do to a hop, one can.
SHORT = (("e2e_tries", 1), ("transmissions", 1))
QUICK = (("period_s", 2.0), ("period_max_s", 2.0), ("dead_s", 3.0), ("dead_step_s", 1.0))
# Questions, each after a wait: all in vain before the next request could be missed.
ASKED = (("period_s", 6.0), ("period_max_s", 6.0), ("guard_s", 0.1))
DEATH_AND_ACK = MeshBudget(deaths=1, frames=0, acks=1)
LOST_ACK = MeshBudget(deaths=0, frames=0, acks=1)


@dataclass(slots=True)
class MeshCase:
    """One exploration and what came of it."""

    name: str  # what is explored, in words
    found: Found  # what came of it
    story: mesh_story.MeshStory | None = None  # the counterexample, if something is broken

    def as_dict(self) -> dict[str, Any]:
        """The case as `innervate verify mesh --json` prints it."""
        model, tally, found = self.found.model, self.found.tally, self.found
        return {
            "name": self.name,
            "links": text_of(model.links),
            "failover": model.failover,
            "budget": asdict(model.budget),
            **{name: getattr(tally, name) for name in ("states", "expanded", "generated")},
            "calls": found.calls,
            "node_states": len(found.nets.locals.states),
            "depth": tally.depth,
            "wall_s": round(tally.wall_s, 3),
            "ended": tally.ended,
            "fair": found.fair,
            "longest": found.longest,
            "one_value": found.wide,
            "broken": self.story.title if self.story else None,
            "story": self.story.sentences if self.story else None,
        }


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
    for failover in wanted.failovers:
        if failover == "random":
            links = wanted.links or mesh_model.parse("line")
            budget = budget_of(wanted.budget, LOST_ACK)
            two = ((1, 0), (1, 0))
            yield (
                "two messages",
                MeshModel(links, failover, two, budget=budget, settings=SHORT, reliable=False),
            )
        else:
            yield from _own(failover, wanted)


def _own(failover: str, wanted: MeshWanted) -> Iterator[tuple[str, MeshModel]]:
    """What is asked of a failover that keeps its promises."""
    shapes = ("line", "triangle", "square")
    for links in (wanted.links,) if wanted.links else map(mesh_model.parse, shapes):
        budget = budget_of(wanted.budget, DEATH_AND_ACK)
        far = ((max(b for _, b in links), 0),)
        yield "a message", MeshModel(links, failover, far, budget=budget, settings=SHORT)
    if failover == "search":
        links = wanted.links or mesh_model.parse("line")
        budget = budget_of(wanted.budget, MeshBudget(0, 0, 0, 0))
        last = max(b for _, b in links)
        yield "an alarm", MeshModel(links, failover, (), last, budget=budget, settings=SHORT)
        budget = budget_of(wanted.budget, MeshBudget(1, 1, 0, 0))
        yield (
            "gateways",
            MeshModel(links, failover, (), standby=(last,), budget=budget, settings=QUICK, beats=6),
        )
        budget = budget_of(wanted.budget, MeshBudget(1, 0, 0, 0))
        yield (
            "gateways that are asked",
            MeshModel(links, failover, (), standby=(last,), budget=budget, settings=ASKED, beats=3),
        )


def run(name: str, model: MeshModel, wanted: MeshWanted, progress: Any) -> MeshCase:
    """Explore one model, or walk it at random, as is wanted; what came of it."""

    def tell(tally: Tally) -> bool:
        return bool(progress(f"{text_of(model.links)}, {model.failover}, {name}", tally))

    if wanted.walks:
        found = mesh_search.wander(
            model, wanted.walks, seed=wanted.seed, live=wanted.live, progress=tell
        )
    else:
        found = mesh_search.explore(
            model, memory=wanted.memory, states=wanted.states, live=wanted.live, progress=tell
        )
    return MeshCase(name, found, mesh_story.tell(found) if found.broken else None)
