"""From a scenario's tables to its graph."""

import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from innervate.networks.skin.scenario.model import (
    BodyTable,
    CellTable,
    InterfaceTable,
    SkinScenario,
)
from innervate.scenario.lines import Key
from innervate.scenario.load import Scenario
from innervate.scenario.source import Source, dotted
from innervate.topology import (
    CELLS_MAX,
    PORTS,
    Graph,
    TopologyError,
    body_graph,
    cells_from_urdf,
    free_graph,
    from_patches,
    join_chain,
    port_number,
)

WIRE_DEPTH = 254
NAME_LENGTH = 300
_CELL = re.compile(r"p(\d{1,9})\s*r(\d{1,9})\s*c(\d{1,9})", re.ASCII)
_SPLIT = re.compile(r"(.*\S)[.\s]\s*(\S+)", re.DOTALL)


def build_graph(scenario: Scenario) -> Graph:
    """The graph a scenario describes.

    Raises:
        ScenarioError: cells, ports or files that are not there, a port cabled twice, cells that
            no cable connects to the PC.
    """
    model, source = scenario.model, scenario.source
    if model.patch:
        graph = _patched(source, model)
    elif model.body is not None:
        graph = _body(source, model.body)
    else:
        try:
            graph = free_graph([(link.a, link.b) for link in model.link])
        except TopologyError as error:
            raise source.error(_key(error.subject), str(error)) from None
    return graph


@contextmanager
def _told_at(source: Source, key: Key, name: str = "") -> Iterator[None]:
    """What the topology refuses inside is the error of a key; `name` if that is not the key's."""
    try:
        yield
    except TopologyError as error:
        raise source.error(key, f"{name or dotted(key)}: {error}") from None


def check_reach(source: Source, graph: Graph, depths: list[int], max_depth: int) -> None:
    """Refuse cells without a way to the PC, and skins deeper than `max_depth` hops."""
    if graph.interfaces == 0:
        how = "an [[interface]]" if graph.patches else 'a [[link]] to "pc.0"'
        raise source.error((), f"the PC has no interface port; add {how}")
    if -1 in depths:
        lost = depths.index(-1)
        count = sum(depth < 0 for depth in depths)
        others = f" and {count - 1} more" if count > 1 else ""
        index = graph.patch_of(lost)
        what = f"patch {index}" if index >= 0 and count >= graph.patches[index].cells else ""
        what = what or f"{graph.label(lost)}{others}"
        plural = "are" if not what.startswith("patch") and others else "is"
        how = "a [[cable]] or an [[interface]]" if graph.patches else "a [[link]]"
        raise source.error((), f"{what} {plural} not connected to the PC; add {how}")
    deepest = max(depths)
    if deepest > max_depth:
        cell = graph.label(depths.index(deepest))
        fix = "add an interface or raise protocol.max_depth"
        fix = fix if deepest <= WIRE_DEPTH else f"add interfaces, as the wire carries {WIRE_DEPTH}"
        raise source.error(
            ("protocol", "max_depth"),
            f"{cell} is {deepest} hops from the PC but protocol.max_depth is {max_depth}; {fix}",
        )


def _key(subject: str) -> Key:
    return tuple(int(p) if p.isdigit() else p for p in subject.split(".")) if subject else ()


def _patched(source: Source, model: SkinScenario) -> Graph:
    def shapes() -> Iterator[tuple[int, int, str]]:
        cells = 0
        for index, patch in enumerate(model.patch):
            cells += patch.columns * patch.rows * patch.count
            if cells > CELLS_MAX:
                message = f"the skin has {cells:,} cells; at most {CELLS_MAX:,} can be simulated"
                raise source.error(("patch", index), message)
            for _ in range(patch.count):
                yield patch.columns, patch.rows, patch.wiring

    graph = from_patches(shapes())
    for index, cable in enumerate(model.cable):
        key: Key = ("cable", index)
        a = end_at(source, graph, cable.a, (*key, "a"))
        b = end_at(source, graph, cable.b, (*key, "b"))
        with _told_at(source, key):
            graph.connect(a, b)
    for index, interface in enumerate(model.interface):
        _interface(source, graph, interface, ("interface", index))
    _copies(source, graph, model)
    return graph


def _interface(source: Source, graph: Graph, interface: InterfaceTable, key: Key) -> None:
    where = CellTable(patch=interface.patch, row=interface.row, column=interface.column)
    cell = cell_at(source, graph, where, key)
    with _told_at(source, key if interface.port is None else (*key, "port"), dotted(key)):
        graph.add_interface(cell, interface.port)


def _copies(source: Source, graph: Graph, model: SkinScenario) -> None:
    """Join the copies that `count` makes, and give every n-th one an interface port."""
    first = 0
    for index, patch in enumerate(model.patch):
        with _told_at(source, ("patch", index)):
            if patch.joined:
                join_chain(graph, first, patch.count)
            for copy in range(0, patch.count, patch.interfaces_every or patch.count + 1):
                if patch.interfaces_every:
                    there = graph.patches[first + copy]
                    graph.add_interface(there.cell(0, there.columns // 2))
        first += patch.count


def _body(source: Source, body: BodyTable) -> Graph:
    try:
        names, places = cells_from_urdf(body.urdf, body.links, Path(source.folder), body.pitch_mm)
        wanted = body.interfaces
        return body_graph(names, places, body.reach_mm, wanted)
    except TopologyError as error:
        key: Key = ("body", error.subject) if error.subject else ("body",)
        raise source.error(key, f"{dotted(key)}: {error}") from None


def numbered(what: str, count: int) -> str:
    """The numbers that things have, in words; count >= 1."""
    return f"the only {what} is 0" if count == 1 else f"they are 0 to {count - 1}"


def cell_at(source: Source, graph: Graph, where: CellTable | str, key: Key) -> int:
    """Number of the cell that a table or a name means.

    Raises:
        ScenarioError: there is no such cell.
    """
    if isinstance(where, str):
        node, port = node_and_port(source, graph, where, key)
        if node == graph.cells or port >= 0:
            raise source.error(key, f'{dotted(key)}: "{where}" is not the name of a cell')
        return node
    if not graph.patches:
        message = f'{dotted(key)}: this skin has no patches; name the cell, like node = "n1"'
        raise source.error(key, message)
    if where.patch >= len(graph.patches):
        are = numbered("patch", len(graph.patches))
        message = f"{dotted(key)}: there is no patch {where.patch}; {are}"
        raise source.error((*key, "patch"), message)
    try:
        return graph.patches[where.patch].cell(where.row, where.column)
    except TopologyError as error:
        which = f" in patch {where.patch}" if len(graph.patches) > 1 else ""
        raise source.error((*key, error.subject), f"{dotted(key)}{which}: {error}") from None


def end_at(source: Source, graph: Graph, where: CellTable | str, key: Key) -> int:
    """A free end to plug a cable into: the port named, or the cell's first free one."""
    if isinstance(where, str):
        node, port = node_and_port(source, graph, where, key)
        if node == graph.cells:
            message = f"{dotted(key)}: cables to the PC are [[interface]] tables"
            raise source.error(key, message)
    else:
        node = cell_at(source, graph, where, key)
        port = -1 if where.port is None else port_at(source, where.port, (*key, "port"))
    if port >= 0:
        return PORTS * node + port
    with _told_at(source, key):
        return graph.free_end(node)


def port_at(source: Source, port: int | str, key: Key) -> int:
    """0..3 from a port's number or name."""
    with _told_at(source, key):
        return port_number(port)


def node_and_port(source: Source, graph: Graph, text: str, key: Key) -> tuple[int, int]:
    """(node, port) that a text means: "n1", "n1.2", "n1 E", "p0 r3 c4.W", "pc", "pc.0".

    The port is -1 where the text names none.

    Raises:
        ScenarioError: no such node or port.
    """
    text = text.strip()[:NAME_LENGTH]
    node = _node(source, graph, text, key)
    if node is not None:
        return node, -1
    match = _SPLIT.fullmatch(text)
    node = _node(source, graph, match[1].strip(), key) if match else None
    if match is None or node is None:
        some = graph.label(0) + (f", {graph.label(1)}" if graph.cells > 1 else "")
        message = f'{dotted(key)}: no node is called "{text[:60]}"; they are {some}, ..., pc'
        raise source.error(key, message)
    if node < graph.cells:
        return node, port_at(source, match[2], key)
    if not match[2].isdecimal() or len(match[2]) > 8 or int(match[2]) >= graph.interfaces:
        message = f"{dotted(key)}: the PC has the ports pc.0 to pc.{graph.interfaces - 1}"
        raise source.error(key, message)
    return node, int(match[2])


def _node(source: Source, graph: Graph, text: str, key: Key) -> int | None:
    if text == "pc":
        return graph.cells
    if text in graph.names:
        return graph.names.index(text)
    match = _CELL.fullmatch(text) if graph.patches else None
    if match is None:
        return None
    patch, row, column = (int(part) for part in match.groups())
    return cell_at(source, graph, CellTable(patch=patch, row=row, column=column), key)


def anchor(tables: dict[str, Any], source: Source) -> None:
    """Make a relative `body.urdf` the full path."""
    body = tables.get("body")
    if body is not None and not body["urdf"].startswith("package:"):
        body["urdf"] = str((Path(source.folder) / body["urdf"]).absolute())
