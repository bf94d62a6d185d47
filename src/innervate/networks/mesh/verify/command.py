"""What `innervate verify mesh` does: messages, alarms and gateways, on a few nodes."""

from collections.abc import Iterator
from dataclasses import asdict, dataclass
from functools import partial
from typing import Any

from innervate.kernel.words import number_of
from innervate.networks.mesh.verify import replay, search
from innervate.networks.mesh.verify.model import (
    ASKED,
    DOCUMENTS,
    FAILOVERS,
    QUICK,
    SHORT,
    MeshBudget,
    MeshModel,
    parse,
    text_of,
)
from innervate.networks.mesh.verify.mutants import MUTANTS, hunt
from innervate.networks.mesh.verify.search import Found
from innervate.networks.mesh.verify.shape import FEW
from innervate.networks.mesh.verify.story import tell as story_of
from innervate.verify import cases as common
from innervate.verify.cases import Case, Explore, Tell
from innervate.verify.errors import VerifyError
from innervate.verify.explore import MEMORY
from innervate.verify.tally import Tally

__all__ = ["MUTANTS", "hunt"]

NAME_WIDE = 12  # characters of the column of names, at least
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


def wanted_of(options: Any) -> MeshWanted:
    """What the options of the command line ask for."""
    common.only("mesh", options, "rule", "graph", "budget", "walks")
    known, rule = FAILOVERS, options.rule
    if rule and rule not in (*known, "all"):
        raise VerifyError(
            f'--rule is a failover for a mesh, {", ".join(known)} or all, not "{rule[:40]}"'
        )
    usual = MeshWanted()
    links = () if options.graph == "all" else parse(options.graph)
    common.budget_of(options.budget, MeshBudget())  # says now what is wrong with it
    return MeshWanted(
        failovers=usual.failovers if not rule else known if rule == "all" else (rule,),
        links=links,
        budget=options.budget,
        live=options.liveness,
        states=options.states,
        walks=options.walks,
        seed=options.seed or 1,
        memory=common.bytes_of(options.memory),
    )


def explorations(_network: Any, options: Any) -> Iterator[Explore]:
    """All that the options of the command line ask for."""
    wanted = wanted_of(options)
    asked = list(models(wanted))
    wide = max(NAME_WIDE, *(len(name) for name, _ in asked))
    return (partial(_explore, name, model, wanted, wide=wide) for name, model in asked)


def models(wanted: MeshWanted) -> Iterator[tuple[str, MeshModel]]:
    """Everything that is asked for, in order."""
    line = wanted.links or parse("line")
    for failover in wanted.failovers:
        if failover in DOCUMENTS:
            how: dict[str, Any] = {"settings": SHORT, "reliable": False}
            budget = common.budget_of(wanted.budget, LOST_ACK)
            yield "two messages", MeshModel(line, failover, ((1, 0),) * 2, budget=budget, **how)
        else:
            yield from _messages(failover, wanted)
        if failover == "search":
            yield from _leaders(line, wanted)


def _messages(failover: str, wanted: MeshWanted) -> Iterator[tuple[str, MeshModel]]:
    """A message to the gateway, by a failover that keeps its promises."""
    shapes = ("line", "triangle", "square")
    for links in (wanted.links,) if wanted.links else map(parse, shapes):
        budget = common.budget_of(wanted.budget, DEATH_AND_ACK)
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
        yield name, MeshModel(links, budget=common.budget_of(wanted.budget, budget), **how)


def run(model: MeshModel, wanted: MeshWanted, progress: search.Progress) -> search.Found:
    """Explore one model, or walk it at random, as is wanted; what came of it."""
    how: dict[str, Any] = {"live": wanted.live, "progress": progress}
    if wanted.walks:
        return search.wander(model, wanted.walks, seed=wanted.seed, **how)
    return search.explore(model, memory=wanted.memory, states=wanted.states, **how)


def _explore(name: str, model: Any, wanted: MeshWanted, tell: Tell, wide: int = NAME_WIDE) -> Case:
    links = text_of(model.links)

    def progress(tally: Tally) -> bool:
        what = f"{links}, {model.failover}, {name}: {tally.states:,} states"
        return tell(f"{what}, {tally.depth} events deep, {tally.per_s / 1e3:.0f} k/s", 0, 0)

    found = run(model, wanted, progress)
    tally, story = found.tally, story_of(found) if found.broken else None
    head = f"{links:24} {model.failover:9} {name:{wide}}{common.many(tally)} {tally.wall_s:7.1f} s"
    return Case(
        lines=common.lines_of(head, story, partial(_extent, found)),
        record=_record(name, found, story),
        is_broken=story is not None,
        is_complete=tally.ended == "complete",
        but=_but(found),
        story=story,
        play=None if story is None else partial(replay.write, story),
        stem="mesh-counterexample",
    )


def _record(name: str, found: Found, story: Any) -> dict[str, Any]:
    """One exploration as `innervate verify mesh --json` prints it."""
    model, tally = found.model, found.tally
    return {
        "name": name,
        "links": text_of(model.links),
        "failover": model.failover,
        "budget": asdict(model.budget),
        **{key: getattr(tally, key) for key in ("states", "expanded", "generated")},
        "calls": found.calls,
        "node_states": len(found.nets.locals.states),
        "depth": tally.depth,
        "wall_s": round(tally.wall_s, 3),
        "ended": tally.ended,
        "fair": found.fair,
        "longest": found.longest,
        "one_value": found.wide,
        "broken": story.title if story else None,
        "story": story.sentences if story else None,
    }


def _but(found: Found) -> str:
    """What was not looked at in all that was; "" nothing."""
    if found.tally.ended == "walked" or not found.wide:
        return ""
    return f"with one value for each node's draws out of more than {FEW}"


def _extent(found: Found) -> str:
    words = common.extent(found.tally)
    if but := _but(found):
        words += f", {but}"
    if not found.fair:
        return words
    part = "" if found.fair >= found.tally.states else f" from {found.fair:,} of them"
    if found.model.beats:
        return f"{words}; one gateway{part} after {found.longest / 1e6:.1f} s at most"
    return f"{words}; settled{part} in {number_of(found.longest, 'event')} at most"
