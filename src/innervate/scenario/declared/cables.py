"""Scenarios of any network over cables that has no keys of its own: nodes, cables, what happens.

Built in code they are the same: `CablesScenario(kind="ring", nodes=5)`.
"""

import math
from array import array
from functools import partial
from typing import Annotated, Any, Literal

from msgspec import Meta

from innervate.network import networks
from innervate.scenario import cables
from innervate.scenario.actions.cables import ACTIONS, LOOSE, LOSE, TARGETS
from innervate.scenario.cables import LOSS_ONE, CablesPlan, Fault
from innervate.scenario.declared import shared
from innervate.scenario.declared.foreseen import warnings
from innervate.scenario.declared.offered import offered
from innervate.scenario.keys import Micros, Table, number, whole
from innervate.scenario.lines import Key
from innervate.scenario.source import Source, shown
from innervate.topology import PORT_NAMES, PORTS, TopologyError, free_graph
from innervate.topology.graph import Graph

NODES_MAX = 1_000_000
WEST, EAST, NORTH, SOUTH = range(4)  # ports
# Of a scenario to start from.
SETTINGS = (
    "nodes = 6",
    'shape = "ring"  # line, ring, grid, tree; or cables = ["n0.E-n1.W", "n1-n2"]',
    "duration_s = 1.0",
)
# Words of [[event]], with what they happen to if it is no link.
HAPPENS = "cut, restore, loose, lose; kill, revive, restart of a node"


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


class EventTable(Table, frozen=True, kw_only=True):
    """What happens to a cable, to a node, or whatever the network has words for.

    Attributes:
        at_s: when, s.
        action: cut, restore, loose, lose of a `link`; kill, revive, restart of a `node`.
        link: a cable, by its nodes: "n0-n1", or by its ends, where there are two: "n0.E-n1.W".
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


class CablesScenario(shared.Declared, frozen=True, kw_only=True):
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
        input: what nodes are given by their users, in any order.
        event: what happens to nodes and between them, in any order.
        script: an order of events in place of the clock.
    """

    nodes: Annotated[int, whole("nodes", 2, NODES_MAX)] = 4
    shape: Literal["line", "ring", "grid", "tree"] = "ring"
    cables: list[str] = []  # noqa: RUF012
    drift_ppm: Annotated[int, whole("ppm", 0, 1000)] = 30
    start_us: Annotated[int, whole("microseconds", 1, 10_000_000)] = 1000
    links: Links = Links()
    protocol: dict[str, int] = {}  # noqa: RUF012
    input: Annotated[list[shared.InputTable], Meta(max_length=10_000)] = []  # noqa: RUF012
    event: Annotated[list[EventTable], Meta(max_length=100_000)] = []  # noqa: RUF012
    script: shared.ScriptTable | None = None


def check(source: Source, model: CablesScenario) -> None:
    """Everything that single keys do not show.

    Raises:
        ScenarioError: the first thing that cannot be.
    """
    low, high = model.links.latency_us
    if low > high:
        raise source.error(("links", "latency_us"), "links.latency_us must be [least, greatest]")
    graph = _graph(source, model)
    target = partial(_check_target, source, graph)
    shared.check(source, model, graph.cells, ACTIONS, target, graph)


def _check_target(source: Source, graph: Graph, key: Key, event: EventTable) -> None:
    on_cable = TARGETS.get(event.action) == "cable"
    wanted, other = ("link", "node") if on_cable else ("node", "link")
    if getattr(event, wanted) is None:
        example = '"n0-n1"' if on_cable else "0"
        raise source.error(key, f"{event.action} needs a {wanted}; add {wanted} = {example}")
    if getattr(event, other) is not None:
        raise source.error((*key, other), f"{event.action} has no {other}; leave it out")
    if on_cable:
        _end_of(source, (*key, "link"), graph, str(event.link))


def _end_of(source: Source, key: Key, graph: Graph, text: str) -> int:
    """The first end of a cable between two nodes, or two of their ports."""
    names = sorted(text.split("-"))
    for end, peer in graph.links():
        nodes = sorted(graph.label(graph.node_of(one)) for one in (end, peer))
        ports = sorted(_end_name(graph, one) for one in (end, peer)) if "." in text else nodes
        if names in (nodes, ports):
            return end
    raise source.error(key, f'there is no cable {shown(text)}; write one like "n0-n1"')


def _end_name(graph: Graph, end: int) -> str:
    """An end as scenarios call it: "n0.E"."""
    return f"{graph.label(graph.node_of(end))}.{PORT_NAMES[graph.port_of(end)]}"


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
        params=shared.parameters(network.fields, model.protocol),
        start_us=model.start_us,
        drift_ppm=model.drift_ppm,
        latency_us=model.links.latency_us,
        wire_us=model.links.wire_us,
        queue_frames=model.links.queue_frames,
        loss_q15=round(model.links.loss * LOSS_ONE),
        faults=sorted(faults, key=lambda fault: (fault.at_us, fault.index)),
        inputs=shared.inputs_of(model, network, graph.cells, ACTIONS),
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


def event(plan: Any, fault: Any) -> dict[str, Any]:
    """The [[event]] table of a fault, without its time."""
    made: dict[str, Any] = {"action": ACTIONS[fault.action]}
    if fault.end < 0:
        return {**made, "node": fault.node}
    graph = plan.graph
    made["link"] = "-".join(_end_name(graph, end) for end in (fault.end, graph.peer[fault.end]))
    if fault.action == LOOSE:
        made["loss"] = fault.loss_q15 / LOSS_ONE
    if fault.action == LOSE:
        made["frames"] = fault.frames
    return made


def describe(plan: Any) -> str:
    """A plan in words, several lines, and what of it cannot work."""
    graph: Graph = plan.graph
    near = [(graph.node_of(a), graph.node_of(b)) for a, b in graph.links()]
    found = ["nobody gets any frame: links.loss is 1"] if plan.loss_q15 >= LOSS_ONE else []
    found += warnings(plan, near, plan.start_us)
    return cables.describe(plan, found, shared.script_lines(plan), shared.own_lines(plan))


def template(network: Any) -> str:
    """A scenario to start from, with all parameters; "" for a network with keys of its own."""
    made = shared.template(network, CablesScenario, "over cables", SETTINGS)
    return made and made + offered(network, HAPPENS, 'link = "n0-n1"')
