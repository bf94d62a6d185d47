"""What the reductions rest on, tried on the protocol itself before they are used.

They forget routes that the rule refuses (reduction.py), and so could hide a mistake in the rule. So
a cell without a route is told of every such route there can be in small numbers, in a frame and
before a tick: it must not take it.
"""

from __future__ import annotations

import functools
from collections.abc import Iterator
from itertools import product
from typing import Any

from innervate.networks.skin.protocol.constants import INFINITY, NONE
from innervate.networks.skin.verify import check as skin_check
from innervate.networks.skin.verify import graphs
from innervate.networks.skin.verify import row as skin_row
from innervate.networks.skin.verify import system as system
from innervate.networks.skin.verify import world as w
from innervate.verify.twin import Twin

NUMBERS, HOPS = range(4), range(6)


def broken(model: system.SkinModel, bound: Any = None) -> str:
    """The first route that is taken though the reductions rest on its refusal; "" if none is.

    Args:
        model: what is to be explored.
        bound: the system of a copy of the protocol; None the real one.
    """
    if model.rule.startswith("paper") or (model.rule == "strict" and model.budget.restart):
        return ""
    if bound is None:
        return _tried(model.rule, model.updates)
    return _try(model.rule, model.updates, bound)


@functools.cache
def _tried(rule: str, updates: str) -> str:
    return _try(rule, updates, system.system_of())


def _try(rule: str, updates: str, bound: Any) -> str:
    twin = Twin(
        system.SkinModel(graphs.parse("pc-1"), rule, updates, merge=False, keep=True), bound
    )
    way = next(way for way in twin.lay.in_way if way != NONE)
    for fd, route in _refused(rule):
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
    """A cell that lost its route, and a beacon with another on its way to it."""
    twin.put(bytes(system.first_row(twin.model, twin.system)))
    row, at, queue = twin.world.work, twin.lay.cell_at[0], twin.lay.queue_at[way]
    row[at + w.FLAGS] = skin_row.SQ_KNOWN | skin_row.FD_KNOWN | skin_row.HAS_TICKED
    row[at + w.SQ_OWN], row[at + w.FD_SQ], row[at + w.FD_DIST] = fd[0], *fd
    row[at + w.SENT_DIST], row[at + w.TICKS] = INFINITY, 3
    row[queue], row[queue + 1 + w.DIST], row[queue + 1 + w.SQ] = 1, route[1], route[0]
    row[queue + 1 + w.SAYS] = skin_row.LOADED
