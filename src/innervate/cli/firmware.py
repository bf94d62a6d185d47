"""`innervate firmware`: a node's protocol as C."""

from __future__ import annotations

import json
from pathlib import Path
from typing import NamedTuple

from innervate.firmware import emit, library


class Wanted(NamedTuple):
    """What is to be written, and where."""

    out: Path
    nodes: int | None
    prefix: str


def firmware(network: str, settings: list[str], wanted: Wanted, as_json: bool) -> int:
    """Write the library of a network's node."""
    made = library.library_of(network, settings, wanted.nodes, wanted.prefix)
    lines = library.write(made, wanted.out)
    if as_json:
        said = {"out": str(wanted.out), "source": made.digest(), "abi": emit.ABI, "lines": lines}
        print(json.dumps(said))
        return 0
    print(f"{wanted.out}: {', '.join(f'{name} ({count} lines)' for name, count in lines.items())}")
    print(f"made from {made.role.entry}, source {made.digest()}, ABI {emit.ABI}")
    return 0
