"""`innervate firmware`: a node's protocol as C."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from innervate.firmware import emit, library
from innervate.firmware.emulated import engine_of
from innervate.live.board import roles_of
from innervate.live.engine import Engine
from innervate.live.nodefile import load
from innervate.network import networks


class Wanted(NamedTuple):
    """What is to be written, and where."""

    out: Path
    nodes: int | None
    prefix: str
    sealed: bool


def firmware(network: str, settings: list[str], wanted: Wanted, as_json: bool) -> int:
    """Write the library of a network's node."""
    files = library.made_of(network, settings, wanted.nodes, wanted.prefix, wanted.sealed)
    lines, made = library.write(files, wanted.out), files.library
    if as_json:
        said = {"out": str(wanted.out), "source": made.digest(), "abi": emit.ABI, "lines": lines}
        print(json.dumps(said))
        return 0
    own = [f"{name} ({count} lines)" for name, count in lines.items() if name in made.own_files]
    more = f" and {len(lines) - len(own)} files around them" if len(lines) > len(own) else ""
    print(f"{wanted.out}: {', '.join(own)}{more}")
    print(f"made from {made.role.entry}, source {made.digest()}, ABI {emit.ABI}")
    if old := library.left(files, wanted.out):
        print(f"{wanted.out} still holds files of another library; remove them: {', '.join(old)}")
    return 0


def engine_for(file: Path, image: Path) -> Callable[..., Engine]:
    """What runs the protocol of a node file on an emulated board.

    Raises:
        LiveError: there is no such file.
    """
    role = roles_of(networks()[load(file).table.kind])[-1]
    return engine_of(image.absolute(), role)
