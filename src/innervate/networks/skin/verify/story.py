"""A counterexample in plain sentences, as a scenario that runs, and as what a drawing needs.

The search keeps one of several mirror images of each state and leaves idle beacons out. The
story is told of a network without either: every event is looked up again, and what it takes in is
delivered frame by frame.
"""

from dataclasses import dataclass, field
from typing import Any

from innervate.kernel.words import number_of
from innervate.networks.skin.protocol.constants import NONE
from innervate.networks.skin.verify import check as skin_check
from innervate.networks.skin.verify import system as skin_system
from innervate.networks.skin.verify import world as w
from innervate.networks.skin.verify.narrator import Narrator, Scene
from innervate.topology import Graph
from innervate.verify import cases as common
from innervate.verify.explore import Result
from innervate.verify.twin import Twin, find

ROOM = 40  # frames in flight per direction

TITLES = {
    w.BROKEN_LOOP: "closed loop",
    w.BROKEN_ORDER: "a feasible distance is not worse than that of the parent",
    w.BROKEN_WORSE: "a feasible distance got worse without being forgotten",
    w.BROKEN_RANGE: "a value is out of its declared range",
    w.BROKEN_OUTBOX: "an outbox overflowed",
}


@dataclass(kw_only=True)
class Story(common.Story):
    """How something breaks in a skin."""

    graph: Graph  # the network
    # for each event the script's steps that play it
    steps: list[list[str]] = field(default_factory=list)
    scenes: list[Scene] = field(default_factory=list)  # the network after each event
    # nodes of the closed ring in order, if there is one
    ring: list[int] = field(default_factory=list)


def tell(result: Result, system: Any = None) -> Story:
    """The story of what a search found broken."""
    system = system or skin_system.system_of()
    found = Twin(result.model, system)
    real = Twin(
        result.model.changed(
            merge=False, symmetric=False, keep=True, unreduced=True, capacity=ROOM
        ),
        system,
    )
    story = Story("", graph=result.model.graph)
    narrator = Narrator(real, story)
    for target in [*result.path[1:], None]:
        here = found.row()
        event = find(found, target, result.broken)
        after = found.row()
        found.put(here)
        narrator.play(found, event)
        found.put(after)
    story.ring = _ring(real)
    ring = [story.graph.label(node) for node in [*story.ring, *story.ring[:1]]]
    story.title = f"closed loop {' -> '.join(ring)}" if ring else TITLES[result.broken]
    story.scenario = _scenario(result.model, story)
    return story


def in_short(result: Result) -> Story:
    """What is broken, where there was no room for the search that the story needs."""
    events = number_of(len(result.path), "event")
    title = f"{TITLES[result.broken]}, after {events} or a few more"
    return Story(title, graph=result.model.graph)


def _ring(twin: Twin) -> list[int]:
    """The closed ring of parents, or nothing."""
    sink = twin.model.graph.sink
    for start in range(sink):
        path, node = [], start
        while node not in (NONE, sink) and node not in path:
            path.append(node)
            node = skin_check.next_hop(twin.world, node)
        if node == start:
            return path
    return []


def _scenario(model: Any, story: Story) -> str:
    """A scenario file that plays the story with `innervate run`."""
    graph = model.graph
    lines = [f"# {line}" for line in story.lines()]
    hold = skin_system.hold_periods(model)
    if model.budget.ticks >= hold:
        lines.append(f"# Found with feasible distances that are forgotten after {hold} periods")
        lines.append("# without a route; a run keeps them for 129 or more, and may end otherwise.")
    lines += ['kind = "skin"', 'name = "counterexample"', "duration_s = 1.0", ""]
    for a, b in graph.links():
        ends = [f"{graph.label(graph.node_of(end))}.{graph.port_of(end)}" for end in (a, b)]
        lines += ["[[link]]", f'a = "{ends[0]}"', f'b = "{ends[1]}"', ""]
    lines += [
        "[protocol]", f'rule = "{model.rule}"', f'updates = "{model.updates}"', "k = 1", "m = 1",
        "gap_us = 1000000  # nothing but a step lets time pass", "balancing = false", "",
        "[script]", "keepalive = true", "steps = [", '  "tick pc",  # it has listened for a period',
    ]  # fmt: skip
    for number, steps in enumerate(story.steps, 1):
        lines.append("  " + " ".join(f'"{step}",' for step in steps) + f"  # {number}")
    return "\n".join([*lines, "]", ""])
