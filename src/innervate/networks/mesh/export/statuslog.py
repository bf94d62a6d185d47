"""A network out of what running mesh nodes say of themselves: `innervate live status --json`.

A node counts the frames that a neighbour should acknowledge and those that it did. An ack crosses
the link back, so that the share is the product of both directions' qualities; each gets its root.
"""

import json
from pathlib import Path
from typing import Any

from innervate.export.errors import ExportError
from innervate.kernel.words import number_of
from innervate.networks.mesh.export.fit import Mesh

FRAMES = 10_000  # a share stands for so many, as nodes do not say how many there were


def looks_like_one(path: Path) -> bool:
    """True if the file begins as JSON does."""
    try:
        with path.open("rb") as file:
            return file.read(64).lstrip()[:1] in (b"[", b"{")
    except OSError as error:
        raise ExportError(f"{path}: {error.strerror}") from None


def measure(path: Path) -> Mesh:
    """Read what nodes said.

    Raises:
        ExportError: it is not the status of mesh nodes.
    """
    found = Mesh()
    shares: dict[tuple[int, int], float] = {}
    try:
        told = json.loads(path.read_bytes())
        for one in told if isinstance(told, list) else [told]:
            _take(one, found, shares)
    except (KeyError, TypeError, ValueError, AttributeError, RecursionError):
        raise ExportError(
            f"{path} is no status of mesh nodes; write it with: innervate live status --json"
        ) from None
    unknown = 0
    for a, b in sorted({*shares, *((b, a) for a, b in shares)}):
        known = [share for share in (shares.get((a, b)), shares.get((b, a))) if share is not None]
        measured = [share for share in known if share >= 0]
        unknown += not measured
        share = sum(measured) / len(measured) if measured else 1.0
        way = found.way(a, b)
        way.got = round(FRAMES * share**0.5)
        way.lost = FRAMES - way.got
    if not found.ways:
        raise ExportError(f"{path}: no node has a neighbour yet; ask again a little later")
    if unknown:
        links = number_of(unknown // 2, "link")
        found.notes.append(f"{links} carried nothing to acknowledge: taken as perfect")
    found.notes.append("a status says nothing of delays: the fit is a network over IP")
    return found


def _take(one: dict[str, Any], found: Mesh, shares: dict[tuple[int, int], float]) -> None:
    """A node's neighbours; -1 = nobody knows how good the link is."""
    if one["kind"] != "mesh":
        raise ValueError("not of a mesh")
    number = int(one["number"])
    if one["gateway"] is not None:
        found.gateway = int(one["gateway"])
    for near in one["neighbours"]:
        share = near["quality"]
        shares[number, int(near["node"])] = -1.0 if share is None else min(1.0, max(0.0, share))
