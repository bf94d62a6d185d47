"""Free graphs: any cells, named as you like, and the cables between them.

An end is written `name` (its first free port), `name.port` (0..3, or W, E, up, down), `pc` (the
next interface port) or `pc.<i>`.
"""

from array import array
from collections.abc import Sequence

from innervate.topology.errors import TopologyError
from innervate.topology.graph import Graph
from innervate.topology.patch import CELLS_MAX, NOTHING, PORTS, port_number

SINK_NAME = "pc"
INTERFACES_MAX = 1_048_576


def split_end(text: str) -> tuple[str, int]:
    """(name, port) of an end in words; port -1 if it is left out.

    Raises:
        TopologyError: no name, or no such port.
    """
    name, dot, port = text.partition(".") if text.startswith("pc.") else text.rpartition(".")
    if not dot:
        name, port = text, ""
    if not name.strip() or (dot and not port):
        raise TopologyError(f'"{text}" names no cell; write "n1", "n1.2" or "pc.0"')
    if not dot:
        return name, -1
    if name != SINK_NAME:
        return name, port_number(port)
    if not (port.isascii() and port.isdigit() and len(port) < 8 and int(port) < INTERFACES_MAX):
        raise TopologyError(f'"{text}" is no interface port; write "pc.0", "pc.1", ...')
    return name, int(port)


def free_graph(links: Sequence[tuple[str, str]]) -> Graph:
    """The graph of a list of cables; cells are numbered in order of appearance.

    Raises:
        TopologyError: a name or port that does not exist, a port cabled twice, a cell with more
            than four cables, an unused interface port below a used one. `subject` is
            "link.<index>", with ".a" or ".b" where one side is at fault.
    """
    ends = _parse(links)
    names = list(dict.fromkeys(n for pair in ends for n, _ in pair if n != SINK_NAME))
    if len(names) > CELLS_MAX:
        raise TopologyError(f"more than {CELLS_MAX:,} cells", "link")
    number = {name: index for index, name in enumerate(names)}
    number[SINK_NAME] = len(names)
    interfaces = _interfaces(ends)
    peer = array("i", [NOTHING]) * (PORTS * len(names) + interfaces)
    graph = Graph(len(names), interfaces, peer, (), tuple(names))
    taken = {(name, port) for pair in ends for name, port in pair if port >= 0}
    for index, pair in enumerate(ends):
        both = []
        for (name, port), side in zip(pair, "ab", strict=True):
            if port < 0:
                ports = range(len(graph.ends_of(number[name])))
                port = next((one for one in ports if (name, one) not in taken), NOTHING)
                if port < 0:
                    message = f"{name} has no port left: a cell has four; leave out a cable"
                    raise TopologyError(message, f"link.{index}.{side}")
                taken.add((name, port))
            both.append(graph.end(number[name], port))
        try:
            graph.connect(both[0], both[1])
        except TopologyError as error:
            raise TopologyError(str(error), f"link.{index}") from None
    return graph


def _parse(links: Sequence[tuple[str, str]]) -> list[list[tuple[str, int]]]:
    ends = []
    for index, pair in enumerate(links):
        sides = []
        for text, side in zip(pair, "ab", strict=True):
            try:
                sides.append(split_end(text))
            except TopologyError as error:
                raise TopologyError(str(error), f"link.{index}.{side}") from None
        ends.append(sides)
    return ends


def _interfaces(ends: list[list[tuple[str, int]]]) -> int:
    """How many interface ports the PC has; each must be used."""
    wanted = [port for pair in ends for name, port in pair if name == SINK_NAME]
    named = {port for port in wanted if port >= 0}
    count = len(named) + sum(port < 0 for port in wanted)
    if named and max(named) >= count:
        gap = min(set(range(max(named))) - named)
        message = f"the PC has a port pc.{max(named)} but nothing is on pc.{gap}; number from pc.0"
        raise TopologyError(message, "link")
    return count
