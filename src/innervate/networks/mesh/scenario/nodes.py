"""The nodes of a mesh: their names and numbers, and links or places that are given."""

import difflib
import os
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

from innervate.networks.mesh.scenario.left_out import left_out
from innervate.networks.mesh.scenario.model import ImportTable, MeshScenario
from innervate.scenario.bundled import FOLDER
from innervate.scenario.lines import Key
from innervate.scenario.source import Source, dotted, shown
from innervate.topology import measured
from innervate.topology.errors import TopologyError
from innervate.topology.placement import Point

NODES_MAX = 254
CLUSTERED_MAX = 2_000  # in all clusters: so many are planned in a minute
RESERVED = ("all", "random", "monitor", "gateway")
BUNDLED_IMPORTS = "freifunk/"


@dataclass(slots=True)
class Nodes:
    """Who is there, and what the scenario gives of them."""

    source: Source  # for error messages
    names: list[str]  # per node, all different
    # Per node (x, y) in cm; empty where none are given.
    points: list[Point] = field(default_factory=list)
    # (a, b) with a < b -> quality a to b and b to a, if links are given.
    links: dict[tuple[int, int], tuple[float, float]] = field(default_factory=dict)
    # Of one cluster of several: the names of all, by which numbers in the file go.
    everybody: list[str] = field(default_factory=list)
    # Why a name that is none here is in an imported file all the same; "" if it is not.
    left_out: Callable[[str], str] = lambda _: ""
    _numbers: dict[str, int] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self._numbers = {name: number for number, name in enumerate(self.names)}

    def number(self, key: Key, given: int | str) -> int:
        """The number of a node given by number or name.

        Raises:
            ScenarioError: there is no such node.
        """
        if isinstance(given, int):
            everybody = self.everybody or self.names
            if 0 <= given < len(everybody):
                return self._numbers[everybody[given]]
            last = len(everybody) - 1
            message = f"{dotted(key)}: there is no node {given}; they are numbered 0 to {last}"
            raise self.source.error(key, message)
        if given in self._numbers:
            return self._numbers[given]
        if why := self.left_out(given):
            raise self.source.error(key, f"{dotted(key)}: {why}")
        hint = alike(given, self.everybody or self.names)
        raise self.source.error(key, f"{dotted(key)}: there is no node {shown(given)}{hint}")

    def is_here(self, given: int | str) -> bool:
        """False for a node of another cluster."""
        if isinstance(given, int) and 0 <= given < len(self.everybody):
            given = self.everybody[given]
        return given in self._numbers or given not in self.everybody


def most_of(model: MeshScenario) -> int:
    """How many nodes a scenario may have."""
    return NODES_MAX if model.clusters is None else CLUSTERED_MAX


def too_many(count: int, most: int = NODES_MAX) -> str:
    """Why a network of that many nodes cannot be: the reason is the same in every mode."""
    if most == CLUSTERED_MAX:
        return f"{count} nodes are too many: clusters have at most {CLUSTERED_MAX} together"
    return (
        f"{count} nodes are too many: an address is one byte, so a mesh has at most {NODES_MAX} "
        "of them, in the table-free mode (protocol.tables = false) too; [clusters] makes several "
        f"meshes of up to {CLUSTERED_MAX} nodes"
    )


def listed(names: list[str], most: int = 4) -> str:
    """Names in a row, a few of them."""
    more = f" and {len(names) - most} more" if len(names) > most else ""
    return ", ".join(names[:most]) + more


def count_of(number: int, thing: str) -> str:
    """A count with its noun: "no holes", "1 good link", "12 nodes"."""
    return f"{number or 'no'} {thing}{'s' if number != 1 else ''}"


def there_are(number: int, thing: str) -> str:
    """How many there are: "there is 1 node", "there are 9 nodes"."""
    return f"there {are(number)} {count_of(number, thing)}"


def are(number: int) -> str:
    """The verb that goes with a count."""
    return "is" if number == 1 else "are"


def nodes_of(model: MeshScenario, source: Source) -> Nodes:
    """The nodes of a scenario.

    Raises:
        ScenarioError: a name twice, links to nobody, or a file that cannot be imported.
    """
    if model.import_ is not None:
        return _imported(model, source)
    if model.node:
        names = [table.name or f"n{i}" for i, table in enumerate(model.node)]
        for i, name in enumerate(names):
            if name in names[:i]:
                raise source.error(("node", i), f"there are two nodes {shown(name)}; rename one")
        points = [(round(100 * table.x_m), round(100 * table.y_m)) for table in model.node
                  if table.x_m is not None and table.y_m is not None]  # fmt: skip
        found = Nodes(source, names, points if len(points) == len(names) else [])
    elif model.nodes is not None:
        found = Nodes(source, [f"n{i}" for i in range(model.nodes)])
    else:
        ends = [end for table in model.link for end in (table.a, table.b)]
        found = Nodes(source, list(dict.fromkeys(str(end) for end in ends)))
    for i, table in enumerate(model.link):
        a, b = (_end(model, found, (*("link", i), side), end)
                for side, end in (("a", table.a), ("b", table.b)))  # fmt: skip
        if a == b:
            raise source.error(("link", i), f"link.{i} joins {found.names[a]} with itself")
        if (min(a, b), max(a, b)) in found.links:
            both = f"{found.names[a]} and {found.names[b]}"
            raise source.error(("link", i), f"link.{i} joins {both} a second time; leave one out")
        there, back = (
            table.quality if isinstance(table.quality, tuple) else (table.quality, table.quality)
        )
        found.links[min(a, b), max(a, b)] = (there, back) if a < b else (back, there)
    if len(found.names) > most_of(model):
        raise source.error(("link",), too_many(len(found.names), most_of(model)))
    return found


def _end(model: MeshScenario, nodes: Nodes, key: Key, end: int | str) -> int:
    free = model.nodes is None and not model.node  # links name whom they like
    return nodes.number(key, str(end) if free else end)


def _imported(model: MeshScenario, source: Source) -> Nodes:
    table = model.import_
    assert table is not None
    whole = found_at(table, source)
    try:
        found = whole.kept(table.min_tq)
    except TopologyError as error:
        message = f"{table.file or table.topohub}: {error}"
        raise source.error(("import", error.subject or "min_tq"), message) from None
    if table.around is not None or table.nodes is not None:
        middle = _middle(model, whole, found, source)
        found = found.around(middle, table.nodes or most_of(model))
    elif table.largest_component:
        found = found.largest()
    if len(found.names) > most_of(model):
        least = whole.least_for(NODES_MAX, in_one=table.largest_component)
        remedy = f"import.nodes = {NODES_MAX} takes those around the best connected one"
        if least is not None:
            remedy = f"import.min_tq = {least:g} leaves few enough, or {remedy}"
        raise source.error(("import",), f"{too_many(len(found.names))}; {remedy}")
    for name in RESERVED:
        if name in found.names:
            message = f"a node is called {shown(name)}, which means something else; rename it"
            raise source.error(("import",), f"{table.file or table.topohub}: {message}")
    why = partial(left_out, table, whole, most=most_of(model))
    return Nodes(source, found.names, found.points, dict(found.links), left_out=why)


def found_at(table: ImportTable, source: Source) -> measured.Measured:
    """The whole network that an [import] names.

    Raises:
        ScenarioError: it cannot be read.
    """
    try:
        if table.file is not None:
            return measured.read(import_path(table.file, source), table.types)
        return measured.from_topohub(table.topohub or "")
    except TopologyError as error:
        key = error.subject or ("file" if table.file is not None else "topohub")
        raise source.error(("import", key), str(error)) from None


def _middle(
    model: MeshScenario, whole: measured.Measured, found: measured.Measured, source: Source
) -> int:
    """The node that import.around names; left out, the best connected one."""
    table = model.import_
    assert table is not None
    if table.around is None:
        return found.best_connected()
    name, key = str(table.around), ("import", "around")
    if name in found.names:
        return found.names.index(name)
    if why := left_out(table, whole, name, most_of(model)):
        raise source.error(key, f"import.around: {why}")
    hint = alike(name, whole.names)
    raise source.error(key, f"import.around: there is no node {shown(name)}{hint}")


def alike(name: str, names: list[str]) -> str:
    """'; did you mean "n12" or "n21"?': names like it; where there are none, those there are."""
    close = difflib.get_close_matches(name[:100], names, 3, 0.6)
    if close:
        return f"; did you mean {' or '.join(map(shown, close))}?"
    return f"; there are {', '.join(names) if len(names) <= 12 else f'{names[0]} to {names[-1]}'}"


def import_path(name: str, source: Source) -> Path:
    """The file of an import: bundled ones by name, others from the scenario's folder."""
    if name.startswith(BUNDLED_IMPORTS):
        bundled = FOLDER / f"{name.removesuffix('.json')}.json"
        if bundled.is_file():
            return bundled
    path = Path(source.folder) / name
    if "\0" in name:
        return path
    short = os.path.normpath(path)  # "a/../b" is not "b" where a is a link to a folder
    return Path(short) if os.path.realpath(short) == os.path.realpath(path) else path


def anchor(tables: dict[str, Any], source: Source) -> None:
    """Make a relative `import.file` the full path, unless it is a bundled one."""
    imported = tables.get("import")
    if imported is not None and imported["file"] is not None:
        path = import_path(imported["file"], source)
        if FOLDER not in path.parents:
            imported["file"] = str(path.absolute())
