"""Fig. 10's runs: setups 5-7 with the static tree and the dynamic protocol, loads and loss."""

from typing import Any, NamedTuple

import numpy as np

from innervate.networks.skin.analysis import formulas
from innervate.networks.skin.analysis.load import balance_factor, port_loads
from innervate.networks.skin.papers.common import loaded, seeds_of
from innervate.networks.skin.papers.steps import Steps
from innervate.papers.experiment import Measured, Point
from innervate.plot import style
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
DRAWN = {STATIC: style.VERMILION, EVEN: style.ORANGE, DYNAMIC: style.BLUE}


def seeds(quick: bool, mode: Mode) -> range:
    """Static trees differ more and settle at once."""
    if mode is QUEUED:
        return seeds_of(1 if quick else 4)
    if quick:
        return seeds_of(1 if mode is DYNAMIC else 6)
    return seeds_of(10 if mode is DYNAMIC else 40)


def runs(setup: str, mode: Mode, quick: bool) -> list[Point]:
    """One run for each seed."""
    window_s = 4.0 if quick else 10.0
    low, high = mode.forward_us
    words = (
        f"fig10 {setup} {mode.rule} {BEACON_HZ} Hz, data {RATE_HZ} Hz, queue {mode.queue}, "
        f"forwarded after {low}-{high} us, settled {mode.settle_s:g} s, counted {window_s:g} s, "
    )
    cost_s = 0.04 * (mode.settle_s + window_s)
    return [
        Point.of(f"{words}seed {seed}", cost_s, measure, setup, mode, seed, window_s)
        for seed in seeds(quick, mode)
    ]


def points(quick: bool) -> list[Point]:
    """All runs, the long ones first."""
    cases = [(setup, mode) for mode in reversed(DRAWN) for setup in SETUPS]
    return [one for case in (*cases, (SETUPS[-1], QUEUED)) for one in runs(*case, quick)]


def measure(setup: str, mode: Mode, seed: int, window_s: float) -> dict[str, Any]:
    """Balance factor, loads and loss after settling."""
    steps = Steps(loaded(
        setup, seed, mode.settle_s + window_s, {"data.rate_hz": RATE_HZ, "data.queue": mode.queue},
        rule=mode.rule, updates="periodic", beacon_hz=BEACON_HZ, forward_us=list(mode.forward_us),
    ))  # fmt: skip
    steps.to(mode.settle_s)
    before = steps.counters()
    steps.to(mode.settle_s + window_s)
    after = steps.counters()
    offered, delivered = (after[word] - before[word] for word in (OFFERED, DELIVERED))
    loads = port_loads(steps)
    return {"beta": balance_factor(loads), "loads": loads, "loss": 1 - delivered / offered,
            "cells": steps.plan.graph.cells}  # fmt: skip


def values(got: Measured, setup: str, mode: Mode, name: str) -> np.ndarray:
    """A measured value of each seed, as an array."""
    return np.array([got[point][name] for point in runs(setup, mode, got.quick)])


def bound(got: Measured, setup: str) -> float:
    """Least loss that the interface ports allow."""
    cells = int(values(got, setup, DYNAMIC, "cells")[0])
    ports = values(got, setup, DYNAMIC, "loads").shape[1]
    return formulas.loss_bound(cells, ports, RATE_HZ, BEACON_HZ)
