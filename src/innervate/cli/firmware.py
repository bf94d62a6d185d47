"""`innervate firmware`: a node's protocol as C."""

import json
from collections.abc import Callable
from functools import partial
from pathlib import Path

from innervate.cli.options import Flag, Json, Whole
from innervate.firmware import emit, library
from innervate.firmware.emulated import Emulated
from innervate.live.board import roles_of
from innervate.live.engine import Engine
from innervate.live.nodefile import load
from innervate.network import networks


def firmware(
    network: str,
    /,
    *settings: str,
    out: Path = Path("lib"),
    nodes: Whole | None = None,
    prefix: str = "",
    sealed: Flag = False,
    as_json: Json = False,
) -> int:
    """Write a library, and say what was written.

    Args:
        network: skin, radio, mesh, csma, or a folder with a network of your own.
        settings: Parameters of the protocol in place of the usual ones, like beacon_us=20000.
        out: Folder to write into.
        nodes: How many a network of this kind has at most, where arrays depend on it.
        prefix: In front of all names; the network's name if left out.
        sealed: With a driver that shakes hands and seals, with a network's key, as live nodes do.
        as_json: Print what was written as JSON and nothing else.
    """
    files = library.made_of(network, list(settings), nodes, prefix, sealed)
    lines, made = library.write(files, out), files.library
    if as_json:
        said = {"out": str(out), "source": made.digest(), "abi": emit.ABI, "lines": lines}
        print(json.dumps(said))
        return 0
    own = [f"{name} ({count} lines)" for name, count in lines.items() if name in made.own_files]
    more = f" and {len(lines) - len(own)} files around them" if len(lines) > len(own) else ""
    print(f"{out}: {', '.join(own)}{more}")
    if not made.role.driver:
        what = "when others send is your radio's to say; call its functions from there"
        print(f"{out}: no driver: {what}")
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
