"""Whom an event means: the end of a cable or a node, named or drawn from the seed."""

from dataclasses import dataclass, field

from innervate.networks.skin.scenario.graph import cell_at, node_and_port, numbered, port_at
from innervate.networks.skin.scenario.model import CellTable, EventTable
from innervate.networks.skin.scenario.rules import TARGET_OF
from innervate.scenario.lines import Key
from innervate.scenario.source import Source, dotted
from innervate.topology import PORT_NAMES, PORTS, Graph
from innervate.trace.streams import Stream

NONE = -1


@dataclass(slots=True)
class Damage:
    """What earlier events took away, so that random ones choose among what is left."""

    cut: set[int] = field(default_factory=set)  # for every cut cable the lower of its two ends
    dead: set[int] = field(default_factory=set)  # cells killed and not revived

    def note(self, graph: Graph, action: str, end: int, node: int) -> None:
        """Take down what an event does."""
        cable = min(end, graph.peer[end]) if end >= 0 else NONE
        if action == "cut":
            self.cut.add(cable)
        elif action == "restore":
            self.cut.discard(cable)
        elif action == "kill":
            self.dead.add(node)
        elif action == "revive":
            self.dead.discard(node)


def target(
    source: Source, graph: Graph, index: int, event: EventTable, draw: Stream, damage: Damage
) -> tuple[int, int]:
    """(end, node) of event `index`; the one that does not apply is -1.

    A cable is named by one of its ends: the PC's for an interface, the cell's own for
    cell + port, the first cell's for a link, the lower one for a random cable.

    Raises:
        ScenarioError: no such interface, cell, port or cable, or nothing left to draw from.
    """
    key: Key = ("event", index)
    if event.random is not None:
        return _drawn(source, graph, index, event, draw, damage)
    if TARGET_OF[event.action] != "cable":
        return NONE, _node(source, graph, event, key)
    if event.interface is not None:
        if event.interface >= graph.interfaces:
            are = numbered("interface", graph.interfaces)
            message = f"{dotted(key)}: there is no interface {event.interface}; {are}"
            raise source.error((*key, "interface"), message)
        return PORTS * graph.cells + event.interface, NONE
    if event.link is not None:
        return _link(source, graph, event.link, (*key, "link")), NONE
    return _cable_of(source, graph, event, key), NONE


def _node(source: Source, graph: Graph, event: EventTable, key: Key) -> int:
    if event.pc:
        return graph.cells
    if event.cell is not None:
        if event.cell.port is not None:
            message = f'{dotted(key)}: "{event.action}" acts on the whole cell; leave port out'
            raise source.error((*key, "cell"), message)
        return cell_at(source, graph, event.cell, (*key, "cell"))
    assert event.node is not None
    if event.node.strip() == "pc" and event.action == "restart":
        return graph.cells
    return cell_at(source, graph, event.node, (*key, "node"))


def _cable_of(source: Source, graph: Graph, event: EventTable, key: Key) -> int:
    """The end of a cell's cable: that of the port named, or of its only cabled one."""
    key = (*key, "cell" if event.cell is not None else "node")
    port = NONE
    if event.cell is not None:
        node = cell_at(source, graph, event.cell, key)
        if event.cell.port is not None:
            port = port_at(source, event.cell.port, (*key, "port"))
    else:
        node, port = node_and_port(source, graph, event.node or "", key)
        if node == graph.cells and port < 0:
            raise source.error(key, f"{dotted(key)}: name a port of the PC, like pc.0")
    if event.port is not None:
        port = port_at(source, event.port, (*key[:2], "port"))
    cabled = [end for end in graph.ends_of(node) if graph.peer[end] >= 0]
    if port < 0 and len(cabled) == 1:
        return cabled[0]
    end = graph.end(node, port)
    if port >= 0 and end in cabled:
        return end
    names = ", ".join(PORT_NAMES[graph.port_of(e)] for e in cabled) if node < graph.cells else ""
    which = f"port {PORT_NAMES[port]} of {graph.label(node)} has no cable"
    if port < 0:
        which = f"{graph.label(node)} has {len(cabled)} cables; say which with port"
    message = f"{dotted(key[:2])}: {which}; cabled are {names}"
    raise source.error(key, message)


def _link(
    source: Source, graph: Graph, pair: tuple[CellTable | str, CellTable | str], key: Key
) -> int:
    """The end, at the first node, of the cable between two nodes."""
    sides = []
    for index, where in enumerate(pair):
        if isinstance(where, str):
            sides.append(node_and_port(source, graph, where, (*key, index)))
        else:
            at = (*key, index)
            port = NONE if where.port is None else port_at(source, where.port, at)
            sides.append((cell_at(source, graph, where, at), port))
    end = find_link(graph, sides[0], sides[1])
    if end < 0:
        a, b = (graph.label(node) for node, _ in sides)
        message = f"{dotted(key)}: no cable joins {a} and {b} there; name two neighbours"
        raise source.error(key, message)
    return end


def find_link(graph: Graph, a: tuple[int, int], b: tuple[int, int]) -> int:
    """The end, at node a, of the first cable from (node, port) a to b; -1 if there is none.

    A port of -1 stands for any.
    """
    for end in graph.ends_of(a[0]):
        other = graph.peer[end]
        if other < 0 or graph.node_of(other) != b[0]:
            continue
        if a[1] in (NONE, graph.port_of(end)) and b[1] in (NONE, graph.port_of(other)):
            return end
    return NONE


def _drawn(
    source: Source, graph: Graph, index: int, event: EventTable, draw: Stream, damage: Damage
) -> tuple[int, int]:
    """A random target. Repairs choose among what is broken, everything else among what is whole.

    "link" means cables between two cells; those to the PC are "interface".
    """
    mending = event.action in ("restore", "revive")
    if event.random == "cell":
        nodes = [c for c in range(graph.cells) if (c in damage.dead) == mending]
        if nodes:
            return NONE, nodes[draw.draw(len(nodes))]
    else:
        border = PORTS * graph.cells
        first, last = (border, len(graph.peer)) if event.random == "interface" else (0, border)
        ends = [
            end
            for end in range(first, last)
            if graph.peer[end] >= 0
            and (first == border or end < graph.peer[end] < border)
            and (min(end, graph.peer[end]) in damage.cut) == mending
        ]
        if ends:
            return ends[draw.draw(len(ends))], NONE
    state = "broken" if mending else "whole"
    message = f"event.{index}: no {event.random} is {state} at that time to {event.action}"
    raise source.error(("event", index, "random"), message)
