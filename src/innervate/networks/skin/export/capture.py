"""A skin as a capture: every cabled port is an interface."""

from typing import Any

from innervate.export import cabled
from innervate.export.cabled import numbers
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
    return cabled.interfaces(plan, _word)


def _word(graph: Any, node: int) -> tuple[str, int]:
    return ("pc", -1) if node == graph.cells else ("cell", node)


def frames(_rows: Any, kept: Any) -> list[bytes]:
    """The bytes of skin frames, given as an array of records."""
    return cabled.packed(skin.LAYOUTS, skin.KIND_BITS, kept)
