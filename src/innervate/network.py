"""What a kind of network is, and which kinds there are.

Nothing else in the toolkit names a network. What it wants of one it asks of its `Network`: a name,
and where each part of it stands. A part is imported when it is first asked for, so that a command
loads only what it needs; one that a network leaves out is the default for any network.
"""

from __future__ import annotations

import os
import pkgutil
import sys
from functools import cache
from importlib import import_module
from importlib.metadata import entry_points
from pathlib import Path
from typing import Any

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
    "prove": "module: theories, MUTANTS, NO_SAFETY: what `prove` does (prove/declared.py)",
    "counterexample": "(story, path): the picture of how something breaks",
    "boards": "tuple of live.board.Role: what of it runs on a board; if absent, its protocol",
    "random": "module: SHARE, drawn, smaller, trouble: networks from a number (running/fuzz.py)",
    "papers": "module: TITLE, AUTHORS, FIGURES, READINGS, experiment, warm_up",
}
DEFAULTS = {
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


class NetworkError(Exception):
    """A network that was named cannot be loaded."""


class Network:
    """A kind of network; its parts are attributes, by the names of PARTS.

    Args:
        name: as `kind` in its scenarios.
        package: the package that its parts' places are relative to.
        rank: its place in lists for people.
        link_type: of its frames in captures: LINKTYPE_USER0 .. USER15 = 147 .. 162, which pcapng
            keeps for private use.
        key_kind: its number under a seal, 1 .. 255: what is sealed for one is not taken by another.
        **parts: where each part stands: "module" or "module:name".
    """

    def __init__(
        self, name: str, package: str, rank: int = 100, link_type: int = 162, key_kind: int = 255,
        **parts: str,
    ) -> None:  # fmt: skip
        for part in parts:
            if part not in PARTS:
                raise TypeError(f"network {name}: no part {part!r}; there are {', '.join(PARTS)}")
        self.name = name
        self.package = package
        self.rank = rank
        self.link_type = link_type
        self.key_kind = key_kind
        self.parts = {
            **DEFAULTS,
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
    home = import_module(HOME)
    found = [import_module(f"{HOME}.{folder.name}.network").NETWORK
             for folder in pkgutil.iter_modules(home.__path__) if folder.ispkg]  # fmt: skip
    found += [_entry(point) for point in entry_points(group=GROUP)]
    folders = os.environ.get(FOLDERS, "").split(os.pathsep)
    found += [_in_folder(Path(folder)) for folder in folders if folder]
    made: dict[str, Network] = {}
    for network in sorted(found, key=lambda n: n.rank):
        if made.setdefault(network.name, network) is not network:
            other = made[network.name].package
            raise NetworkError(f"{network.package} and {other} are both called {network.name!r}")
    return made


def first() -> str:
    """The kind of network that is meant where none is named."""
    return next(iter(networks()))


def add_folder(folder: Path) -> Network:
    """Make a network known to this process that stands in a folder with a `network.py`.

    Raises:
        NetworkError: it cannot be loaded, or another one has its name.
    """
    found = _in_folder(folder, str(folder))
    other = networks().setdefault(found.name, found)
    if other.package != found.package:
        raise NetworkError(f"{folder} and {other.package} are both called {found.name!r}")
    return other


def _entry(point: Any) -> Network:
    try:
        return _checked(point.load(), point.value)
    except (ImportError, AttributeError) as error:
        message = f"the installed network {point.name} cannot be loaded: {error}"
        raise NetworkError(message) from error


def _in_folder(folder: Path, named: str = "") -> Network:
    if not (folder / "network.py").is_file():
        raise NetworkError(f"{named or f'{FOLDERS}: {folder}'} holds no network.py")
    where = str(folder.resolve().parent)
    if where not in sys.path:
        sys.path.append(where)
    try:
        return _checked(import_module(f"{folder.resolve().name}.network").NETWORK, str(folder))
    except (ImportError, AttributeError) as error:
        raise NetworkError(
            f"{named or f'{FOLDERS}: {folder}'} cannot be loaded: {error}"
        ) from error


def _checked(found: Any, where: str) -> Network:
    if not isinstance(found, Network):
        raise NetworkError(f"{where} is no Network: {type(found).__name__}")
    return found


def _absolute(package: str, place: str) -> str:
    """A place within a network's package, or one that is named in full."""
    return place if place.startswith("innervate.") or not package else f"{package}.{place}"
