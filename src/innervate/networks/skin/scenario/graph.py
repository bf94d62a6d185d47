"""From a scenario's tables to its graph, and to the nodes that they name."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from innervate import topology
from innervate.networks.skin.scenario.model import BodyTable, CellTable, SkinScenario
from innervate.scenario.errors import ScenarioError
from innervate.scenario.lines import Key
from innervate.scenario.load import Scenario
from innervate.scenario.source import Source, dotted
from innervate.topology import PORTS, Graph, TopologyError

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
            graph = topology.free_graph([(link.a, link.b) for link in model.link])
        except TopologyError as error:
            raise source.error(_key(error.subject), str(error)) from None
    return graph


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
        cells, most = 0, topology.CELLS_MAX
        for index, patch in enumerate(model.patch):
            cells += patch.columns * patch.rows * patch.count
            if cells > most:
                message = f"the skin has {cells:,} cells; at most {most:,} can be simulated"
                raise source.error(("patch", index), message)
            for _ in range(patch.count):
                yield patch.columns, patch.rows, patch.wiring

    graph = topology.from_patches(shapes())
    named = Named(source, graph)
    for index, cable in enumerate(model.cable):
        key: Key = ("cable", index)
        a, b = named.free_end(cable.a, (*key, "a")), named.free_end(cable.b, (*key, "b"))
        with named.told_at(key):
            graph.connect(a, b)
    for index, interface in enumerate(model.interface):
        key = ("interface", index)
        cell = named.cell(interface, key)
        with named.told_at(key, *(() if interface.port is None else ("port",))):
            graph.add_interface(cell, interface.port)
    _copies(named, model)
    return graph


def _copies(named: Named, model: SkinScenario) -> None:
    """Join the copies that `count` makes, and give every n-th one an interface port."""
    graph, first = named.graph, 0
    for index, patch in enumerate(model.patch):
        with named.told_at(("patch", index)):
            if patch.joined:
                topology.join_chain(graph, first, patch.count)
            for copy in range(0, patch.count, patch.interfaces_every or patch.count + 1):
                if patch.interfaces_every:
                    there = graph.patches[first + copy]
                    graph.add_interface(there.cell(0, there.columns // 2))
        first += patch.count


def _body(source: Source, body: BodyTable) -> Graph:
    try:
        folder = Path(source.folder)
        cells = topology.cells_from_urdf(body.urdf, body.links, folder, body.pitch_mm)
        return topology.body_graph(*cells, body.reach_mm, body.interfaces)
    except TopologyError as error:
        key: Key = ("body", error.subject) if error.subject else ("body",)
        raise source.error(key, f"{dotted(key)}: {error}") from None


def numbered(what: str, count: int) -> str:
    """The numbers that things have, in words; count >= 1."""
    return f"the only {what} is 0" if count == 1 else f"they are 0 to {count - 1}"


class Named:
    """The nodes and ports of a graph, as a scenario names them.

    What is not there is a ScenarioError of the key that names it.
    """

    def __init__(self, source: Source, graph: Graph) -> None:
        self.source, self.graph = source, graph

    def wrong(self, key: Key, message: str, *below: int | str) -> ScenarioError:
        """The error of a key, which its message begins with; it may stand at a key below."""
        return self.source.error((*key, *below), f"{dotted(key)}: {message}")

    @contextmanager
    def told_at(self, key: Key, *below: int | str) -> Iterator[None]:
        """What the topology refuses inside is the error of a key, or of one below."""
        try:
            yield
        except TopologyError as error:
            raise self.wrong(key, str(error), *below) from None

    def cell(self, where: CellTable | str, key: Key) -> int:
        """Number of the cell that a table or a name means."""
        graph = self.graph
        if isinstance(where, str):
            node, port = self.node_and_port(where, key)
            if node == graph.cells or port >= 0:
                raise self.wrong(key, f'"{where}" is not the name of a cell')
            return node
        if not graph.patches:
            raise self.wrong(key, 'this skin has no patches; name the cell, like node = "n1"')
        if where.patch >= len(graph.patches):
            are = numbered("patch", len(graph.patches))
            raise self.wrong(key, f"there is no patch {where.patch}; {are}", "patch")
        try:
            return graph.patches[where.patch].cell(where.row, where.column)
        except TopologyError as error:
            which = f" in patch {where.patch}" if len(graph.patches) > 1 else ""
            message = f"{dotted(key)}{which}: {error}"
            raise self.source.error((*key, error.subject), message) from None

    def port(self, port: int | str, key: Key) -> int:
        """0..3 from a port's number or name."""
        with self.told_at(key):
            return topology.port_number(port)

    def cell_and_port(self, where: CellTable | str, key: Key) -> tuple[int, int]:
        """The node that a table or a name means, and the port, -1 where none is named."""
        if isinstance(where, str):
            return self.node_and_port(where, key)
        node = self.cell(where, key)
        return node, -1 if where.port is None else self.port(where.port, (*key, "port"))

    def free_end(self, where: CellTable | str, key: Key) -> int:
        """A free end to plug a cable into: the port named, or the cell's first free one."""
        node, port = self.cell_and_port(where, key)
        if node == self.graph.cells:
            raise self.wrong(key, "cables to the PC are [[interface]] tables")
        if port >= 0:
            return PORTS * node + port
        with self.told_at(key):
            return self.graph.free_end(node)

    def node_and_port(self, text: str, key: Key) -> tuple[int, int]:
        """(node, port) that a text means: "n1", "n1.2", "n1 E", "p0 r3 c4.W", "pc", "pc.0".

        The port is -1 where the text names none.
        """
        graph, text = self.graph, text.strip()[:NAME_LENGTH]
        node = self._node(text, key)
        if node is not None:
            return node, -1
        match = _SPLIT.fullmatch(text)
        node = self._node(match[1].strip(), key) if match else None
        if match is None or node is None:
            some = graph.label(0) + (f", {graph.label(1)}" if graph.cells > 1 else "")
            raise self.wrong(key, f'no node is called "{text[:60]}"; they are {some}, ..., pc')
        if node < graph.cells:
            return node, self.port(match[2], key)
        if not match[2].isdecimal() or len(match[2]) > 8 or int(match[2]) >= graph.interfaces:
            raise self.wrong(key, f"the PC has the ports pc.0 to pc.{graph.interfaces - 1}")
        return node, int(match[2])

    def _node(self, text: str, key: Key) -> int | None:
        if text == "pc":
            return self.graph.cells
        if text in self.graph.names:
            return self.graph.names.index(text)
        match = _CELL.fullmatch(text) if self.graph.patches else None
        if match is None:
            return None
        patch, row, column = (int(part) for part in match.groups())
        return self.cell(CellTable(patch=patch, row=row, column=column), key)


def anchor(tables: dict[str, Any], source: Source) -> None:
    """Make a relative `body.urdf` the full path."""
    body = tables.get("body")
    if body is not None and not body["urdf"].startswith("package:"):
        body["urdf"] = str((Path(source.folder) / body["urdf"]).absolute())
