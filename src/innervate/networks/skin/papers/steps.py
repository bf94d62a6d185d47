"""A simulation in steps, to look into it while it runs: penalties, counters, loads, sizes."""

from typing import Any

import numpy as np

from innervate.networks.skin.analysis.load import interfaces_along
from innervate.networks.skin.papers.common import SILENT, planned
from innervate.networks.skin.scenario.plan import Plan
from innervate.networks.skin.sim.simulate import simulation
from innervate.sim.status import DONE

BEACON_HZ = 250
STALE_FROM = 300  # periods until first routes and their sizes stand


class Steps:
    """Runs a plan up to given times; between them `world` may be read.

    Rows that the run reports are dropped: what is asked of it here is its state.
    """

    def __init__(self, plan: Plan) -> None:
        self.plan = plan
        self._running = simulation(plan)

    @property
    def world(self) -> Any:
        """The tables of the simulation as they are now."""
        return self._running.world

    def to(self, time_s: float) -> None:
        """Run up to, not including, a time.

        Raises:
            InvariantBroken: a checker found what must not happen.
        """
        until_us = min(round(1e6 * time_s), self.plan.duration_us)
        while self._running.advance(until_us, self._running.slice_events) != DONE:
            pass
        self._running.take()

    def counters(self) -> list[int]:
        """The counters of sim/wires.py up to now."""
        return [int(count) for count in self.world.counters]


def stale_sizes(setup: str, lock_step: bool, watched: int, seed: int) -> list[int]:
    """Periods from a switch of a parent until all cells know the true size of their subnetwork.

    Only of switches that were alone meanwhile.
    """
    more = {**SILENT, "timing.lock_step": lock_step}
    duration_s = (STALE_FROM + watched + 1) / BEACON_HZ
    steps = Steps(planned(setup, seed, duration_s, more, updates="periodic", beacon_hz=BEACON_HZ))
    before: Any = None
    found: list[int] = []
    since, fresh = -1, False
    for period in range(STALE_FROM, STALE_FROM + watched):
        steps.to((period + 0.5) / BEACON_HZ)
        parents = steps.world.cells["parent"].astype(np.int64)
        moved = 0 if before is None else int((parents != before).sum())
        before = parents
        if moved:
            alone = moved == 1 and since < 0 and fresh
            since = period if alone else -1
        fresh = sizes_are_true(steps, parents)
        if fresh and since >= 0:
            found.append(period - since)
            since = -1
    return found


def sizes_are_true(steps: Steps, parents: Any) -> bool:
    """True if every cell knows how many cells its interface port serves."""
    port = interfaces_along(steps.plan.graph, parents)
    if (port < 0).any():
        return False
    loads = np.bincount(port, minlength=steps.plan.graph.interfaces)
    known = steps.world.cells["size"][np.arange(len(parents)), np.maximum(parents, 0)]
    return bool((known == loads[port]).all())
