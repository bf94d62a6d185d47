"""`innervate firmware`: a node's protocol as C."""

import json
from collections.abc import Callable
from functools import partial
from pathlib import Path

from innervate.firmware import emit, library
from innervate.firmware.emulated import Emulated
from innervate.live.board import roles_of
from innervate.live.engine import Engine
from innervate.live.nodefile import load
from innervate.network import networks


def write(files: library.Files, out: Path, as_json: bool) -> int:
    """Write a library, and say what was written."""
    lines, made = library.write(files, out), files.library
    if as_json:
        said = {"out": str(out), "source": made.digest(), "abi": emit.ABI, "lines": lines}
        print(json.dumps(said))
        return 0
    own = [f"{name} ({count} lines)" for name, count in lines.items() if name in made.own_files]
    more = f" and {len(lines) - len(own)} files around them" if len(lines) > len(own) else ""
    print(f"{out}: {', '.join(own)}{more}")
    print(f"made from {made.role.entry}, source {made.digest()}, ABI {emit.ABI}")
    if old := library.left(files, out):
        print(f"{out} still holds files of another library; remove them: {', '.join(old)}")
    return 0


def engine_for(file: Path, image: Path) -> Callable[..., Engine]:
    """What runs the protocol of a node file on an emulated board.

    Raises:
        LiveError: there is no such file.
    """
    role = roles_of(networks()[load(file).table.kind])[-1]
    return partial(Emulated, image.absolute(), role)
