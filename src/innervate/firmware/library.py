"""What a maker gets: the role that was meant, its parameters, and the files of its library."""

import re
from importlib import resources
from pathlib import Path
from pkgutil import resolve_name
from typing import Any, NamedTuple

from innervate import scenario
from innervate.firmware.emit import Library
from innervate.firmware.errors import FirmwareError
from innervate.firmware.texts import filled, renamed, shipped
from innervate.firmware.wire import Wire, coded_of
from innervate.folders import not_for_boards
from innervate.live.board import Role, only, roles_of
from innervate.live.parameters import check_parameters, settings_of
from innervate.network import Network, networks, use

BESIDE = ("innervate_wire.h", "innervate_wire.c", "innervate_port.h")
SEAL = tuple(
    f"innervate_{name}" for name in
    ("crypto.h", "seal.h", "seal.c", "noise.h", "noise.c", "contact.h", "contact.c")
)  # fmt: skip
# What a maker has, or takes from here.
EXAMPLE = tuple(f"crypto/innervate_example{end}" for end in
                (".h", "_cipher.c", "_curve.c", "_hash.c"))  # fmt: skip
SEAL_BYTES = 25  # a sealed frame is longer by so many
DRIVER = ("role_node.h", "role_node.c")
ON_LINES = ("node", "field")
ON_LINE = ("bare/role_main.c", "bare/role_small.c")
MAINS = {"node": ON_LINE, "field": ON_LINE, "sealed": ("bare/role_small.c",),
         "station": ("bare/role_modem.c",)}  # fmt: skip
BARE = ("bare/start.c", "bare/board.h", "bare/board_mps2.c", "bare/link.ld")
# For build systems: CMake, Zephyr, PlatformIO, Arduino.
PORTS = (
    "CMakeLists.txt", "zephyr/module.yml", "zephyr/Kconfig", "zephyr/CMakeLists.txt",
    "library.json", "library.properties", "examples/role_node/role_node.ino",
)  # fmt: skip
FRAME_MAX = 245  # bytes of a frame: what a modem says with it has to be stuffed at once, too
PREFIX = re.compile(r"[a-z][a-z0-9_]{0,30}")


def role_of(name: str, nodes: int | None = None) -> tuple[Network, Role]:
    """The role that is called so, or that of a network in a folder, and its network.

    Args:
        name: of a role, or a folder.
        nodes: of the network at most; None = as few as its smallest class has.

    Raises:
        FirmwareError: there is none, or it has no size.
        NetworkError: there is no network in that folder.
        LiveError: so many nodes do not fit.
    """
    known = {role.name: (network, role) for network in networks().values()
             for role in roles_of(network)}  # fmt: skip
    if name in known:
        network, role = known[name]
    elif Path(name).is_dir():
        network = use(Path(name))
        role = _own(network)
    else:
        raise FirmwareError(f"{name}: no folder, and none of {', '.join(known)}")
    if nodes is None:
        return network, role
    if not role.sized:
        raise FirmwareError(
            f"{role.name}: its arrays do not depend on how many nodes there are; leave out --nodes"
        )
    return network, resolve_name(role.sized)(nodes)


def _own(network: Network) -> Role:
    """The role of a network that somebody wrote."""
    found = roles_of(network)
    if found:
        return found[-1]
    missing = [part for part in ("protocol", "fields", "frames") if not network.has(part)]
    if missing:
        lacks = " and ".join(f"`{part}`" for part in missing)
        raise FirmwareError(
            f"network {network.name} declares no {lacks}: "
            "C is made from `protocol`, `fields` and `frames`"
        )
    raise FirmwareError(
        f"network {network.name} has a coder of its own, `frames.encode`: give it `boards`"
    )


def parameters_of(network: Network, role: Role, settings: list[str]) -> dict[str, Any]:
    """A role's parameters by name, some as `name=value` says.

    Raises:
        LiveError: not of this form, no such parameter, or out of its range.
    """
    changes = settings_of(settings, role.params)
    if role.parameters:
        made: dict[str, Any] = resolve_name(role.parameters)(changes, role.name)
        return made
    check_parameters(changes, role.params, role.name)
    plan = scenario.plan(scenario.from_dict({"kind": network.name}))
    return {**plan.params, **changes}


class Files(NamedTuple):
    """A library and all that comes with it, by path."""

    library: Library
    texts: dict[str, str]


def made_of(
    name: str, settings: list[str], nodes: int | None = None, prefix: str = "", sealed: bool = False
) -> Files:
    """The library that a command line asks for; `sealed`: its driver seals, as live nodes do.

    Raises:
        FirmwareError, LiveError, NetworkError: see role_of, parameters_of and Library.
    """
    if prefix and not PREFIX.fullmatch(prefix):
        raise FirmwareError(f"--prefix {prefix}: begin with a letter; small letters, digits, _")
    network, role = role_of(name, nodes)
    params = parameters_of(network, role, settings)
    chosen = {name: params[name] for name in role.made_in}
    library = Library(role._replace(params=only(role.params, chosen)), params, prefix)
    return Files(library, files_of(library, network, sealed))


def files_of(library: Library, network: Network, sealed: bool = False) -> dict[str, str]:
    """Texts by path: the protocol, and where its frames are plain, coder and driver.

    Raises:
        FirmwareError: its frames are too long for a line, or it has no lines to seal on.
    """
    texts = library.texts()
    coded = coded_of(library.role, network)
    driver = library.role.driver
    if sealed and (coded is None or driver not in ON_LINES):
        raise FirmwareError(f"{library.role.name}: --sealed is for nodes that speak on lines")
    if coded is None:
        return texts
    most = resolve_name(coded.payload_max)(library.params) if coded.payload_max else 0
    carried = FRAME_MAX - SEAL_BYTES * sealed
    if coded.size_max + most > carried:
        raise FirmwareError(
            f"{library.role.name}: frames of up to {coded.size_max + most} bytes; lines carry "
            f"{carried}: choose parameters with shorter ones"
        )
    if driver and (why := not_for_boards(network)):
        raise FirmwareError(why)
    texts |= Wire(library, coded, most).texts()
    having = _sections(library, sealed)
    texts |= {file: shipped(file, "", having) for file in (*BESIDE, *BARE)}
    if driver:
        texts |= _driven(library, network, "sealed" if sealed else driver, having)
    return texts


def _driven(
    library: Library, network: Network, main: str, having: frozenset[str]
) -> dict[str, str]:
    """A driver, what seals for it, an example of a board, and what build systems ask for."""
    name = library.prefix
    texts = {file: shipped(file) for file in (*SEAL, *EXAMPLE) if main == "sealed"}
    for file in (*DRIVER, *MAINS[main]):
        text = _told(library, shipped(file, "", having), network.key_kind)
        texts[file.replace("role", name)] = renamed(text, name)
    if library.role.hooks:
        package, _, stem = library.role.hooks.partition(":")
        for end in ("h", "c"):
            text = (resources.files(package) / f"{stem}.{end}").read_text(encoding="utf-8")
            texts[f"{name}_links.{end}"] = renamed(text, name)
    ports = [file for file in PORTS if main in ON_LINES or not file.endswith(".ino")]
    for file in ports:
        texts[file.replace("role", name)] = shipped(f"ports/{file}", name, having)
    return texts


def _sections(library: Library, sealed: bool) -> frozenset[str]:
    """The parts of the driver that a role has: see `shipped`."""
    role, is_on_lines = library.role, library.role.driver in ON_LINES
    found = {"lines" if is_on_lines else "air", "sealed" if sealed else "clear", "small"}
    if role.driver == "field":
        found |= _in_field(library)
    elif is_on_lines:
        found |= {"cables", "hooks" if role.hooks else "ports"}
    if is_on_lines:
        found.add("writes" if _writes_item(library) else "keeps")
    return frozenset(found | ({"gate"} if role.has_gate else set()))


def _in_field(library: Library) -> set[str]:
    """The parts of the driver that a role over a field has: what its medium would look at."""
    handlers = {made.name for made in library.program.handlers}
    fields = {name for name, *_ in library.role.frame}
    found = {"field", *({"to", "rssi"} & fields)}
    if "on_sent" in handlers:
        return found | {"ends", "sent"}
    return found | ({"ends", "carrier"} if "on_carrier" in handlers else set())


def _writes_item(library: Library) -> bool:
    """True if the protocol changes what its user hands down, which is the user's."""
    given = [made for made in library.program.handlers if made.name == "on_input"]
    return any(made.types[name].what in ("item", "frame")
               for made in given for name in made.changed)  # fmt: skip


def _told(library: Library, text: str, key_kind: int) -> str:
    """A driver's text with what it calls differently from role to role."""
    role, params = library.role, library.params
    air = role.driver == "station"
    words = {
        "/*gate*/": "node->gate, " if role.has_gate else "",
        "HAS_GATE": "gate != 0" if role.has_gate else "0",
        "KEY_KIND": str(key_kind),
        "INNERVATE_PORT *": "innervate_air_t *" if air else "innervate_port_t *",
    }
    if air:
        words["PACKET_BYTES"] = str(min(255, params["packet_slots"] - 2))
        words["PER_TURN"] = str(params["per_turn"])
    return filled(text, words)


def write(files: Files, folder: Path) -> dict[str, int]:
    """Write a library into a folder; lines of each file, by path.

    Raises:
        FirmwareError: the folder has something else in it, or a file cannot be written.
    """
    named, _ = files.library.own_files
    if folder.exists() and not folder.is_dir():
        raise FirmwareError(f"{folder}: a file lies here; name a folder")
    if folder.exists() and not (folder / named).exists() and any(folder.iterdir()):
        raise FirmwareError(f"{folder}: not empty, and holds no {named}; name another folder")
    for name, text in files.texts.items():
        try:
            _put(folder / name, text)
        except OSError as error:
            raise FirmwareError(f"{folder / name} cannot be written: {error.strerror}") from None
    return {name: len(text.splitlines()) for name, text in files.texts.items()}


def left(files: Files, folder: Path) -> list[str]:
    """What lies there of a library that was written before, sealed or not, and is none of this."""
    mains = (*DRIVER, *PORTS, *dict.fromkeys(file for group in MAINS.values() for file in group))
    ours = [*SEAL, *EXAMPLE, *(file.replace("role", files.library.prefix) for file in mains)]
    return [name for name in ours if name not in files.texts and (folder / name).exists()]


def _put(path: Path, text: str) -> None:
    """Whole or not at all."""
    path.parent.mkdir(parents=True, exist_ok=True)
    fresh = path.with_name(path.name + ".part")
    try:
        fresh.write_text(text, encoding="utf-8")
        fresh.replace(path)
    finally:
        fresh.unlink(missing_ok=True)
