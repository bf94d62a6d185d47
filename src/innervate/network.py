"""What a kind of network is, and which kinds there are.

Nothing else in the toolkit names a network. What it wants of one it asks of its `Network`: a name,
and where each part of it stands. A part is imported when it is first asked for, so that a command
loads only what it needs; one that a network leaves out is the default for any network.
"""

from __future__ import annotations

import os
import pkgutil
from functools import cache
from importlib import import_module
from importlib.metadata import entry_points
from pathlib import Path
from typing import Any

from innervate import folders
from innervate.folders import NetworkError as NetworkError

HOME = GROUP = "innervate.networks"
FOLDERS = "INNERVATE_NETWORKS"

# Every part that a network can have, and what it is. Those with a default may be left out.
PARTS = {
    "model": "msgspec.Struct: the keys of its scenarios, with ranges and meanings",
    "check": "(source, model): raises ScenarioError at the first thing that does not fit together",
    "plan": "(scenario) -> the plan of its run, whole numbers only; `plan.kind` is the name",
    "describe": "(plan) -> str: the scenario in a few lines, without running it",
    "fault_words": '(plan, fault) -> str: "at 2 s cut pc.1 - p0 r16 c7 down"',
    "actions": "tuple of str: what can be done to it while it runs, in the order of their numbers",
    "harm": "tuple of str: those of the actions that make it worse",
    "template": "str: a commented scenario to start from; if absent, all keys as they are by "
    "themselves",
    "anchor": "(tables, source): readies a scenario's tables to be written: relative paths become "
    "absolute, what its runs refuse to be given is left out",
    "run": "module: simulate, summarize, tables_of, written_of, columns, trail, call_words",
    "tables": "tuple of Table: all tables that its runs can have",
    "received_image": "(result, time_s, window_s): what was felt, as it was received",
    "report": "(result, summary) -> str: the body of its report, HTML",
    "notebook": "(result, summary) -> str: the same for a notebook, its top and a picture",
    "figures": "module: draw(run, figure) -> a matplotlib figure",
    "summary_lines": "(run) -> list of str: what a person wants to know first",
    "summary_name": '(summary) -> str: by what name a run has it, like "skin" for `run.skin`',
    "without_events": '(summary) -> str: why a run has no events to compare; "" if it has',
    "loop_name": '(plan) -> str: the compiled loop that it runs on; "" = it needs no compiling',
    "demo": "module: SCENARIO, INTRODUCTION, LOOK, NEXT, lines(run): its chapter of `demo`",
    "sizing": "module: Question, parse_ports, size, RECOVERY: what `size` answers",
    "measured_template": "(name, network, link types, least quality) -> str: of what was measured",
    "capture": "module: LATE_US, refusal, interfaces, numbers, frames, simulate; if absent, any "
    "network of cables with `frames` has one (export/cabled.py)",
    "interface_words": 'dict: what captures call a node, by its role; others are a "node"',
    "dissector": "() -> export.dissector.Frames: its frames for Wireshark, from `frames` if absent",
    "fit": "module: Reader, tables_of, named, named_again: a scenario out of a capture",
    "unfit": "str: why no scenario comes out of its captures",
    "log": "module: looks_like_one(path), measure(path): what `fit` reads besides captures",
    "graph": "(plan) -> export.graphs.Graph: its network as a graph",
    "scenes": "(plan, tables) -> list of export.scenes.Channel: what a recording shows in space",
    "has_places": "(plan) -> bool: its nodes lie somewhere in space",
    "rerun_parts": "(rerun, plan, tables) -> export.rrd_parts.Parts: a run in space",
    "simulation": "(plan) -> sim.driver.Simulation: the network as it is watched, not yet begun; "
    "for the default `run` also by name plain, checks, observe, deliveries, trail, tap",
    "unwatchable": '(plan) -> str: why it cannot be watched; "" if it can',
    "engine": "class: web.engine.Engine, or what can do more",
    "view": "class: what the live page shows of its simulation (web/view.py)",
    "event": "(plan, fault) -> dict: the [[event]] table of a fault, without its time",
    "protocol": "module: on_start, on_frame, on_timer, on_input of a node; OUTBOX, TIMERS",
    "fields": "module: PARAMS, STATE, FRAME: the declared fields of its protocol",
    "frames": "module: LAYOUTS, KIND_BITS of its frames; encode, decode, REASONS if it has own",
    "node_file": "live.nodefile.NodeFile: the keys of its node files",
    "live_node": "(nodefile.Loaded) -> live.node.LiveNode: the node of a node file",
    "deployment": "class: live.deployment.Deployment, how a plan becomes node files and cables",
    "live_words": "module: lines, ports, heard: what its running nodes say, for people",
    "live_view": "class: web.live_view.LiveView, its running nodes on the page",
    "recovery": "module: recoveries, line, NOTHING: how it healed, from a capture",
    "verify": "module: explorations, notice, MUTANTS, hunt: what `verify` does (verify/cases.py)",
    "prove": "module: theories, MUTANTS, EXPLORERS: what `prove` does (prove/declared.py)",
    "counterexample": "(story, path): the picture of how something breaks",
    "boards": "tuple of live.board.Role: what of it runs on a board; if absent, its protocol",
    "random": "module: SHARE, drawn, smaller, trouble: networks from a number (running/fuzz.py)",
    "invariants": "module in the dialect: node_*(node, params, now), network_*(nodes, count, "
    "params): what must hold",
    "measures": "(nodes, reports, deliveries, plan) -> dict of str to number: own figures",
    "shows": "dict of str to (unit, (node, params) -> number): what pages colour nodes by, too",
    "happenings": "dict of str to (node, value) -> (kind, item) for on_input: own [[event]]s",
    "papers": "module: TITLE, AUTHORS, FIGURES, READINGS, experiment, warm_up",
}
DEFAULTS = {
    "model": "innervate.scenario.declared:CablesScenario",
    "check": "innervate.scenario.declared:check",
    "plan": "innervate.scenario.declared:plan",
    "template": "innervate.scenario.declared:template",
    "run": "innervate.running.simulating",
    "tables": "innervate.running.simulating:TABLES",
    "report": "innervate.plot.body:body",
    "notebook": "innervate.plot.body:notebook",
    "figures": "innervate.plot.figures",
    "summary_lines": "innervate.plot.lines:summary_lines",
    "graph": "innervate.export.cabled:graph",
    "scenes": "innervate.network:nothing_to_show",
    "has_places": "innervate.network:no_places",
    "unwatchable": "innervate.network:nothing_against_it",
    "engine": "innervate.web.engine:Engine",
    "view": "innervate.web.declared_view:DeclaredView",
    "anchor": "innervate.network:nothing_to_anchor",
    "describe": "innervate.scenario.cables:describe",
    "fault_words": "innervate.scenario.cables:fault_words",
    "actions": "innervate.scenario.actions.cables:ACTIONS",
    "harm": "innervate.scenario.actions.cables:HARM",
    "simulation": "innervate.sim.cables.declared:simulation",
    "verify": "innervate.verify.declared",
    "prove": "innervate.prove.declared",
    "interface_words": "innervate.network:NO_WORDS",
    "unfit": "innervate.network:UNFIT",
    "without_events": "innervate.network:nothing_against_it",
    "loop_name": "innervate.network:no_name",
    "summary_name": "innervate.network:kind_of",
    "node_file": "innervate.live.declared:DeclaredFile",
    "live_node": "innervate.live.declared:build",
    "deployment": "innervate.live.deployment:Deployment",
    "live_words": "innervate.live.words",
    "live_view": "innervate.web.live_view:LiveView",
}


NO_WORDS: dict[str, str] = {}
UNFIT = "links of this kind of network are not measured"


# Parts that stand for any network of a medium, where they are others than over cables.
MEDIA: dict[str, dict[str, str]] = {
    "cables": {},
    "channel": {
        "model": "innervate.scenario.declared_channel:ChannelScenario",
        "check": "innervate.scenario.declared_channel:check",
        "plan": "innervate.scenario.declared_channel:plan",
        "template": "innervate.scenario.declared_channel:template",
        "describe": "innervate.scenario.declared_channel:describe",
        "fault_words": "innervate.scenario.declared_channel:fault_words",
        "actions": "innervate.scenario.actions.channel:ACTIONS",
        "harm": "innervate.scenario.actions.channel:HARM",
        "simulation": "innervate.sim.channel.declared:simulation",
        "view": "innervate.web.channel_view:ChannelView",
        "live_node": "innervate.live.on_air:build",
        "deployment": "innervate.live.on_channel:ChannelDeployment",
    },
}
# Parts that can be functions of the network, which make them.
MADE = frozenset({"template"})


class Network:
    """A kind of network; its parts are attributes, by the names of PARTS.

    Args:
        name: as `kind` in its scenarios.
        package: the package that its parts' places are relative to.
        rank: its place in lists for people.
        link_type: of its frames in captures: LINKTYPE_USER0 .. USER15 = 147 .. 162, which pcapng
            keeps for private use.
        key_kind: its number under a seal, 1 .. 255: what is sealed for one is not taken by another.
        medium: what its nodes are joined by, if it has no parts of its own for that: "cables".
        **parts: where each part stands: "module" or "module:name".

    Attributes:
        folder: that it was loaded from, if it is not installed.
    """

    folder: Path | None = None

    def __init__(
        self, name: str, package: str, rank: int = 100, link_type: int = 162, key_kind: int = 255,
        medium: str = "cables", **parts: str,
    ) -> None:  # fmt: skip
        if medium not in MEDIA:
            known = ", ".join(MEDIA)
            raise TypeError(f"network {name}: no medium {medium!r}; there are {known}")
        for part in parts:
            if part not in PARTS:
                raise TypeError(f"network {name}: no part {part!r}; there are {', '.join(PARTS)}")
        self.name = name
        self.package = package
        self.rank = rank
        self.link_type = link_type
        self.key_kind = key_kind
        self.medium = medium
        self.parts = {
            **DEFAULTS,
            **MEDIA[medium],
            **{part: _absolute(package, place) for part, place in parts.items()},
        }

    def __repr__(self) -> str:
        """The network as "Network('skin')"."""
        return f"Network({self.name!r})"

    def __getattr__(self, part: str) -> Any:
        """A part, imported when it is first asked for."""
        place = self.__dict__.get("parts", {}).get(part)
        if place is None:
            raise AttributeError(f"network {self.__dict__.get('name')} has no part {part!r}")
        module, _, name = place.partition(":")
        found: Any = import_module(module)
        if name:
            found = getattr(found, name)
        if part in MADE and callable(found):
            found = found(self)
        self.__dict__[part] = found
        return found

    def has(self, part: str) -> bool:
        """True if there is such a part, its own or the default."""
        return part in self.parts


def nothing_to_anchor(tables: dict[str, Any], source: Any) -> None:
    """A scenario without relative paths."""


def nothing_against_it(_given: Any) -> str:
    """Any plan or run will do."""
    return ""


def no_name(plan: Any) -> str:
    """A loop that needs no compiling, as far as is known."""
    return ""


def kind_of(summary: Any) -> str:
    """The kind of network that a summary is of."""
    kind: str = summary["kind"]
    return kind


def nothing_to_show(plan: Any, tables: Any) -> list[Any]:
    """A recording without a scene."""
    return []


def no_places(plan: Any) -> bool:
    """Nodes that lie nowhere in particular."""
    return False


@cache
def networks() -> dict[str, Network]:
    """All kinds of networks by name, in the order of their ranks.

    They are the toolkit's own (every folder of `innervate.networks` with a `network.py`), those of
    installed packages (entry points of the group `innervate.networks`, each a `Network`), and
    those in the folders that the environment names in INNERVATE_NETWORKS, separated as in PATH:
    each folder is a package with a `network.py` in it, whose `NETWORK` says what it is.

    Raises:
        NetworkError: one that was named cannot be loaded, or a name is taken twice.
    """
    made = {network.name: network for network in sorted(_installed(), key=lambda n: n.rank)}
    for folder in _folders():
        network = of_folder(folder)
        if network.name in made:
            raise _taken(network, made[network.name])
        made[network.name] = network
    return dict(sorted(made.items(), key=lambda one: one[1].rank))


@cache
def _installed() -> tuple[Network, ...]:
    """The toolkit's own networks, and those of installed packages."""
    home = import_module(HOME)
    found = [import_module(f"{HOME}.{folder.name}.network").NETWORK
             for folder in pkgutil.iter_modules(home.__path__) if folder.ispkg]  # fmt: skip
    found += [_entry(point) for point in entry_points(group=GROUP)]
    for place, network in enumerate(found):
        for other in found[:place]:
            if other.name == network.name:
                raise _taken(network, other)
    return tuple(found)


def _folders() -> list[Path]:
    return [Path(one) for one in os.environ.get(FOLDERS, "").split(os.pathsep) if one]


def first() -> str:
    """The kind of network that is meant where none is named."""
    return next(iter(networks()))


def use(folder: Path) -> Network:
    """The network of a folder, known by its name from now on: here, and in processes begun here.

    Loading it runs its code. A file of it that was edited since is read again.

    Raises:
        NetworkError: it is none, or is not as it must be.
    """
    folder = folder.resolve()
    others = [one for one in _folders() if one.resolve().name != folder.name]
    was = folder in [one.resolve() for one in _folders()]
    if not was or folders.is_stale(folder):
        network = of_folder(folder)
        os.environ[FOLDERS] = os.pathsep.join(map(str, [*others, folder]))
        networks.cache_clear()
        assert networks()[network.name] is network
    return next(one for one in networks().values() if one.folder == folder)


def find(kind: str, *places: Path) -> Network | None:
    """A network by its name: one that is installed, or else a folder called so.

    Args:
        kind: its name.
        places: folders that are looked into: for a folder of that name, or one that has it.

    Raises:
        NetworkError: such a folder cannot be loaded.
    """
    for network in _installed():
        if network.name == kind:
            return network
    if kind.isidentifier():
        for place in map(Path.resolve, places):
            for folder in (place / kind, *([place] if place.name == kind else [])):
                if folders.is_one(folder):
                    return use(folder)
    known = networks().get(kind)
    return use(known.folder) if known is not None and known.folder is not None else known


def known(kind: str, *places: Path) -> Network:
    """A network by its name, as `find` has it; looked for in the working folder, too.

    Raises:
        NetworkError: there is none, or it cannot be loaded.
    """
    network = find(kind, *places, Path())
    if network is None:
        raise NetworkError(f"no network here is called {kind!r}; name its folder: --network DIR")
    return network


def _entry(point: Any) -> Network:
    try:
        found = point.load()
    except (ImportError, AttributeError) as error:
        message = f"the installed network {point.name} cannot be loaded: {error}"
        raise NetworkError(message) from error
    if not isinstance(found, Network):
        raise NetworkError(f"{point.value} is no Network: {type(found).__name__}")
    return found


def of_folder(folder: Path) -> Network:
    """The network of a folder, checked as it is written.

    Raises:
        NetworkError: it is none, or the first thing that is wrong with it.
    """
    network = read(folder)
    for one in folders.findings(folder.resolve(), network) if network.has("protocol") else []:
        raise NetworkError(str(one))
    return network


def read(folder: Path) -> Network:
    """The network of a folder, however it is written.

    Raises:
        NetworkError: it is none.
    """
    if not folder.is_dir():
        raise NetworkError(f"{folder}: no such folder; name one with a network.py")
    if not (folder / folders.NETWORK_FILE).is_file():
        raise NetworkError(f"{folder} holds no network.py")
    if not folder.resolve().name.isidentifier():
        raise NetworkError(f"{folder}: a network's folder is named in letters, digits and _, "
                           "like a Python module")  # fmt: skip
    found, where = folders.load(folder), folders.shown(folder.resolve() / folders.NETWORK_FILE)
    if not isinstance(found, Network):
        raise NetworkError(f"{where}: NETWORK is no Network: {type(found).__name__}")
    if found.name != folder.resolve().name:
        raise NetworkError(f"{where}: the network is called {found.name!r} and its folder "
                           f"{folder.name!r}; give both one name")  # fmt: skip
    found.folder = folder.resolve()
    return found


def _taken(network: Network, other: Network) -> NetworkError:
    where = network.package
    if network.folder is not None:
        path = network.folder / folders.NETWORK_FILE
        lines = path.read_text(encoding="utf-8").splitlines()
        line = next((n for n, text in enumerate(lines, 1) if "Network(" in text), 1)
        where = f"{folders.shown(path)}:{line}"
    return NetworkError(f"{where}: the name {network.name!r} is taken by {other.package}; "
                        "give the network and its folder another")  # fmt: skip


def _absolute(package: str, place: str) -> str:
    """A place within a network's package, or one that is named in full."""
    return place if place.startswith("innervate.") or not package else f"{package}.{place}"
