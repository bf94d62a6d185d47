"""`innervate live recovery`: how a network healed, from a capture."""

import json
import sys
from dataclasses import asdict
from pathlib import Path

from innervate.cli.options import Json
from innervate.export import links
from innervate.export.reading import Capture
from innervate.network import networks

CUT_SHORT = "ends in the middle of a block: what came later is not looked at"


def show(capture: Path, /, *, as_json: Json = False) -> int:
    """Print what happened to a network, and how soon all was well again.

    Args:
        capture: What `live capture --out` wrote; or `export --pcapng` of a run.
        as_json: Print JSON.
    """
    able = [network for network in networks().values() if network.has("recovery")]
    kinds = _kinds(capture)
    recovery = next((one for one in able if one.name in kinds), able[0]).recovery
    whole = Capture(capture)
    found = recovery.recoveries(whole)
    if whole.cut_short:
        print(f"innervate: {capture} {CUT_SHORT}", file=sys.stderr)
    if as_json:
        print(json.dumps([asdict(one) for one in found]))
        return 0
    for one in found:
        print(recovery.line(one))
    if not found:
        print(recovery.NOTHING)
    return 0


def _kinds(path: Path) -> set[str | None]:
    """Of which kinds of networks the frames of a capture are, as its first packet shows."""
    capture = Capture(path)
    next(capture.packets(), None)
    return {links.kind_of(one.link_type) for one in capture.interfaces}
