"""How long what cells know of their subnetwork's size is out of date after one cell balanced."""

from __future__ import annotations

from typing import Any

import numpy as np

from innervate.networks.skin.analysis.load import interfaces_along
from innervate.networks.skin.papers.common import SILENT, loaded
from innervate.networks.skin.papers.steps import Steps

HZ = 250
START = 300  # periods until first routes and their sizes stand


def measure(setup: str, lock_step: bool, watched: int, seed: int) -> list[int]:
    """Periods from a switch until all sizes are true, of the switches that were alone meanwhile."""
    more = {**SILENT, "timing.lock_step": lock_step}
    duration_s = (START + watched + 1) / HZ
    steps = Steps(loaded(setup, seed, duration_s, more, updates="periodic", beacon_hz=HZ))
    before: Any = None
    found: list[int] = []
    since, fresh = -1, False
    for period in range(START, START + watched):
        steps.to((period + 0.5) / HZ)
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
