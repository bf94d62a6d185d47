"""A skin as a capture: every cabled port is an interface."""

from __future__ import annotations

from typing import Any

import numpy as np

from innervate.export import bulk, links
from innervate.networks.skin import frames as skin
from innervate.networks.skin.sim.simulate import simulate

__all__ = ["LATE_US", "frames", "interfaces", "numbers", "refusal", "simulate"]

LATE_US = 0  # a row is told at its moment


def refusal(plan: Any) -> str:
    """Why there is no capture of a plan; "" if there is one."""
    no_clock = "a scenario with a script has no clock and no capture; remove [script]"
    return no_clock if plan.script else ""


def interfaces(plan: Any) -> list[tuple[str, str]]:
    """(name, description) of every interface, in order."""
    return [_port(plan.graph, end) for end in _cabled(plan.graph)]


def numbers(plan: Any) -> Any:
    """Which interface a tap's row is of, by its column `at`."""
    found = np.zeros(len(plan.graph.peer), np.int64)
    cabled = _cabled(plan.graph)
    found[cabled] = np.arange(len(cabled))
    return found


def _cabled(graph: Any) -> list[int]:
    """Ends that have a cable."""
    return [end for end, peer in enumerate(graph.peer) if peer >= 0]


def _port(graph: Any, end: int) -> tuple[str, str]:
    node, port = graph.node_of(end), graph.port_of(end)
    cable = (graph.label_end(end), graph.label_end(graph.peer[end]))
    is_pc = node == graph.cells
    return cable[0], links.describe("pc" if is_pc else "cell", -1 if is_pc else node, port, cable)


def frames(_rows: Any, kept: Any) -> list[bytes]:
    """The bytes of skin frames, given as an array of records."""
    return bulk.by_kind(kept, {
        kind: (fields, kind, skin.KIND_BITS, skin.SIZES[kind])
        for kind, _name, fields in skin.LAYOUTS
    })  # fmt: skip
