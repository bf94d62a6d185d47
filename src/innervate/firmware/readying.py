"""Makes the C of usual live nodes, for a wheel: `python -m innervate.firmware.readying FOLDER`.

Nodes are built from files of each network, as `innervate live node --engine c` does, and what that
compiles is put into the folder. So a robot whose wheel brings it needs no compiler.
"""

import os
import shutil
import sys
import tempfile
from pathlib import Path
from typing import Any

from innervate.firmware import compiled
from innervate.live.board import roles_of
from innervate.live.build import build
from innervate.live.nodefile import C, Loaded, parse
from innervate.network import Network, networks

CABLE = {"kind": "udp", "bind": "127.0.0.1:4700", "peers": ["127.0.0.1:4701"]}
BEGUN: dict[str, Any] = {"kind": "", "number": 1, "link": [CABLE]}


def write(folder: Path) -> None:
    """Compile what all usual nodes take into a folder, in the place of what was there.

    Raises:
        LiveError: one of them cannot be had as C.
    """
    folder.mkdir(parents=True, exist_ok=True)
    for old in folder.glob("*.so"):
        old.unlink()
    with tempfile.TemporaryDirectory() as cache:
        os.environ |= {"INNERVATE_CACHE": cache, "INNERVATE_READY": "0"}
        for network in networks().values():
            for tables in usual_of(network):
                build(Loaded(parse(tables), Path(f"a usual {network.name}")), C)
                more = {key: value for key, value in tables.items() if key not in BEGUN}
                print(f"{network.name} {more or ''}".rstrip(), flush=True)
        for library in sorted((Path(cache) / compiled.FOLDER).glob("*.so")):
            shutil.copyfile(library, folder / library.name)


def usual_of(network: Network) -> list[dict[str, Any]]:
    """The tables of files of a network's usual live nodes."""
    begun = BEGUN | {"kind": network.name}
    return [{**begun, **more} for role in roles_of(network) for more in role.usual]


if __name__ == "__main__":
    write(Path(sys.argv[1]))
