"""A story of a declared protocol as a scenario, whose [script] is played in place of the clock.

A step of a script is what a story says of an event, but for what it changed: "n1 gets a frame from
n0 E, n1 draws 3 out of 8". Times cannot say it: a story lets any time pass between two nodes.
"""

import re
from collections.abc import Iterator
from typing import Any

from innervate.network import Network
from innervate.scenario.declared.cables import CablesScenario
from innervate.scenario.declared.channel import ChannelScenario
from innervate.scenario.declared.field import FieldScenario
from innervate.scenario.emit import inline, to_toml
from innervate.topology import Graph
from innervate.verify.cases import Story
from innervate.verify.net import SWITCHED_ON, Net
from innervate.verify.standing import wrong_of
from innervate.verify.states import Budget, State, Step, happen, is_still

STUCK = "nothing can happen any more: no timer is set, no frame is on its way"
MODELS = (CablesScenario, ChannelScenario, FieldScenario)
DRAWN = re.compile(r"(\d+) out of [\d,]+")
NAMED = 4  # of what can happen in place of a step


class Unplayable(Exception):
    """A step that cannot be: its place, and why."""

    def __init__(self, place: int, why: str) -> None:
        super().__init__(why)
        self.place = place


def scenario_of(network: Network, net: Net, story: Story) -> str:
    """The text of a scenario that plays a story; "" for scenarios with keys of their own."""
    if getattr(network, "model", None) not in MODELS:
        return ""
    graph = net.graph
    cables = cables_of(graph)
    head = "".join(f"# {line}\n" for line in story.lines())
    tables: dict[str, Any] = {"kind": network.name, "name": "counterexample"}
    if network.model is CablesScenario:
        tables["cables"] = cables
    else:
        tables["nodes"] = graph.cells
        near = {tuple(sorted((graph.node_of(a), graph.node_of(b)))) for a, b in graph.links()}
        if network.model is FieldScenario:
            tables["link"] = [{"nodes": list(pair)} for pair in sorted(near)]
        else:
            tables["hidden"] = [[a, b] for b in range(graph.cells) for a in range(b)
                                if (a, b) not in near]  # fmt: skip
    tables["protocol"] = {name: getattr(net.params, name) for name, *_ in network.fields.PARAMS}
    if network.model is not CablesScenario:
        tables["script"] = {"graph": " ".join(cables)}
    steps = [f"  {inline(event)}," for event in story.events]
    section = [] if "script" in tables else ["", "[script]"]
    return head + to_toml(tables) + "\n".join([*section, "steps = [", *steps, "]", ""])


def cables_of(graph: Graph) -> list[str]:
    """Cables in words, in an order in which nodes are named by their numbers."""

    def newest(link: tuple[int, int]) -> tuple[int, int]:
        one, other = sorted(map(graph.node_of, link))
        return other, -one

    links = sorted(graph.links(), key=newest)
    return [f"{end_words(graph, a)}-{end_words(graph, b)}" for a, b in links]


def end_words(graph: Graph, end: int) -> str:
    """An end as cables are written: "n0.E"."""
    return ".".join(graph.label_end(end).rsplit(" ", 1))


def played(net: Net, steps: list[str]) -> Iterator[tuple[State, Step]]:
    """What each step of a script leads to, and from what; the last is broken, if anything is.

    First comes how all nodes are switched on, which is a step if something was drawn.

    Raises:
        Unplayable: what a step says cannot happen there.
    """
    budget = Budget(*(len(steps),) * 3)
    first = begins(steps)
    waits = bool(net.given) and all(is_still(one.state) for one in net.begins(budget))
    step = net.draws.again(drawn_of(steps[0]) if first else (), net.begin, budget)
    yield step.state, looked_at(net, step, waits)
    for place, text in enumerate(steps[first:], first):
        state = step.state
        moves = list(net.moves(state))
        move = next((one for one in moves if f"{text}, ".startswith(f"{one.words}, ")), None)
        if move is None:
            raise Unplayable(place, f'"{text[:80]}" cannot happen here; {can(moves)}')
        step = net.draws.again(drawn_of(text), happen, move)
        if step.words != text:
            raise Unplayable(place, f'"{text[:80]}" is now "{step.words[:80]}"')
        yield state, looked_at(net, step, waits)


def begins(steps: list[str]) -> int:
    """1 if the first step is how nodes are switched on."""
    return int(bool(steps) and SWITCHED_ON in steps[0])


def looked_at(net: Net, step: Step, waits: bool) -> Step:
    """A step with what is broken after it, as an exploration finds it."""
    broken = step.broken or wrong_of(net, step.state)
    if not broken and not waits and is_still(step.state):
        broken = STUCK
    return step._replace(broken=broken)


def drawn_of(text: str) -> tuple[int, ...]:
    """What nodes draw in a step."""
    return tuple(map(int, DRAWN.findall(text)))


def can(moves: Any) -> str:
    """What can happen, in words."""
    if not moves:
        return "nothing can"
    named = ", ".join(f'"{one.words}"' for one in moves[:NAMED])
    more = f" and {len(moves) - NAMED} more" if len(moves) > NAMED else ""
    return f"what can: {named}{more}"
