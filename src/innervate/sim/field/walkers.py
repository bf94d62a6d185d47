"""Tables of robots that move, compiled (arrays) or plain (lists); see `motion`."""

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from innervate.scenario.robots import Walk, errs
from innervate.sim.field import powers, queue
from innervate.sim.field import world as w
from innervate.sim.tables import Tables, get, put, timed, uniform
from innervate.topology import astray


def motion_tables(
    tables: Tables, plan: Any, heard: Any, paths: Iterable[Walk], chances: Sequence[int]
) -> dict[str, Any]:
    """What `motion` needs of a plan.

    Args:
        tables: makes them.
        plan: of the nodes.
        heard: who hears whom in it, with `base_cdb` and `exponent_c`.
        paths: of those that are moved or told where they are.
        chances: of reception in 1/32768, per 0.1 dB (see `powers.chance_table`).
    """
    walks, points = _rows(plan, paths)
    return {
        "base": tables.given(heard.base_cdb or [0], np.int32),
        "losses": tables.given(powers.loss_table(heard.exponent_c)),
        "chances": tables.given(chances),
        "normals": tables.given(astray.normal_table()),
        "walks": timed(tables, w.WALK, walks),
        "points": timed(tables, w.POINT, points),
    }


def _rows(plan: Any, paths: Iterable[Walk]) -> tuple[list[Any], list[Any]]:
    """Walkers with their place in the list of all points, and that list."""
    phases = uniform(plan.seed, "sample", plan.nodes, plan.sample_us)
    walks: list[Any] = []
    points: list[Any] = []
    for walk in paths:
        first = len(points)
        points += list(walk.points)
        place = (walk.node, first, len(points) - 1, int(phases[walk.node]), 0)
        walks.append((*place, *errs(walk, plan.seed, plan.sample_us), 0, 0, 0, 0))
    return walks, points


def place(world: Any, plan: Any) -> None:
    """Where nodes are before anybody moves, if it is known."""
    for node, (x, y) in enumerate(plan.positions_cm):
        put(world.radios, node, x=x, y=y)


def push_samples(world: Any, many: int) -> None:
    """Queue the first sample of each of so many walkers; each queues its next."""
    for i in range(many):
        at, node = int(get(world.walks, i, "phase")), int(get(world.walks, i, "node"))
        queue.push(world.heap, queue.key_of(at, queue.SAMPLE, node, i))
