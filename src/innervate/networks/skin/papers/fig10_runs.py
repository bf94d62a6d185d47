"""Fig. 10's runs: setups 5-7 with the static tree and the dynamic protocol, loads and loss."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from innervate import scenario
from innervate.networks.skin.analysis import formulas
from innervate.networks.skin.analysis.load import balance_factor, port_loads
from innervate.networks.skin.papers.common import seeds_of
from innervate.networks.skin.papers.steps import Steps
from innervate.papers.experiment import Point, Results
from innervate.sim.cables.wires import DELIVERED, OFFERED

SETUPS = ("setup-5", "setup-6", "setup-7")
RATE_HZ = 250
BEACON_HZ = 10


class Mode(NamedTuple):
    """A protocol, and how long it is left to settle before anything is counted."""

    rule: str
    name: str
    settle_s: float
    queue: int = 8
    forward_us: tuple[int, int] = (0, 2000)


STATIC = Mode("static", "static tree", 4.0)
DYNAMIC = Mode("feasible", "dynamic, balanced", 120.0)
# Where a subtree alone nearly fills its cable, the queue decides (setup 7).
QUEUED = Mode("feasible", "dynamic, longer queues", 40.0, 16)
# How unevenly cells forward what sets the tree up is not published: at most a hop's latency.
EVEN = Mode("static", "static tree, even", 4.0, forward_us=(0, 160))
MODES = (STATIC, DYNAMIC)
DRAWN = (STATIC, EVEN, DYNAMIC)


def seeds(quick: bool, mode: Mode) -> range:
    """Static trees differ more and settle at once."""
    if mode is QUEUED:
        return seeds_of(1 if quick else 4)
    if quick:
        return seeds_of(1 if mode is DYNAMIC else 6)
    return seeds_of(10 if mode is DYNAMIC else 40)


def window_s(quick: bool) -> float:
    """How long data are counted."""
    return 4.0 if quick else 10.0


def _key(setup: str, mode: Mode, seed: int, quick: bool) -> str:
    return (
        f"fig10 {setup} {mode.rule} {BEACON_HZ} Hz, data {RATE_HZ} Hz, "
        f"queue {mode.queue}, forwarded after {mode.forward_us[0]}-{mode.forward_us[1]} us, "
        f"settled {mode.settle_s:g} s, counted {window_s(quick):g} s, "
        f"seed {seed}"
    )


def points(quick: bool) -> list[Point]:
    """A run each; the long ones first."""
    runs = [(setup, mode) for mode in reversed(DRAWN) for setup in SETUPS]
    return [
        Point.of(
            _key(setup, mode, seed, quick),
            0.04 * (mode.settle_s + window_s(quick)),
            *(measure, setup, mode, seed, window_s(quick)),
        )
        for setup, mode in [*runs, (SETUPS[-1], QUEUED)]
        for seed in seeds(quick, mode)
    ]


def measure(setup: str, mode: Mode, seed: int, window: float) -> dict[str, Any]:
    """Balance factor, loads and loss after settling."""
    overrides = [
        ("protocol.rule", mode.rule),
        ("protocol.updates", "periodic"),
        ("protocol.beacon_hz", BEACON_HZ),
        ("data.rate_hz", RATE_HZ),
        ("protocol.forward_us", list(mode.forward_us)),
        ("data.queue", mode.queue),
        ("duration_s", mode.settle_s + window),
    ]
    steps = Steps(scenario.load(setup, overrides, seed))
    steps.to(mode.settle_s)
    before = steps.counters()
    steps.to(mode.settle_s + window)
    after = steps.counters()
    offered, delivered = (after[word] - before[word] for word in (OFFERED, DELIVERED))
    loads = port_loads(steps)
    return {
        "beta": balance_factor(loads),
        "loads": loads,
        "loss": 1 - delivered / offered,
        "cells": steps.plan.graph.cells,
    }


def values(results: Results, quick: bool, setup: str, mode: Mode, name: str) -> np.ndarray:
    """A measured value of each seed, as an array."""
    keys = [_key(setup, mode, seed, quick) for seed in seeds(quick, mode)]
    return np.array([results[key][name] for key in keys])


def bound(results: Results, quick: bool, setup: str) -> float:
    """Least loss that the interface ports allow."""
    cells = int(values(results, quick, setup, DYNAMIC, "cells")[0])
    ports = values(results, quick, setup, DYNAMIC, "loads").shape[1]
    return formulas.loss_bound(cells, ports, RATE_HZ, BEACON_HZ)
