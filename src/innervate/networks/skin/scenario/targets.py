"""Whom an event means: the end of a cable or a node, named or drawn from the seed."""

from innervate.networks.skin.scenario.graph import Named, numbered
from innervate.networks.skin.scenario.model import CellTable, EventTable
from innervate.scenario.actions.cables import TARGETS
from innervate.scenario.events import Harmed
from innervate.scenario.lines import Key
from innervate.topology import PORT_NAMES, PORTS, Graph
from innervate.trace.streams import Stream

NONE = -1


def hit(graph: Graph, end: int, node: int) -> int:
    """What an event happens to, as a number: of a cable the lower of its ends, or the node."""
    return min(end, graph.peer[end]) if end >= 0 else node


def target(
    named: Named, index: int, event: EventTable, draw: Stream, harmed: Harmed
) -> tuple[int, int]:
    """(end, node) of event `index`; the one that does not apply is -1.

    A cable is named by one of its ends: the PC's for an interface, the cell's own for
    cell + port, the first cell's for a link, the lower one for a random cable.

    Raises:
        ScenarioError: no such interface, cell, port or cable, or nothing left to draw from.
    """
    key: Key = ("event", index)
    graph = named.graph
    if event.random is not None:
        return _drawn(named, key, event, draw, harmed)
    if TARGETS[event.action] != "cable":
        return NONE, _node(named, event, key)
    if event.interface is not None:
        if event.interface >= graph.interfaces:
            are = numbered("interface", graph.interfaces)
            message = f"there is no interface {event.interface}; {are}"
            raise named.wrong(key, message, "interface")
        return PORTS * graph.cells + event.interface, NONE
    if event.link is not None:
        return _link(named, event.link, (*key, "link")), NONE
    return _cable_of(named, event, key), NONE


def _node(named: Named, event: EventTable, key: Key) -> int:
    if event.pc:
        return named.graph.cells
    if event.cell is not None:
        if event.cell.port is not None:
            message = f'"{event.action}" acts on the whole cell; leave port out'
            raise named.wrong(key, message, "cell")
        return named.cell(event.cell, (*key, "cell"))
    assert event.node is not None
    if event.node.strip() == "pc" and event.action == "restart":
        return named.graph.cells
    return named.cell(event.node, (*key, "node"))


def _cable_of(named: Named, event: EventTable, key: Key) -> int:
    """The end of a cell's cable: that of the port named, or of its only cabled one."""
    graph, where = named.graph, "cell" if event.cell is not None else "node"
    node, port = named.cell_and_port(event.cell or event.node or "", (*key, where))
    if node == graph.cells and port < 0:
        raise named.wrong((*key, where), "name a port of the PC, like pc.0")
    if event.port is not None:
        port = named.port(event.port, (*key, "port"))
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
    raise named.wrong(key, f"{which}; cabled are {names}", where)


def _link(named: Named, pair: tuple[CellTable | str, CellTable | str], key: Key) -> int:
    """The end, at the first node, of the cable between two nodes."""
    sides = [named.cell_and_port(where, (*key, index)) for index, where in enumerate(pair)]
    end = find_link(named.graph, *sides)
    if end < 0:
        a, b = (named.graph.label(node) for node, _ in sides)
        raise named.wrong(key, f"no cable joins {a} and {b} there; name two neighbours")
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
    named: Named, key: Key, event: EventTable, draw: Stream, harmed: Harmed
) -> tuple[int, int]:
    """A random target. Repairs choose among what is broken, everything else among what is whole.

    "link" means cables between two cells; those to the PC are "interface".
    """
    graph, mending = named.graph, event.action in ("restore", "revive")
    if event.random == "cell":
        nodes = [c for c in range(graph.cells) if (c in harmed.by["kill"]) == mending]
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
            and (min(end, graph.peer[end]) in harmed.by["cut"]) == mending
        ]
        if ends:
            return ends[draw.draw(len(ends))], NONE
    state = "broken" if mending else "whole"
    message = f"no {event.random} is {state} at that time to {event.action}"
    raise named.wrong(key, message, "random")
