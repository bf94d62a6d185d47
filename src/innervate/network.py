"""What a kind of network is, and which kinds there are.

Nothing else in the toolkit names a network. What it wants of one it asks of its `Network`: a name,
and where each part of it stands. A part is imported when it is first asked for, so that a command
loads only what it needs; one that a network leaves out is the default for any network.
"""

import os
import pkgutil
from difflib import get_close_matches
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Any

from innervate import folders
from innervate.dialect.folder import NOTED
from innervate.folders import NetworkError as NetworkError
from innervate.parts import DEFAULTS, MADE, MEDIA, PARTS

HOME = GROUP = "innervate.networks"
FOLDERS = "INNERVATE_NETWORKS"

NO_WORDS: dict[str, str] = {}
UNFIT = "links of this kind of network are not measured"


class Network:
    """A kind of network; its parts are attributes, by the names of PARTS.

    Args:
        name: as `kind` in its scenarios.
        package: the package that its parts' places are relative to.
        rank: its place in lists for people.
        link_type: of its frames in captures: LINKTYPE_USER0 .. USER15 = 147 .. 162, which pcapng
            keeps for private use.
        key_kind: its number under a seal, 1 .. 255: what is sealed for one is not taken by another.
        **parts: where each part stands: "module" or "module:name"; and two that are named only:
            `medium`, what its nodes are joined by, if it has no parts of its own for that:
            "cables"; `over`, on a field, what medium access of another network is below it: "csma".

    Attributes:
        folder: that it was loaded from, if it is not installed.
        in_plain: what is wrong with it for other than plain runs.
    """

    folder: Path | None = None
    in_plain: str = ""

    def __init__(
        self, name: str, package: str, rank: int = 100, link_type: int = 162, key_kind: int = 255,
        **parts: str,
    ) -> None:  # fmt: skip
        self.medium, self.over = parts.pop("medium", "cables"), parts.pop("over", "")
        if self.medium not in MEDIA:
            known = ", ".join(MEDIA)
            raise TypeError(f"network {name}: no medium {self.medium!r}; there are {known}")
        for part in parts:
            if part not in PARTS:
                near = get_close_matches(part, PARTS, 1)
                hint = f"did you mean {near[0]!r}?" if near else f"there are {', '.join(PARTS)}"
                raise TypeError(f"network {name}: no part {part!r}; {hint}")
        self.name = name
        self.package = package
        self.rank = rank
        self.link_type = link_type
        self.key_kind = key_kind
        self.parts = {
            **DEFAULTS,
            **MEDIA[self.medium],
            **{part: _absolute(package, place) for part, place in parts.items()},
        }

    def __repr__(self) -> str:
        """Its name, as code that looks it up would have it: Network('skin')."""
        return f"Network({self.name!r})"

    def __getattr__(self, part: str) -> Any:
        """A part, imported when it is first asked for."""
        place = self.__dict__.get("parts", {}).get(part)
        if place is None:
            raise AttributeError(f"network {self.__dict__.get('name')} has no part {part!r}")
        module, _, name = place.partition(":")
        try:
            found: Any = import_module(module)
            if name:
                found = getattr(found, name)
        except (ImportError, AttributeError) as error:
            if self.folder is None:
                raise
            raise self._missing(part, error) from None
        if part in folders.LOOPING and self.folder is not None:
            folders.bound_loops(found, self.folder)
        if part in MADE and callable(found):
            found = found(self)
        self.__dict__[part] = found
        return found

    def _missing(self, part: str, error: Exception) -> NetworkError:
        """A part of a folder that is not where its `network.py` says."""
        assert self.folder is not None
        words = folders.blamed(error, self.folder)
        place = self.parts[part].removeprefix(f"{self.package}.")
        where = folders.line_of(self.folder, f'"{place}"')
        return NetworkError(words or f"{where}: {part}: {error}")

    def has(self, part: str) -> bool:
        """True if there is such a part, its own or the default."""
        return part in self.parts

    @property
    def writes_events(self) -> bool:
        """True if what was done to it can be written as [[event]]s.

        Nobody knows those of a network whose scenarios have keys of its own, and that says not how.
        """
        usual = {**DEFAULTS, **MEDIA[self.medium]}
        return [self.parts[one] == usual[one] for one in ("model", "event")] != [False, True]


def nothing_to_anchor(tables: dict[str, Any], source: Any) -> None:
    """A scenario without relative paths."""


def nothing_against_it(_given: Any) -> str:
    """Any plan or run will do."""
    return ""


def scripted(plan: Any) -> str:
    """Time that a script replaces cannot be watched."""
    has_script = getattr(plan.scenario.model, "script", None) is not None
    return "its [script] replaces the clock; use: innervate run" if has_script else ""


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
    from importlib.metadata import entry_points  # a tenth of what `--help` takes

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


def use(folder: str | os.PathLike[str]) -> Network:
    """The network of a folder, known by its name from now on: here, and in processes begun here.

    Loading it runs its code. A file of it that was edited since is read again.

    Raises:
        NetworkError: it is none, or is not as it must be.
    """
    home = Path(folder).resolve()
    others = [one for one in _folders() if one.resolve().name != home.name]
    was = home in [one.resolve() for one in _folders()]
    if not was or folders.is_stale(home):
        network = of_folder(home)
        os.environ[FOLDERS] = os.pathsep.join(map(str, [*others, home]))
        networks.cache_clear()
        assert networks()[network.name] is network
    return next(one for one in networks().values() if one.folder == home)


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


def accesses() -> dict[str, Any]:
    """Medium access protocols, which look into no frame, of all networks: by name, their roles."""
    return {role.name: role for other in networks().values() if other.has("boards")
            for role in other.boards if not role.frame}  # fmt: skip


def access_of(network: Network) -> Any:
    """The medium access that a network stands on: a role of another's boards (`live/board.py`).

    Raises:
        NetworkError: no network has one of that name.
    """
    found = accesses()
    if network.over not in found:
        names = " or ".join(found)
        raise NetworkError(f"network {network.name}: over can be {names}, not {network.over!r}")
    return found[network.over]


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
    found = folders.findings(folder.resolve(), network) if network.has("protocol") else []
    for one in folders.refused(found):
        raise NetworkError(str(one))
    network.in_plain = "".join(map(str, found[:1]))
    return network


def read(folder: Path) -> Network:
    """The network of a folder, however it is written; one that is installed as it is known.

    Raises:
        NetworkError: it is none.
    """
    if not folder.is_dir():
        raise NetworkError(f"{folder}: no such folder; name one with a network.py")
    for network in _installed():
        if network.package and _is_home(network, folder.resolve()):
            return network
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


def _is_home(network: Network, folder: Path) -> bool:
    """True if the package of an installed network is that folder."""
    return network.name == folder.name and any(
        Path(place).resolve() == folder for place in import_module(network.package).__path__
    )


def _taken(network: Network, other: Network) -> NetworkError:
    where = network.package
    if network.folder is not None:
        where = folders.line_of(network.folder, "Network(")
    return NetworkError(f"{where}: the name {network.name!r} is taken by {other.package}; "
                        "give the network and its folder another")  # fmt: skip


def _absolute(package: str, place: str) -> str:
    """A place within a network's package, or one that is named in full."""
    return place if place.startswith("innervate.") or not package else f"{package}.{place}"


def layouts_of(network: Any) -> Any:
    """The layouts of a network's frames, if those are what goes over a wire."""
    if not network.has("frames") or network.has("packets"):
        return ()
    return getattr(network.frames, "LAYOUTS", ())


def kinds_of(network: Any) -> frozenset[int]:
    """The kinds of frames that have a layout; none where layouts are not what goes over a wire."""
    return frozenset(kind for kind, *_ in layouts_of(network))


def dropped_of(declared: Any, layouts: Any) -> dict[Any, set[str]]:
    """By kind, the fields of a frame that its layout has no bits for."""
    names = {name for name, *_ in declared} - NOTED
    return {kind: names - {one[0] for one in fields} for kind, _name, fields in layouts}
