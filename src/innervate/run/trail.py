"""The handler calls of a run one after the other, without keeping them all."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from innervate.scenario import Plan
from innervate.sim import build, loop
from innervate.sim.build import get, put
from innervate.sim.simulate import RULE_STATIC, SLICE_EVENTS, compiled_loop

FIELDS = ("time", "node", "handler", "port", "fingerprint")


def trail(plan: Plan, until_us: int) -> Iterator[Any]:
    """Pieces of the trail of a plan, in order: structured arrays with the fields FIELDS.

    Each belongs to the caller; together they are what `simulate(plan, trail=True)` keeps.
    """
    advance = compiled_loop(plan.params["rule"] == RULE_STATIC)
    world = build.build(plan, checks=False, observe=False, trail=True)
    while True:
        advance(world, until_us, SLICE_EVENTS)
        status = int(get(world.run, 0, "status"))
        if status == loop.POOL_FULL:
            world = build.grow_pool(world)
        count = int(get(world.run, 0, "trail"))
        yield world.trail[:count].copy()
        put(world.run, 0, trail=0)
        if status == loop.DONE:
            return


def first_difference(one: Iterator[Any], other: Iterator[Any]) -> tuple[Any, Any] | None:
    """The first rows in which two trails differ; None for the one that ends there.

    None alone if the trails are the same.
    """
    left, right = _Reader(one), _Reader(other)
    while True:
        a, b = left.look(), right.look()
        if len(a) == 0 or len(b) == 0:
            row_a, row_b = (part[0] if len(part) else None for part in (a, b))
            return None if row_a is None and row_b is None else (row_a, row_b)
        count = min(len(a), len(b))
        differs = np.zeros(count, np.bool_)
        for name in FIELDS:
            differs |= a[name][:count] != b[name][:count]
        places = np.flatnonzero(differs)
        if len(places):
            return a[places[0]], b[places[0]]
        left.skip(count)
        right.skip(count)


class _Reader:
    """Reads pieces as if they were one; `look` is empty only at the end."""

    def __init__(self, pieces: Iterator[Any]) -> None:
        self._pieces = pieces
        self._rest: Any = ()

    def look(self) -> Any:
        while len(self._rest) == 0:
            piece = next(self._pieces, None)
            if piece is None:
                return ()
            self._rest = piece
        return self._rest

    def skip(self, count: int) -> None:
        self._rest = self._rest[count:]
