"""A mesh as a capture: every node is an interface."""

from typing import Any

import numpy as np

from innervate.export import links
from innervate.export.cabled import stations as numbers
from innervate.networks.mesh import frames as mesh
from innervate.networks.mesh.protocol.constants import MTU_MAX
from innervate.networks.mesh.sim.simulate import simulate

__all__ = ["LATE_US", "frames", "interfaces", "numbers", "refusal", "simulate"]

# A mesh on a channel that all share tells of a frame when all have heard its end.
LATE_US = 2_000_000


def refusal(plan: Any) -> str:
    """Why there is no capture of a plan; "" if there is one."""
    return ""


def interfaces(plan: Any) -> list[tuple[str, str]]:
    """(name, description) of every interface, in order."""
    return [(name, links.describe("node", i)) for i, name in enumerate(plan.names)]


class _Record:
    """A mesh frame as `wire` wants it."""

    __slots__ = (*(name for name, *_ in mesh.COMMON), "body", "kind", "length", "path", "rssi")


def frames(rows: Any, kept: Any) -> list[bytes]:
    """The bytes of mesh frames; what many received is put into bytes once."""
    whole = np.dtype([(name, np.int64) for name in _SAME])
    keys = np.empty(len(kept), whole)
    keys["start"], keys["sender"] = rows["start"], rows["sender"]
    for name in _SAME[2:]:
        keys[name] = kept[name]
    _, first, which = np.unique(keys, return_index=True, return_inverse=True)
    made = [_mesh_frame(kept[i]) for i in first.tolist()]
    return [made[i] for i in which.tolist()]


# Who agrees in these is the same transmission.
_SAME = ("start", "sender", "kind", "flags", "link_dst", "origin", "dest", "seq", "ttl", "length")


def _mesh_frame(given: Any) -> bytes:
    record = _Record()
    for name in _Record.__slots__:
        value = given[name]
        setattr(record, name, value.tolist() if value.ndim else int(value))
    return mesh.encode(record, MTU_MAX)
