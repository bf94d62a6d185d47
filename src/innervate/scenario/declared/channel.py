"""Scenarios of any network on a shared channel that has no keys of its own, and their plans.

Built in code they are the same: `ChannelScenario(kind="aloha", nodes=5)`.
"""

from dataclasses import dataclass, field
from typing import Annotated, Any, Literal

from msgspec import Meta

from innervate.folders import CHANNEL_OWN
from innervate.network import networks
from innervate.scenario.actions.channel import ACTIONS, FADE, GARBLE, WORDS
from innervate.scenario.cables import LOSS_ONE, Input
from innervate.scenario.declared import shared
from innervate.scenario.declared.foreseen import warnings
from innervate.scenario.declared.offered import offered
from innervate.scenario.events import opening, told
from innervate.scenario.keys import Micros, Table, number, whole
from innervate.scenario.source import Source

NODES_MAX = 1_000
DONE = ("join", "kill", "revive")  # what can be done to any node on a channel


class AirTable(Table, frozen=True, kw_only=True):
    """The channel.

    Attributes:
        slot_us: the unit of a frame's length, us: a frame takes `frame.slots` of them.
        turnaround_us: from the decision to send to the first sound, and back to hearing, us.
        delay_us: between any two nodes, us.
        loss: share of frames that a receiver cannot read though it heard them alone, 0 to 1.
    """

    slot_us: Annotated[int, whole("microseconds", 1, 100_000)] = 100
    turnaround_us: Micros = 20
    delay_us: Annotated[int, whole("microseconds", 1, 10_000)] = 1
    loss: Annotated[float, number("frames lost", 0, 1)] = 0.0


class EventTable(Table, frozen=True, kw_only=True):
    """What happens to a node.

    Attributes:
        at_s: when, s.
        action: kill, revive or join; or a word of the network's own.
        node: its number.
        value: of the network's own actions: a number for them.
    """

    at_s: Annotated[float, number("seconds", 0)]
    action: str
    node: Annotated[int, whole("", 0)]
    value: int = 0


class ChannelScenario(shared.Declared, frozen=True, kw_only=True):
    """A network on a shared channel.

    Attributes:
        kind: the network's name.
        nodes: how many there are.
        hidden: pairs of nodes that do not hear each other.
        absent: nodes that are off until they join.
        duration_s: simulated time, s.
        air: the channel.
        protocol: parameters of the protocol, by name.
        input: what nodes are given by their users, in any order.
        event: what happens to nodes and between them, in any order.
        script: an order of events in place of the clock.
    """

    nodes: Annotated[int, whole("nodes", 2, NODES_MAX)] = 4
    hidden: list[tuple[int, int]] = []  # noqa: RUF012
    absent: list[int] = []  # noqa: RUF012
    air: AirTable = AirTable()
    protocol: dict[str, int] = {}  # noqa: RUF012
    input: Annotated[list[shared.InputTable], Meta(max_length=10_000)] = []  # noqa: RUF012
    event: Annotated[list[EventTable], Meta(max_length=100_000)] = []  # noqa: RUF012
    script: shared.ScriptTable | None = None


@dataclass(frozen=True, slots=True)
class Fault:
    """One event of a run on a channel."""

    at_us: int  # when, true time, us
    action: int  # of `actions/channel`
    node: int  # the station it happens to
    value: int = 0  # for GARBLE and FADE how many of its next CR-Rs
    index: int = 0  # the event's place in the scenario file


@dataclass(slots=True)
class ChannelPlan:
    """Everything a run on a channel needs, as whole numbers."""

    scenario: Any
    kind: str
    seed: int
    duration_us: int
    stations: int  # how many
    params: dict[str, int]  # of the protocol, by name, and those of the medium
    delays_us: list[list[int]]  # per sender and receiver; -1 = they do not hear each other
    loss_q15: int
    arrivals: list[list[int]]  # per station, the moments of its inputs
    inputs: list[Input]  # all of them, station by station, each in order of time
    absent: list[int]  # per station, 1 = off until it joins
    faults: list[Fault] = field(default_factory=list)  # in order of time
    sizes: list[list[int]] = field(default_factory=list)
    saturated: Literal[False] = False
    forced: Literal[False] = False
    wanted: Literal[0] = 0

    @property
    def nodes(self) -> int:
        """How many nodes there are, as over cables."""
        return self.stations


def check(source: Source, model: ChannelScenario) -> None:
    """Everything that single keys do not show.

    Raises:
        ScenarioError: the first thing that cannot be.
    """
    for place, one in enumerate(model.hidden):
        for node in one:
            shared.check_node(source, ("hidden", place), node, model.nodes)
    shared.check(source, model, model.nodes, DONE)


def plan(scenario: Any) -> ChannelPlan:
    """The plan of a scenario.

    Raises:
        ScenarioError: more inputs than can be held.
    """
    model, network = scenario.model, networks()[scenario.model.kind]
    count, air = model.nodes, model.air
    given = shared.inputs_of(model, network, count, DONE)
    by_node = [[one for one in given if one.node == node] for node in range(count)]
    delays = [[0 if a == b else air.delay_us for b in range(count)] for a in range(count)]
    for a, b in model.hidden:
        delays[a][b] = delays[b][a] = -1
    medium = dict(zip(CHANNEL_OWN, (air.slot_us, air.turnaround_us, 0, 0, 0, 1), strict=True))
    faults = [Fault(round(1e6 * event.at_s), WORDS[event.action], event.node, index=place)
              for place, event in enumerate(model.event) if event.action in DONE]  # fmt: skip
    return ChannelPlan(
        scenario=scenario,
        kind=model.kind,
        seed=model.seed,
        duration_us=round(1e6 * model.duration_s),
        stations=count,
        params={**medium, **shared.parameters(network.fields, model.protocol)},
        delays_us=delays,
        loss_q15=round(air.loss * LOSS_ONE),
        arrivals=[[one.at_us for one in some] for some in by_node],
        inputs=[one for some in by_node for one in some],
        absent=[int(node in model.absent) for node in range(count)],
        faults=sorted(faults, key=lambda fault: (fault.at_us, fault.index)),
        sizes=[[1]] * count,
    )


def describe(plan: Any) -> str:
    """A plan in words, several lines, without a newline at the end."""
    own = [name for name, *_ in networks()[plan.kind].fields.PARAMS]
    params = ", ".join(f"{name} {plan.params[name]}" for name in own)
    hidden = sum(row.count(-1) for row in plan.delays_us) // 2
    apart = f", {hidden} pairs hidden from each other" if hidden else ""
    lines = [
        opening(plan),
        f"  nodes      {plan.stations:,} on a channel, {plan.params['slot_us']} us a slot{apart}",
        f"  protocol   {params}",
    ]
    found = ["nobody can read any frame: air.loss is 1"] if plan.loss_q15 >= LOSS_ONE else []
    found += warnings(plan, _near(plan))
    own = shared.own_lines(plan)
    return "\n".join([*lines, *shared.script_lines(plan), *told(plan, fault_words, found, own)])


def _near(plan: ChannelPlan) -> list[tuple[int, int]]:
    """Pairs that hear each other."""
    return [(a, b) for a, row in enumerate(plan.delays_us) for b in range(a) if row[b] >= 0]


def fault_words(plan: Any, fault: Any) -> str:
    """A fault in words: "at 2 s kill node 3"."""
    assert fault.action not in (GARBLE, FADE)
    return f"at {fault.at_us / 1e6:g} s {ACTIONS[fault.action]} node {fault.node}"


def event(plan: Any, fault: Any) -> dict[str, Any]:
    """The [[event]] table of a fault, without its time."""
    return {"action": ACTIONS[fault.action], "node": fault.node}


def template(network: Any) -> str:
    """A scenario to start from, with all parameters; "" for a network with keys of its own."""
    settings = ("nodes = 6", "duration_s = 1.0", "", "[air]", "slot_us = 100", "turnaround_us = 20")
    made = shared.template(network, ChannelScenario, "on a shared channel", settings)
    return made and made + offered(network, "kill, revive, join", "node = 1")
