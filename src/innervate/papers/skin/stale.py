"""How long what cells know of their subnetwork's size is out of date after one cell balanced."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from innervate import scenario
from innervate.analysis.load import interfaces_along
from innervate.papers.skin.steps import Steps

HZ = 250
START = 300  # periods until first routes and their sizes stand


def measure(setup: str, lock_step: bool, some: Sequence[int], watched: int) -> dict[str, Any]:
    """Periods from a switch until all sizes are true, of the switches that were alone meanwhile."""
    found: list[int] = []
    for seed in some:
        found += _after_switches(_steps(setup, lock_step, seed, START + watched), watched)
    return {"periods": found}


def _steps(setup: str, lock_step: bool, seed: int, periods: int) -> Steps:
    overrides: list[tuple[str, Any]] = [
        ("protocol.updates", "periodic"),
        ("protocol.beacon_hz", HZ),
        ("timing.lock_step", lock_step),
        ("data.rate_hz", 0),
        ("event", []),
        ("duration_s", (periods + 1) / HZ),
    ]
    return Steps(scenario.load(setup, overrides, seed))


def _after_switches(steps: Steps, watched: int) -> list[int]:
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
