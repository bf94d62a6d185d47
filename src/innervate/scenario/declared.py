"""Scenarios of any network over cables that has no keys of its own: nodes, cables, what happens.

Built in code they are the same: `CablesScenario(kind="ring", nodes=5)`.
"""

from __future__ import annotations

import math
from array import array
from typing import Annotated, Any, Literal

from msgspec import Meta

from innervate.network import networks
from innervate.scenario.actions.cables import ACTIONS, LOOSE, LOSE, TABLE
from innervate.scenario.cables import LOSS_ONE, CablesPlan, Fault, Input
from innervate.scenario.errors import ScenarioError
from innervate.scenario.explain import alternatives, nearest
from innervate.scenario.keys import Micros, Name, Schema, Seed, Table, above_0, number, whole
from innervate.scenario.lines import Key
from innervate.scenario.source import Source, shown
from innervate.topology import PORTS, TopologyError, free_graph
from innervate.topology.graph import Graph

NODES_MAX = 1_000_000
INPUTS_MAX = 1_000_000
WEST, EAST, NORTH, SOUTH = range(4)  # ports
Numbers = int | list[int]


class Links(Table, frozen=True, kw_only=True):
    """What all cables have.

    Attributes:
        latency_us: least and greatest latency of a hop, its time on the wire included, us.
        wire_us: how long a frame occupies the wire, us.
        loss: share of frames that is lost, 0 to 1.
        queue_frames: frames that wait at a port at most.
    """

    latency_us: tuple[Micros, Micros] = (80, 160)
    wire_us: Micros = 60
    loss: Annotated[float, number("frames lost", 0, 1)] = 0.0
    queue_frames: Annotated[int, whole("frames", 1, 1000)] = 8


class InputTable(Table, frozen=True, kw_only=True):
    """What a node is given by its user.

    Attributes:
        at_s: when first, s.
        kind: as the protocol's `on_input` has it.
        node: its number; every node if left out.
        every_s: again after so long, s; 0 = once.
        item: fields of a frame.
    """

    at_s: Annotated[float, number("seconds", 0)] = 0.0
    kind: Annotated[int, whole("", 0, 1 << 20)] = 1
    node: Annotated[int, whole("", 0)] | None = None
    every_s: Annotated[float, number("seconds", 0)] = 0.0
    item: dict[str, Numbers] = {}  # noqa: RUF012


class EventTable(Table, frozen=True, kw_only=True):
    """What happens to a cable, to a node, or whatever the network has words for.

    Attributes:
        at_s: when, s.
        action: cut, restore, loose, lose of a `link`; kill, revive, restart of a `node`.
        link: a cable, by its nodes: "n0-n1".
        node: a node's number.
        loss: of loose: share of frames that is lost, 0 to 1.
        frames: of lose: how many frames are lost.
        value: of the network's own actions: a number for them.
    """

    at_s: Annotated[float, number("seconds", 0)]
    action: str
    link: str | None = None
    node: Annotated[int, whole("", 0)] | None = None
    loss: Annotated[float, number("frames lost", 0, 1)] = 0.5
    frames: Annotated[int, whole("frames", 1, 1000)] = 1
    value: int = 0


class CablesScenario(Table, frozen=True, kw_only=True):
    """A network over cables.

    Attributes:
        kind: the network's name.
        nodes: how many there are, "n0", "n1", ...; nodes of `cables` if those are given.
        shape: how they are cabled: from port E (1) to the next one's W (0) in a line or ring; a
            grid, whose rows are joined down (3) to up (2); a tree, up to the parent.
        cables: instead of a shape: pairs like "n0.E-n1.W", "n1-n2" (the first free ports).
        duration_s: simulated time, s.
        drift_ppm: clocks run up to so much fast or slow.
        start_us: nodes are switched on within so long, us.
        protocol: parameters of the protocol, by name.
        input, event: in any order.
    """

    kind: str
    schema: Schema = 1
    name: Name = "network"
    duration_s: Annotated[float, above_0("seconds", 1e6)] = 1.0
    seed: Seed = 1
    nodes: Annotated[int, whole("nodes", 2, NODES_MAX)] = 4
    shape: Literal["line", "ring", "grid", "tree"] = "ring"
    cables: list[str] = []  # noqa: RUF012
    drift_ppm: Annotated[int, whole("ppm", 0, 1000)] = 30
    start_us: Annotated[int, whole("microseconds", 1, 10_000_000)] = 1000
    links: Links = Links()
    protocol: dict[str, int] = {}  # noqa: RUF012
    input: Annotated[list[InputTable], Meta(max_length=10_000)] = []  # noqa: RUF012
    event: Annotated[list[EventTable], Meta(max_length=100_000)] = []  # noqa: RUF012


def parameters(fields: Any, given: dict[str, int]) -> dict[str, int]:
    """All parameters of a protocol: what is given, or as `fields.DEFAULTS` has them, or the value
    in range nearest 0.
    """
    usual = getattr(fields, "DEFAULTS", {})
    return {
        name: given.get(name, usual.get(name, min(max(0, low), high)))
        for name, _length, low, high, *_ in fields.PARAMS
    }


def check_declared(source: Source, key: Key, given: dict[str, Any], declared: Any) -> None:
    """Names and ranges of values for declared fields.

    Raises:
        ScenarioError: the first that is none, or out of its range.
    """
    known = {name: (length, low, high, unit) for name, length, low, high, unit, _ in declared}
    for name, value in given.items():
        if name not in known:
            hint = nearest(name, list(known)) if known else "; it has none"
            raise source.error((*key, name), f"{key[0]} has no {shown(name)}{hint}")
        length, low, high, unit = known[name]
        values = value if isinstance(value, list) else [value]
        if (length and (not isinstance(value, list) or len(value) != length)) or (
            not length and isinstance(value, list)
        ):
            many = f"{length} numbers" if length else "one number"
            raise source.error((*key, name), f"{name} must be {many}, not {shown(value)}")
        if not all(low <= one <= high for one in values):
            what = f"{name} must be {low} to {high} {unit}, not {shown(value)}"
            raise source.error((*key, name), what)


def check(source: Source, model: CablesScenario) -> None:
    """Everything that single keys do not show.

    Raises:
        ScenarioError: the first thing that cannot be.
    """
    network = networks()[model.kind]
    low, high = model.links.latency_us
    if low > high:
        raise source.error(("links", "latency_us"), "links.latency_us must be [least, greatest]")
    check_declared(source, ("protocol",), model.protocol, network.fields.PARAMS)
    graph = _graph(source, model)
    for place, given in enumerate(model.input):
        _check_node(source, ("input", place, "node"), given.node, graph)
        check_declared(source, ("input", place, "item"), given.item, network.fields.FRAME)
    for place, event in enumerate(model.event):
        _check_event(source, ("event", place), event, graph, network)


def _check_node(source: Source, key: Key, node: int | None, graph: Graph) -> None:
    if node is not None and node >= graph.cells:
        raise source.error(key, f"there is no node {node}; they are 0 to {graph.cells - 1}")


def _check_event(source: Source, key: Key, event: EventTable, graph: Graph, network: Any) -> None:
    own = list(network.happenings) if network.has("happenings") else []
    if event.action not in (*ACTIONS, *own):
        one = alternatives([*ACTIONS, *own])
        raise source.error((*key, "action"), f"action must be {one}, not {shown(event.action)}")
    on_cable = event.action in ACTIONS and TABLE[ACTIONS.index(event.action)].target == "cable"
    wanted, other = ("link", "node") if on_cable else ("node", "link")
    if getattr(event, wanted) is None:
        example = '"n0-n1"' if on_cable else "0"
        raise source.error(key, f"{event.action} needs a {wanted}; add {wanted} = {example}")
    if getattr(event, other) is not None:
        raise source.error((*key, other), f"{event.action} has no {other}; leave it out")
    if on_cable:
        _end_of(source, (*key, "link"), graph, str(event.link))
    _check_node(source, (*key, "node"), event.node, graph)


def _end_of(source: Source, key: Key, graph: Graph, text: str) -> int:
    """The first end of a cable between two nodes."""
    names = text.split("-")
    for end, peer in graph.links():
        if len(names) == 2 and sorted(names) == sorted(
            graph.label(graph.node_of(one)) for one in (end, peer)
        ):
            return end
    raise source.error(key, f'there is no cable {shown(text)}; write one like "n0-n1"')


def _graph(source: Source, model: CablesScenario) -> Graph:
    if not model.cables:
        return shaped(model.shape, model.nodes)
    try:
        return free_graph([(a, b) for a, _, b in (text.partition("-") for text in model.cables)])
    except TopologyError as error:
        place = error.subject.split(".")[1:2]
        raise source.error(("cables", *map(int, place)), str(error)) from None


def shaped(shape: str, nodes: int) -> Graph:
    """A line, ring, grid or tree of nodes "n0", "n1", ..."""
    names = tuple(f"n{node}" for node in range(nodes))
    graph = Graph(nodes, 0, array("i", [-1]) * (PORTS * nodes), names=names)
    columns = math.ceil(math.sqrt(nodes)) if shape == "grid" else nodes
    for node in range(nodes):
        if shape == "tree" and node:
            parent, place = divmod(node - 1, 3)
            graph.connect(PORTS * parent + (WEST, EAST, SOUTH)[place], PORTS * node + NORTH)
        if shape != "tree" and (node + 1) % columns and node + 1 < nodes:
            graph.connect(PORTS * node + EAST, PORTS * (node + 1) + WEST)
        if shape == "grid" and node + columns < nodes:
            graph.connect(PORTS * node + SOUTH, PORTS * (node + columns) + NORTH)
    if shape == "ring":
        graph.connect(PORTS * (nodes - 1) + EAST, WEST)
    return graph


def plan(scenario: Any) -> CablesPlan:
    """The plan of a scenario.

    Raises:
        ScenarioError: more inputs than can be held.
    """
    model, source = scenario.model, scenario.source
    network, graph = networks()[model.kind], _graph(source, model)
    faults = [_fault(source, graph, place, event) for place, event in enumerate(model.event)
              if event.action in ACTIONS]  # fmt: skip
    return CablesPlan(
        scenario=scenario,
        graph=graph,
        kind=model.kind,
        seed=model.seed,
        duration_us=round(1e6 * model.duration_s),
        params=parameters(network.fields, model.protocol),
        start_us=model.start_us,
        drift_ppm=model.drift_ppm,
        latency_us=model.links.latency_us,
        wire_us=model.links.wire_us,
        queue_frames=model.links.queue_frames,
        loss_q15=round(model.links.loss * LOSS_ONE),
        faults=sorted(faults, key=lambda fault: (fault.at_us, fault.index)),
        inputs=inputs_of(model, network, graph.cells, ACTIONS),
    )


def _fault(source: Source, graph: Graph, place: int, event: EventTable) -> Fault:
    action, end = ACTIONS.index(event.action), -1
    if event.link is not None:
        end = _end_of(source, ("event", place, "link"), graph, event.link)
    return Fault(
        at_us=round(1e6 * event.at_s),
        action=action,
        end=end,
        node=-1 if event.node is None else event.node,
        loss_q15=round(event.loss * LOSS_ONE) if action == LOOSE else 0,
        frames=event.frames if action == LOSE else 0,
        index=place,
    )


def inputs_of(model: Any, network: Any, count: int, actions: tuple[str, ...]) -> list[Input]:
    """What nodes are given, repeated and for every node, in order of time.

    Args:
        model: with the tables `input` and `event`.
        network: whose `happenings` are events, too.
        count: how many nodes there are.
        actions: words of events that are no inputs.

    Raises:
        ScenarioError: more inputs than can be held.
    """
    found: list[Input] = []
    for given in model.input:
        period = given.every_s or model.duration_s
        times = max(math.ceil((model.duration_s - given.at_s) / period), 1)
        who = range(count) if given.node is None else [given.node]
        if len(found) + times * len(who) > INPUTS_MAX:
            what = f"more than {INPUTS_MAX:,} inputs; make every_s longer or the run shorter"
            raise ScenarioError(what)
        found += [Input(round(1e6 * (given.at_s + k * period)), node, given.kind, dict(given.item))
                  for k in range(times) for node in who]  # fmt: skip
    for event in model.event:
        if event.action not in actions:
            kind, item = network.happenings[event.action](event.node, event.value)
            found.append(Input(round(1e6 * event.at_s), event.node, kind, dict(item)))
    return sorted(found, key=lambda one: one.at_us)


def template(network: Any) -> str:
    """A scenario to start from, with all parameters as they are by themselves; "" for a network
    whose scenarios have keys of their own.
    """
    if network.model is not CablesScenario:
        return ""
    width = max((len(name) for name, *_ in network.fields.PARAMS), default=0)
    values = parameters(network.fields, {})
    lines = [f"{name:{width}} = {values[name]}  # {low} to {high} {unit}: {meaning}"
             for name, _length, low, high, unit, meaning in network.fields.PARAMS]  # fmt: skip
    return "\n".join([
        f"# A {network.name} over cables.",
        f'kind = "{network.name}"',
        "nodes = 6",
        'shape = "ring"  # line, ring, grid, tree; or cables = ["n0.E-n1.W", "n1-n2"]',
        "duration_s = 1.0",
        "",
        "[protocol]",
        *lines,
        "",
        "# [[event]]",
        "# at_s = 0.5",
        '# action = "cut"  # restore, loose, lose; kill, revive, restart of a node',
        '# link = "n0-n1"',
        "",
    ])  # fmt: skip


__all__ = ["CablesScenario", "EventTable", "InputTable", "Links", "check", "plan"]
