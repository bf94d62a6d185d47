"""What `innervate prove` claims of a skin, and what it must refute."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from innervate.dialect.source import Change
from innervate.networks.skin.protocol.constants import INFINITY
from innervate.networks.skin.prove import feasible, pc, system
from innervate.networks.skin.prove.faults import FAULTS as MUTANTS
from innervate.networks.skin.prove.faults import NO_SAFETY
from innervate.networks.skin.prove.words import tell
from innervate.prove.errors import ProveError
from innervate.prove.steps import Step
from innervate.prove.terms import Term
from innervate.prove.theory import Theory, is_in

__all__ = ["MUTANTS", "NO_SAFETY", "theories"]

ASSUMED = (
    "A frame arrives as it was sent or not at all; late, doubled and out of order as it may.",
    "Numbers: those in use (feasible distances, routes kept of working ports, beacons on their "
    "way) differ by less than 2^15.",
    "Restart: when a cell's wait is over, no neighbour has it as parent, keeps a route of it on "
    "a working port, or has one of its old routes on the way.",
    "FD_HOLD: the same when a cell forgets its feasible distance.",
    "First start: a cell is switched on with cause 0 only if it never was on before.",
    "A cable joins the same two ends for ever; it may be cut and mended.",
)
OTHER_FRAMES = "only data and commands are copied"
UNREACHABLE = {
    ("copy_frame", "kind == DATA or kind == COMMAND", False): OTHER_FRAMES,
    ("is_allowed", "params.rule == RULE_FEASIBLE", False): "another rule",
}


def theories(_network: Any, change: Change | None = None) -> list[Theory]:
    """All claims, smallest first.

    Raises:
        ProveError: the mistake to plant is in none of the sources.
    """
    if change is not None and not any(is_in(entry, change) for entry in (feasible.ENTRY, pc.ENTRY)):
        raise ProveError(f"{change[0]!r} is in no source that is proved")
    return [
        _theory("the PC", "It announces distance 0 and its number, which only rises.",
                pc.steps(change)),
        _theory("rule feasible", "At no moment parents close a ring, of any number of cells.",
                feasible.steps(change) + system.steps(change)),
    ]  # fmt: skip


def _theory(name: str, claim: str, steps: tuple[Callable[[], Step], ...]) -> Theory:
    return Theory(f"skin, {name}", claim, ASSUMED, steps, UNREACHABLE, tell=tell, simple=simple)


def simple(step: Step) -> list[Term]:
    """Counterexamples with small numbers, on few ports."""
    t = step.terms
    wishes = [t.same(t.unknown("base", 0, 65535), t.number(1))]
    for record in step.records.values():
        for key, low, high in record.places():
            value = step.before[key]
            if key[1] == "dist" and key[0].name == "cell":
                wishes.append(t.same(value, t.number(INFINITY)))
            elif value.op == "wrap":
                wishes.append(t.less(value.args[1], t.number(8)))  # type: ignore[arg-type]
            elif value.op == "var":
                wishes.append(t.same(value, t.number(min(max(0, low), high))))
    return wishes
