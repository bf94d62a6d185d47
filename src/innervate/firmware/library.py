"""What a maker gets: the role that was meant, its parameters, and the files of its library."""

from __future__ import annotations

import re
from importlib import import_module, resources
from pathlib import Path
from typing import Any, NamedTuple

from innervate import scenario
from innervate.firmware.emit import Library
from innervate.firmware.errors import FirmwareError
from innervate.firmware.wire import Wire
from innervate.live.board import Role, roles_of
from innervate.live.parameters import check_parameters
from innervate.network import Network, networks, use

BESIDE = ("innervate_wire.h", "innervate_wire.c", "innervate_port.h")
SEAL = ("innervate_seal.h", "innervate_seal.c")
DRIVER = ("role_node.h", "role_node.c")
BARE = ("bare/start.c", "bare/board.h", "bare/board_mps2.c", "bare/link.ld")
# For build systems: CMake, Zephyr, PlatformIO, Arduino.
PORTS = (
    "CMakeLists.txt", "zephyr/module.yml", "zephyr/Kconfig", "zephyr/CMakeLists.txt",
    "library.json", "library.properties", "examples/role_node/role_node.ino",
)  # fmt: skip
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
        raise FirmwareError(f"{role.name}: its arrays do not depend on how many nodes there are")
    return network, _part(role.sized)(nodes)


def _own(network: Network) -> Role:
    """The role of a network that somebody wrote."""
    found = roles_of(network)
    if found:
        return found[-1]
    missing = [part for part in ("protocol", "fields", "frames") if not network.has(part)]
    if missing:
        lacks = " and ".join(f"`{part}`" for part in missing)
        raise FirmwareError(f"network {network.name} declares no {lacks}: C needs all three")
    raise FirmwareError(
        f"network {network.name} has a coder of its own, `frames.encode`: give it `boards`"
    )


def parameters_of(network: Network, role: Role, settings: list[str]) -> dict[str, Any]:
    """A role's parameters by name, some as `name=value` says.

    Raises:
        FirmwareError: not of this form.
        LiveError: no such parameter, or out of its range.
    """
    changes = {}
    for setting in settings:
        name, _, value = setting.partition("=")
        if not value.lstrip("-").isdigit():
            like = next((p[0] for p in role.params if p[4] == "us"), "name")
            raise FirmwareError(f"{setting}: give a whole number, like {like}=20000")
        changes[name] = int(value)
    if role.parameters:
        made: dict[str, Any] = _part(role.parameters)(changes, role.name)
        return made
    check_parameters(changes, role.params, role.name)
    plan = scenario.plan(scenario.from_dict({"kind": network.name}))
    return {**plan.params, **changes}


class Files(NamedTuple):
    """A library and all that comes with it, by path."""

    library: Library
    texts: dict[str, str]


def made_of(name: str, settings: list[str], nodes: int | None = None, prefix: str = "") -> Files:
    """The library that a command line asks for.

    Raises:
        FirmwareError, LiveError, NetworkError: see role_of, parameters_of and Library.
    """
    if prefix and not PREFIX.fullmatch(prefix):
        raise FirmwareError(f"--prefix {prefix}: begin with a letter; small letters, digits, _")
    network, role = role_of(name, nodes)
    library = Library(role, parameters_of(network, role, settings), prefix)
    return Files(library, files_of(library, network))


def files_of(library: Library, network: Network) -> dict[str, str]:
    """Texts by path: the protocol, and where its frames are plain, coder and driver."""
    name = library.prefix
    header = f"{name}.h"
    texts = {header: library.header(), f"{name}.c": library.source(header)}
    if not hasattr(network.frames, "KIND_BITS"):
        return texts
    wire = Wire(library, network)
    texts |= {f"{name}_wire.h": wire.header(), f"{name}_wire.c": wire.source()}
    texts |= {file: shipped(file) for file in (*BESIDE, *SEAL, *BARE)}
    named = (*DRIVER, "bare/role_main.c", "bare/role_small.c")
    texts |= {file.replace("role", name): shipped(file, name) for file in named}
    return texts | {file.replace("role", name): shipped(f"ports/{file}", name) for file in PORTS}


def shipped(file: str, prefix: str = "") -> str:
    """A file that lies here; one of the driver's with a network's names."""
    text = (resources.files("innervate.firmware") / "c" / file).read_text(encoding="utf-8")
    if prefix:
        text = re.sub(r"(?<![a-z])role(?![a-z])", prefix, text)
        text = re.sub(r"(?<![A-Z])ROLE(?![A-Z])", prefix.upper(), text)
    return text


def write(files: Files, folder: Path) -> dict[str, int]:
    """Write a library into a folder; lines of each file, by path.

    Raises:
        FirmwareError: the folder has something else in it.
    """
    named = f"{files.library.prefix}.h"
    if folder.exists() and not (folder / named).exists() and any(folder.iterdir()):
        raise FirmwareError(f"{folder}: not empty and not made by this command; name another")
    for name, text in files.texts.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    return {name: len(text.splitlines()) for name, text in files.texts.items()}


def _part(place: str) -> Any:
    module, _, name = place.partition(":")
    return getattr(import_module(module), name)
