"""What the reductions rest on, shown of the protocol itself before they are used.

They forget what decides nothing (reduction.py), and routes that the rule refuses, and so could hide
a mistake in the protocol. So lemmas are proved first, of the very source at hand and for all
numbers (networks/skin/prove). Without the solver they are taken on trust, but for this: a cell
without a route is told of every refused route there can be in small numbers, in a frame and before
a tick, and must not take it.
"""

import functools
from collections.abc import Iterator
from itertools import product
from pathlib import Path
from typing import Any

from innervate.dialect.source import Change
from innervate.networks.skin.protocol.constants import INFINITY, NONE, RULE_FEASIBLE, RULE_STRICT
from innervate.networks.skin.verify import check as skin_check
from innervate.networks.skin.verify import graphs
from innervate.networks.skin.verify import row as skin_row
from innervate.networks.skin.verify import system as system
from innervate.networks.skin.verify import world as w
from innervate.prove.errors import can_prove
from innervate.verify.twin import Twin

RULES = {"feasible": RULE_FEASIBLE, "strict": RULE_STRICT}
ON_TRUST = "taken on trust, since z3 is missing (pip install 'innervate[prove]'): "
TRUSTED = "all that reductions forget"
TRUSTED_RULE = f"{TRUSTED}, but that the rule refuses it in small numbers"
PROVED = ("stored beacons, news, loads, dead and broken ports, time without a route, fields never "
          "read, mirror images")  # fmt: skip
PROVED_RULE = f"the rule, repeated beacons, {PROVED}"
ARGUED = ("that no more is forgotten than this, and that who may do less finds no more "
          "(budgets are the explorer's own)")  # fmt: skip
PAGE = "docs/verify.md"
NUMBERS, HOPS = range(4), range(6)


def broken(model: system.SkinModel, bound: Any = None) -> str:
    """The first route that is taken though the reductions rest on its refusal; "" if none is.

    Args:
        model: what is to be explored.
        bound: the system of a copy of the protocol; None the real one.
    """
    refuses = is_asked(model)
    if bound is not None:
        return _try(model.rule, model.updates, bound) if refuses else ""
    tried = _tried(model.rule, model.updates) if refuses else ""
    return tried or refuted("") or (refuted(model.rule) if refuses else "")


def grounds(model: system.SkinModel) -> dict[str, str]:
    """What a reduced search rests on: what is proved, argued, taken on trust; {} if it is none."""
    if not model.lean:
        return {}
    refuses = is_asked(model)
    how = {"trusted": TRUSTED_RULE if refuses else TRUSTED}
    if can_prove():
        how = {"proved": PROVED_RULE if refuses else PROVED}
    return how | {"argued": ARGUED, "page": PAGE}


def told(model: system.SkinModel) -> str:
    """The same as a line; "" if there is nothing to tell."""
    found = grounds(model)
    heads = {"proved": "proved: ", "trusted": ON_TRUST, "argued": "argued: "}
    parts = [head + found[name] for name, head in heads.items() if name in found]
    return f"    what is left out: {'; '.join(parts)} ({PAGE})" if parts else ""


def is_asked(model: system.SkinModel) -> bool:
    """True if the reductions rest on the rule, too: it refuses a route for good."""
    return model.rule in RULES and not (model.rule == "strict" and bool(model.budget.restart))


@functools.cache
def refuted(rule: str, change: Change | None = None) -> str:
    """The first lemma under the reductions that does not hold; "" if all do, or none was tried.

    Args:
        rule: that refuses for good; "" for what is so under any.
        change: a mistake to plant, as in the dialect's `source.functions`.
    """
    if not can_prove():
        return ""
    if change is not None:
        return _refuted(rule, change)
    from innervate.networks.skin.prove import neighbours, pc
    from innervate.prove import kept
    from innervate.prove.theory import source

    found: list[str] = []

    def attempt() -> bool:
        found.append(_refuted(rule, None))
        return not found[0]

    asks = Path(__file__).resolve()  # which lemmas are needed, and for which rule
    home = asks.parent.parent
    parts = home / "protocol", home / "prove", asks
    known = {**source(pc.ENTRY, None), **source(neighbours.ENTRY, None)}
    held = kept.holds(f"skin, reduced, {rule}", known, parts, attempt)
    return "" if held else found[0]


def _refuted(rule: str, change: Change | None) -> str:
    from innervate.networks.skin.prove.neighbours import ANY_RULE
    from innervate.networks.skin.prove.theories import resting
    from innervate.prove.theory import prove

    for theory in resting(RULES.get(rule, ANY_RULE), change):
        for one in prove(theory, first_only=True).checked:
            if one.refuted:
                return f"refuted: {one.refuted[0].goal} ({one.name})"
    return ""


@functools.cache
def _tried(rule: str, updates: str) -> str:
    return _try(rule, updates, system.system_of())


def _try(rule: str, updates: str, bound: Any) -> str:
    twin = Twin(
        system.SkinModel(graphs.parse("pc-1"), rule, updates, merge=False, keep=True), bound
    )
    way = next(way for way in twin.lay.in_way if way != NONE)
    begun = bytes(twin.model.first_row(twin.system))
    for fd, route in _refused(rule):
        twin.put(begun)
        _put(twin, way, fd, route)
        for kind, arg in ((w.DELIVER, way), (w.TICK, 0)):
            bound.step(twin.world, twin.moves.index((kind, arg)), 0, 0)
            if skin_check.parent_port(twin.world, 0) != NONE:
                words = "number {}, {} hops".format
                return f"a route ({words(*route)}) is taken beside the best before ({words(*fd)})"
    return ""


def _refused(rule: str) -> Iterator[tuple[tuple[int, int], tuple[int, int]]]:
    """(number, hops) of a feasible distance and of a route that is refused beside it."""
    for fd in product(NUMBERS, HOPS[1:]):
        for sq, dist in product(NUMBERS, HOPS):
            is_newer = sq > fd[0]
            is_nearer = rule == "feasible" and sq == fd[0] and dist < fd[1]
            if not is_newer and not is_nearer:
                yield fd, (sq, dist)


def _put(twin: Twin, way: int, fd: tuple[int, int], route: tuple[int, int]) -> None:
    """A cell, just begun, lost its route, and a beacon with another is on its way to it."""
    row, at, queue = twin.world.work, twin.lay.cell_at[0], twin.lay.queue_at[way]
    row[at + w.FLAGS] = skin_row.SQ_KNOWN | skin_row.FD_KNOWN | skin_row.HAS_TICKED
    row[at + w.SQ_OWN], row[at + w.FD_SQ], row[at + w.FD_DIST] = fd[0], *fd
    row[at + w.SENT_DIST], row[at + w.TICKS] = INFINITY, 3
    row[queue], row[queue + 1 + w.DIST], row[queue + 1 + w.SQ] = 1, route[1], route[0]
    row[queue + 1 + w.SAYS] = skin_row.LOADED
