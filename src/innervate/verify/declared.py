"""Every order of a few nodes' events, for any network over cables that declares its protocol.

The protocol's parameters are those of its EXPLORED (or of EXPLORED or DEFAULTS of its `fields`), or
else the least of their ranges. What nodes are handed is GIVEN of `fields`: (kind, item), ...
What holds of any protocol is checked after every handler call: all fields in their declared range,
room in the outbox, no handler that cannot go on; and of every state, that something can still
happen (a timer is set, or a frame is on its way). A network's own `invariants` are looked at, too.
What nodes draw is tried in every way, as far as draws.py says.
"""

from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from inspect import signature
from typing import Any

from innervate.folders import MEDIA_ON_AIR, invariants_of
from innervate.kernel.clock import wall_s
from innervate.kernel.words import number_of
from innervate.network import Network
from innervate.topology import Graph
from innervate.verify import cases
from innervate.verify.cases import Case, Explore, Story, Tell, budget_of, extent, lines_of, only
from innervate.verify.frames import frames_of
from innervate.verify.graphs import GRAPHS, graph_of
from innervate.verify.net import Net
from innervate.verify.readings import Readings
from innervate.verify.scripts import STUCK, scenario_of
from innervate.verify.standing import wrong_of
from innervate.verify.states import Budget, State, is_still, most_frames
from innervate.verify.tally import Tally
from innervate.verify.telling import past_words, story_of

IN_FLIGHT = 3  # most frames on a cable per direction; states with more are left out, and counted
STATES = 20_000
BATCH = 500


def explore(net: Net, budget: Budget, limit: int, tell: Tell, name: str) -> tuple[Tally, Story]:
    """All states breadth first, up to `limit`; the story has no title if nothing is broken."""
    started, tally = wall_s(), Tally(states=1)
    before: dict[State, tuple[State | None, str] | None] = {}
    for first in net.begins(budget):
        if broken := first.broken or wrong_of(net, first.state):
            told = Story(broken, [f"{first.words}."], events=[first.words])
            return replace(tally, ended="broken"), told
        before.setdefault(first.state, (None, first.words) if net.draws.made else None)
    level = list(before)
    waits = bool(net.given) and all(map(is_still, level))  # for its user, from the start on
    while level:
        fresh: list[State] = []
        for state in level:
            steps = list(net.steps(state))
            tally.expanded += 1
            tally.generated += len(steps)
            if not waits and is_still(state):
                return replace(tally, ended="broken"), story_of(net, before, state, STUCK)
            for step in steps:
                if broken := step.broken or wrong_of(net, step.state):
                    told = story_of(net, before, state, broken, step)
                    return replace(tally, ended="broken"), told
                if most_frames(step.state) > IN_FLIGHT:
                    tally.left_out += 1
                elif step.state not in before:
                    before[step.state] = (state, step.words)
                    fresh.append(step.state)
            tally.states, tally.wall_s = len(before), wall_s() - started
            what = f"{name}: {tally.states:,} states, {tally.depth} events deep"
            if tally.expanded % BATCH == 0 and tell(what, 0, 0):
                return tally, Story("")
            if tally.states >= limit:
                return replace(tally, ended="limit"), Story("")
        level = fresh
        tally.depth += bool(fresh)
    return replace(tally, ended="complete"), Story("")


def explorations(network: Network, options: Any) -> Iterator[Explore]:
    """All that the options of the command line ask for."""
    only(network.name, options, "graph", "budget")
    budget = budget_of(options.budget, Budget())
    names = list(GRAPHS) if options.graph == "all" else [options.graph]
    graphs = [graph_of(name) for name in names]
    return (partial(_explore, network, options, graph, budget) for graph in graphs)


def net_of(network: Network, graph: Graph, params: dict[str, int], kind: type[Net] = Net) -> Net:
    """How the states of a network's nodes follow each other."""
    net = kind(network.protocol, network.fields, graph, params)
    net.on_air = network.medium in MEDIA_ON_AIR
    net.has_carrier &= net.on_air
    net.is_slotted = network.medium == "channel"
    net.is_addressed = network.medium == "field" and hasattr(net.frame, "to")
    net.frames = frames_of(network)
    net.own = invariants_of(network, "node_")
    net.of_all = {
        title: _with_cables(holds, graph)
        for title, holds in invariants_of(network, "network_").items()
    }
    return net


def _with_cables(holds: Any, graph: Graph) -> Any:
    """An invariant of all nodes; one with a fourth argument is given the graph's ends, too."""
    if len(signature(holds).parameters) < 4:
        return holds
    return lambda *given: holds(*given, graph.peer)


def hearing(graph: Graph) -> str:
    """Who hears whom, of nodes on the air: "n0 - n1, n1 - n2"."""
    pairs = {tuple(sorted(map(graph.node_of, link))) for link in graph.links()}
    return ", ".join(f"{graph.label(a)} - {graph.label(b)}" for a, b in sorted(pairs))


def _explore(network: Network, options: Any, graph: Graph, budget: Budget, tell: Tell) -> Case:
    params = {**getattr(network.fields, "DEFAULTS", {}),
              **getattr(network.fields, "EXPLORED", {}),
              **getattr(network.protocol, "EXPLORED", {})}  # fmt: skip
    net = net_of(network, graph, params)
    net.readings = readings = Readings(net)
    cables = " ".join(f"{graph.label_end(a)}-{graph.label_end(b)}" for a, b in graph.links())
    shown = hearing(graph) if net.on_air else cables
    tally, story = explore(net, budget, options.states or STATES, tell, shown)
    head = f"{shown:40} {cases.many(tally)}"
    told = story if story.title else None
    if told is not None:
        told.scenario = scenario_of(network, net, told)

    def how_far() -> str:
        more = f" but {number_of(tally.left_out, 'successor')} with too many frames in flight"
        said = extent(tally) + (more if tally.left_out else "")
        return said + net.draws.words() + readings.words() + past_words(net.past)

    names = ("states", "expanded", "generated", "left_out", "depth", "ended")
    return Case(
        lines=lines_of(f"{head} {tally.wall_s:7.1f} s", told, how_far),
        record={"graph": cables, **{name: getattr(tally, name) for name in names},
                "draws": net.draws.as_dict(), "readings": sorted(readings.apart),
                "past": [[*setter, us] for setter, us in net.past.items()],
                "broken": story.title or None, "story": story.sentences or None},
        is_broken=told is not None,
        is_complete=tally.ended == "complete" and not (
            tally.left_out or net.draws.some or readings.apart),
        story=told,
        stem=f"{network.name}-counterexample",
    )  # fmt: skip
