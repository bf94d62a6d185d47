"""Scenarios of any network over a field that has no keys of its own, and their plans.

Built in code they are the same: `FieldScenario(kind="flood", nodes=20)`.
"""

import math
from dataclasses import dataclass, field
from functools import partial
from typing import Annotated, Any, Literal

from msgspec import Meta

from innervate.network import networks
from innervate.scenario import robots
from innervate.scenario.actions.field import ACTIONS, JAM
from innervate.scenario.cables import Input
from innervate.scenario.declared import moving, shared
from innervate.scenario.declared.foreseen import warnings
from innervate.scenario.declared.offered import offered
from innervate.scenario.events import opening, told
from innervate.scenario.keys import Micros, Table, above_0, number, whole
from innervate.scenario.lines import Key
from innervate.scenario.source import Source
from innervate.topology import placement
from innervate.topology.placement import RSSI50_CDB
from innervate.trace.streams import stream
from innervate.wire.frames import Codec

NODES_MAX = 254
GOOD_CDB = 300  # a good link is so much louder: 95 % are received
LEAST = 0.01  # who receives less than that of a node's frames is out of its reach
# Words of [[event]], with what each needs besides its node.
HAPPENS = "kill, revive, restart, quiet, jam with noise_dbm, cut and restore with other = 3"
PAIRS = ("cut", "restore")


class AirTable(Table, frozen=True, kw_only=True):
    """All nodes' radios.

    Attributes:
        reach_m: over so many metres 95 % of the frames are received, where nothing disturbs them.
        bits_per_s: of a frame on the air.
        preamble_bytes: in front of each.
        turnaround_us: from the decision to send to the first sound; the radio is deaf then.
        exponent: of the path loss: 2 in free space, 3 among machines.
        shadowing_db: sigma of what a pair gains or loses besides, drawn from the seed.
        capture_db: a frame survives others that are weaker by so much.
        sense_db: the carrier is sensed down to so much below the level of 50 % reception.
        queue_frames: frames that wait in a node for those before them.
        backoff_us, exponent_min, exponent_max, busy_max: of CSMA, where the network is over it.
    """

    reach_m: Annotated[float, above_0("metres", 100_000)] = 30.0
    bits_per_s: Annotated[int, whole("bits per second", 100, 1_000_000_000)] = 250_000
    preamble_bytes: Annotated[int, whole("bytes", 0, 1000)] = 6
    turnaround_us: Micros = 192
    exponent: Annotated[float, number("", 1, 6)] = 3.0
    shadowing_db: Annotated[float, number("dB", 0, 20)] = 0.0
    capture_db: Annotated[float, number("dB", 0, 60)] = 6.0
    sense_db: Annotated[float, number("dB", 0, 60)] = 5.0
    queue_frames: Annotated[int, whole("frames", 1, 64)] = 8
    backoff_us: Annotated[int, whole("microseconds", 1, 10_000_000)] = 320
    exponent_min: Annotated[int, whole("bits", 0, 15)] = 3
    exponent_max: Annotated[int, whole("bits", 0, 15)] = 6
    busy_max: Annotated[int, whole("times", 1, 255)] = 8


class LinkTable(Table, frozen=True, kw_only=True):
    """Two nodes that hear each other; if there is one such table, no others do.

    Attributes:
        nodes: their numbers.
        quality: share of the frames that is received, where nothing disturbs them, 0 to 1.
    """

    nodes: tuple[int, int]
    quality: Annotated[float, number("frames received", 0, 1)] = 1.0


class EventTable(Table, frozen=True, kw_only=True):
    """What happens to a node, or between two.

    Attributes:
        at_s: when, s.
        action: kill, revive, restart, jam, quiet; cut, restore with `other`; or an own word.
        node: its number.
        other: of cut and restore: the other node's number.
        noise_dbm: of jam: how loud, dBm.
        value: of the network's own actions: a number for them.
    """

    at_s: Annotated[float, number("seconds", 0)]
    action: str
    node: Annotated[int, whole("", 0)]
    other: Annotated[int, whole("", 0)] | None = None
    noise_dbm: Annotated[float, number("dBm", -150, 0)] = -60.0
    value: int = 0


class FieldScenario(shared.Declared, frozen=True, kw_only=True):
    """A network over a field: who is near enough hears.

    Attributes:
        kind: the network's name.
        nodes: how many there are.
        layout: in a line, on a square grid, or anywhere in a square.
        spacing_m: between neighbours of a line or grid, m.
        side_m: of the square, m.
        positions_m: instead of a layout: (x, y) of every node, m.
        link: instead of places: who hears whom.
        robot: nodes that move, and how.
        sample_hz: so often they are moved, and told where they are.
        absent: nodes that are off until they are revived.
        duration_s: simulated time, s.
        start_us: nodes are switched on within so long, us.
        air: what all nodes' radios have.
        protocol: parameters of the protocol, by name.
        input: what nodes are given by their users, in any order.
        event: what happens to nodes and between them, in any order.
        script: an order of events in place of the clock.
    """

    nodes: Annotated[int, whole("nodes", 2, NODES_MAX)] = 9
    layout: Literal["line", "grid", "random"] = "grid"
    spacing_m: Annotated[float, above_0("metres", 100_000)] = 20.0
    side_m: Annotated[float, above_0("metres", 100_000)] = 100.0
    positions_m: list[tuple[float, float]] = []  # noqa: RUF012
    link: list[LinkTable] = []  # noqa: RUF012
    robot: list[moving.MovingTable] = []  # noqa: RUF012
    sample_hz: robots.SampleHz = 50.0
    absent: list[int] = []  # noqa: RUF012
    start_us: Annotated[int, whole("microseconds", 1, 10_000_000)] = 1000
    air: AirTable = AirTable()
    protocol: dict[str, int] = {}  # noqa: RUF012
    input: Annotated[list[shared.InputTable], Meta(max_length=10_000)] = []  # noqa: RUF012
    event: Annotated[list[EventTable], Meta(max_length=100_000)] = []  # noqa: RUF012
    script: shared.ScriptTable | None = None


@dataclass(frozen=True, slots=True)
class Fault:
    """One event of a run in a field."""

    at_us: int  # when, true time, us
    action: int  # of `actions/field`
    node: int  # the node it happens to
    other: int = -1  # CUT and RESTORE: the other node of the pair, both ways
    value: int = 0  # JAM: the noise there, 0.01 dBm
    index: int = 0  # the event's place in the scenario file


@dataclass(frozen=True, slots=True)
class Heard:
    """Who hears whom, per sender and receiver, row after row."""

    rssi_cdb: list[int]  # how loud, 0.01 dBm
    prob_q15: list[int]  # chance of reception in 1/32768, where nothing disturbs
    base_cdb: list[int] = field(default_factory=list)  # how loud at 1 m; empty where nobody moves
    exponent_c: int = 300  # path loss exponent x 100


@dataclass(slots=True)
class FieldPlan:
    """Everything a run over a field needs, as whole numbers."""

    scenario: Any
    kind: str
    seed: int
    duration_us: int
    nodes: int  # how many
    params: dict[str, int]
    air: AirTable
    positions_cm: list[tuple[int, int]]  # where they are; empty where only links are known
    heard: Heard  # who hears whom
    good: list[tuple[int, int]]  # pairs that hear at least half of each other's frames
    starts_us: list[int]  # when each is switched on; of absent ones not looked at
    absent: list[int]  # per node, 1 = off until it is revived
    inputs: list[Input]
    faults: list[Fault] = field(default_factory=list)
    walks: list[robots.Walk] = field(default_factory=list)  # how robots move
    sample_us: int = 20_000  # they are moved, and told where they are, so often


def check(source: Source, model: FieldScenario) -> None:
    """Everything that single keys do not show.

    Raises:
        ScenarioError: the first thing that cannot be.
    """
    if model.positions_m and len(model.positions_m) != model.nodes:
        what = f"positions_m has {len(model.positions_m)} places for {model.nodes} nodes"
        raise source.error(("positions_m",), what)
    if model.air.exponent_min > model.air.exponent_max:
        raise source.error(("air", "exponent_min"), "air.exponent_min is above exponent_max")
    for place, link in enumerate(model.link):
        _check_pair(source, ("link", place, "nodes"), link.nodes, model.nodes)
    moving.check(source, model)
    shared.check(source, model, model.nodes, ACTIONS, partial(_check_other, source, model.nodes))


def _check_other(source: Source, nodes: int, key: Key, event: EventTable) -> None:
    if event.action in PAIRS and event.other is None:
        raise source.error(key, f"{event.action} needs the other node; add other = 1")
    if event.action not in PAIRS and event.other is not None:
        raise source.error((*key, "other"), f"{event.action} has no other; leave it out")
    if event.other is not None:
        shared.check_node(source, (*key, "node"), event.node, nodes)
        _check_pair(source, (*key, "other"), (event.node, event.other), nodes)


def _check_pair(source: Source, key: Key, pair: tuple[int, int], nodes: int) -> None:
    for node in pair:
        shared.check_node(source, key, node, nodes)
    if pair[0] == pair[1]:
        raise source.error(key, f"node {pair[0]} is named twice; name two nodes")


def plan(scenario: Any) -> FieldPlan:
    """The plan of a scenario.

    Raises:
        ScenarioError: more inputs than can be held.
    """
    model, network = scenario.model, networks()[scenario.model.kind]
    count = model.nodes
    points = [] if model.link else _points(model)
    numbered, duration_us = moving.Numbered(scenario.source, count), round(1e6 * model.duration_s)
    for node, start in robots.starts(model.robot, numbered).items():
        points[node] = start
    ground = robots.Ground(points, points, model.seed, duration_us)
    heard = _linked(model) if model.link else _placed(model, points)
    draw = stream(model.seed, "starts")
    starts = [draw.uniform(0, model.start_us - 1) for _ in range(count)]
    faults = [_fault(event, place) for place, event in enumerate(model.event)
              if event.action in ACTIONS]  # fmt: skip
    return FieldPlan(
        scenario=scenario,
        kind=model.kind,
        seed=model.seed,
        duration_us=duration_us,
        nodes=count,
        params=shared.parameters(network.fields, model.protocol),
        air=model.air,
        positions_cm=points,
        heard=heard,
        good=placement.good_links(heard.rssi_cdb, count, RSSI50_CDB),
        starts_us=starts,
        absent=[int(node in model.absent) for node in range(count)],
        inputs=shared.inputs_of(model, network, count, ACTIONS),
        faults=sorted(faults, key=lambda fault: (fault.at_us, fault.index)),
        walks=robots.walks(enumerate(model.robot), numbered, ground),
        sample_us=round(1e6 / model.sample_hz),
    )


def _fault(event: EventTable, place: int) -> Fault:
    action = ACTIONS.index(event.action)
    return Fault(
        at_us=round(1e6 * event.at_s),
        action=action,
        node=event.node,
        other=-1 if event.other is None else event.other,
        value=round(100 * event.noise_dbm) if action == JAM else 0,
        index=place,
    )


def _points(model: FieldScenario) -> list[tuple[int, int]]:
    if model.positions_m:
        return [(round(100 * x), round(100 * y)) for x, y in model.positions_m]
    if model.layout == "random":
        side_cm = round(100 * model.side_m)
        return placement.square(model.nodes, side_cm, stream(model.seed, "placement"))
    columns = model.nodes if model.layout == "line" else math.isqrt(model.nodes - 1) + 1
    return placement.grid(model.nodes, columns, round(100 * model.spacing_m))


def _placed(model: FieldScenario, points: list[tuple[int, int]]) -> Heard:
    count, radio = model.nodes, model.air
    exponent_c = round(100 * radio.exponent)
    shadowing = round(100 * radio.shadowing_db)
    faded = placement.fading(count, shadowing, 0, stream(model.seed, "fading"))
    at_1m = RSSI50_CDB + GOOD_CDB
    at_1m += placement.path_loss_cdb(round(100 * radio.reach_m), exponent_c)
    gains = placement.gains(points, faded, exponent_c)
    rssi = [placement.UNHEARD if i % (count + 1) == 0 else max(at_1m + one, placement.UNHEARD + 1)
            for i, one in enumerate(gains)]  # fmt: skip
    chances = (placement.reception_q15(one - RSSI50_CDB) for one in rssi)
    base = [at_1m + one if i % (count + 1) else placement.UNHEARD for i, one in enumerate(faded)]
    return Heard(rssi, [in_reach(one) for one in chances], base if model.robot else [], exponent_c)


def in_reach(chance_q15: int) -> int:
    """A chance of reception, or 0 where it is so small that nobody counts on it; in 1/32768."""
    return chance_q15 if chance_q15 >= LEAST * placement.ONE_Q15 else 0


def _linked(model: FieldScenario) -> Heard:
    count = model.nodes
    rssi, prob = [placement.UNHEARD] * (count * count), [0] * (count * count)
    for link in model.link:
        for a, b in (link.nodes, link.nodes[::-1]):
            rssi[a * count + b] = RSSI50_CDB + placement.quality_cdb(link.quality)
            prob[a * count + b] = round(link.quality * placement.ONE_Q15)
    return Heard(rssi, prob)


def sizes_of(frames: Any) -> dict[int, int]:
    """Bytes of a frame of each kind, its check sum included: of the part `frames` of a network."""
    sizes: dict[int, int] = Codec(frames.LAYOUTS, frames.KIND_BITS).sizes
    return sizes


def describe(plan: Any) -> str:
    """A plan in words, several lines, without a newline at the end."""
    params = ", ".join(f"{name} {value}" for name, value in plan.params.items())
    pairs = f"{len(plan.good):,} pair{' hears' if len(plan.good) == 1 else 's hear'}"
    lines = [
        opening(plan),
        f"  nodes      {plan.nodes:,} in a field, {pairs} each other",
        *moving.lines(plan),
        f"  protocol   {params}",
    ]
    pairs_met = moving.met(plan.nodes, plan.good, moving.walkers_of(plan))
    found = warnings(plan, pairs_met, plan.scenario.model.start_us)
    own = shared.own_lines(plan)
    return "\n".join([*lines, *shared.script_lines(plan), *told(plan, fault_words, found, own)])


def fault_words(plan: Any, fault: Any) -> str:
    """A fault in words: "at 2 s cut node 3 - node 4"."""
    where = f"node {fault.node}" + (f" - node {fault.other}" if fault.other >= 0 else "")
    loud = f" with {fault.value / 100:g} dBm" if fault.action == JAM else ""
    return f"at {fault.at_us / 1e6:g} s {ACTIONS[fault.action]} {where}{loud}"


def event(plan: Any, fault: Any) -> dict[str, Any]:
    """The [[event]] table of a fault, without its time."""
    made: dict[str, Any] = {"action": ACTIONS[fault.action], "node": fault.node}
    if fault.other >= 0:
        made["other"] = fault.other
    if fault.action == JAM:
        made["noise_dbm"] = fault.value / 100
    return made


def template(network: Any) -> str:
    """A scenario to start from, with all parameters; "" for a network with keys of its own."""
    settings = ("nodes = 9", 'layout = "grid"  # line, grid, random; or positions_m; or [[link]]s',
                "spacing_m = 20", "duration_s = 1.0", "", "[air]", "reach_m = 30")  # fmt: skip
    made = shared.template(network, FieldScenario, "over a field", settings)
    if not made:
        return ""
    placed = moving.placed_of(network.fields)
    told = "" if placed is None else f"; it is told where it is: on_input, kind {placed.kind}"
    robot = [f"[[robot]]  # a node that moves{told}", "node = 1",
             "waypoints = [[0, 0], [40, 40]]  # m; or random = true", "speed_mps = 2"]  # fmt: skip
    return made + offered(network, HAPPENS, "node = 2", robot)
