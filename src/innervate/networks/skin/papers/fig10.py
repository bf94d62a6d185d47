"""Fig. 10: balance factor and data loss of setups 5-7, static tree against the dynamic protocol."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from innervate import scenario
from innervate.analysis.intervals import mean_interval
from innervate.networks.skin.analysis import formulas
from innervate.networks.skin.analysis.load import balance_factor, port_loads
from innervate.networks.skin.papers.common import joined, percent, seeds_of
from innervate.networks.skin.papers.steps import Steps
from innervate.papers.experiment import Claim, Experiment, Point, Results, verdict
from innervate.plot import style
from innervate.sim.cables.wires import DELIVERED, OFFERED

SETUPS = ("setup-5", "setup-6", "setup-7")
RATE_HZ = 250
BEACON_HZ = 10
BETA_BAR = 0.999
LOSS_POINTS_BAR = 0.02
GAIN_BAR = {"setup-5": 0.10, "setup-6": 0.10}


class Mode(NamedTuple):
    """A protocol, and how long it is left to settle before anything is counted."""

    rule: str
    name: str
    settle_s: float
    queue: int = 8


STATIC = Mode("static", "static tree", 4.0)
DYNAMIC = Mode("feasible", "dynamic, balanced", 120.0)
# Where a subtree alone nearly fills its cable, the queue decides (setup 7).
QUEUED = Mode("feasible", "dynamic, longer queues", 40.0, 16)
MODES = (STATIC, DYNAMIC)


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
        f"queue {mode.queue}, settled {mode.settle_s:g} s, counted {window_s(quick):g} s, "
        f"seed {seed}"
    )


def points(quick: bool) -> list[Point]:
    """A run each; the long ones first."""
    runs = [(setup, mode) for mode in reversed(MODES) for setup in SETUPS]
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
    """One value a seed."""
    keys = [_key(setup, mode, seed, quick) for seed in seeds(quick, mode)]
    return np.array([results[key][name] for key in keys])


def bound(results: Results, quick: bool, setup: str) -> float:
    """Least loss that the interface ports allow."""
    cells = int(values(results, quick, setup, DYNAMIC, "cells")[0])
    ports = values(results, quick, setup, DYNAMIC, "loads").shape[1]
    return formulas.loss_bound(cells, ports, RATE_HZ, BEACON_HZ)


def draw(results: Results, quick: bool) -> Figure:
    """Every seed as a dot, means as bars; the capacity bound as a line."""
    figure, axes = style.panels(style.WIDE_IN, 2.5, 1, 2)
    for ax, name, scale in zip(axes, ("beta", "loss"), (1, 100), strict=True):
        for x, setup in enumerate(SETUPS):
            _setup(ax, results, quick, setup, name, scale, x)
        digits = 3 if name == "beta" else 1
        means = [
            [scale * values(results, quick, setup, mode, name).mean() for mode in MODES]
            for setup in SETUPS
        ]
        ticks = [
            f"{static:.{digits}f}   {dynamic:.{digits}f}\nsetup {setup[-1]}"
            for setup, (static, dynamic) in zip(SETUPS, means, strict=True)
        ]
        ax.set_xticks(range(len(SETUPS)), ticks)
        ax.grid(axis="x", visible=False)
    axes[0].set_ylabel("balance factor $\\beta$")
    axes[0].set_ylim(0, 1.3)
    axes[0].set_yticks(np.arange(0, 1.01, 0.2))
    axes[0].set_title("a  balance factor")
    axes[1].set_ylabel("lost data frames (%)")
    axes[1].set_title("b  data loss at 250 Hz")
    axes[0].legend(*_legend(axes[0]), loc="upper left", ncols=3, columnspacing=1)
    return figure


def _legend(ax: Axes) -> tuple[list[Any], list[str]]:
    handles = [
        *(ax.bar(0, 0, color=c, alpha=0.5) for c in (style.VERMILION, style.BLUE)),
        ax.plot([], [], color=style.BLACK, lw=1.4)[0],
    ]
    return handles, [STATIC.name, DYNAMIC.name, "capacity bound (b)"]


def _setup(
    ax: Axes, results: Results, quick: bool, setup: str, name: str, scale: float, x: int
) -> None:
    rng = np.random.default_rng(1)
    for mode, i in ((STATIC, 0), (DYNAMIC, 1)):
        colour = (style.VERMILION, style.BLUE)[i]
        found = scale * values(results, quick, setup, mode, name)
        place = x + 0.2 * (2 * i - 1)
        ax.bar(place, found.mean(), 0.36, color=colour, alpha=0.35, lw=0)
        jitter = rng.uniform(-0.1, 0.1, len(found))
        ax.plot(place + jitter, found, style.MARKERS[i], color=colour, ms=2, mew=0)
    if name == "loss":
        least = scale * bound(results, quick, setup)
        ax.plot([x - 0.4, x + 0.4], [least, least], color=style.BLACK, lw=1.4)


def judge(results: Results, quick: bool) -> list[Claim]:
    """Balance, loss against the bound, gain over the static tree."""
    return [
        _balance(results, quick),
        *(_loss(results, quick, setup) for setup in SETUPS),
        *(_gain(results, quick, setup) for setup in SETUPS),
        _spread(results, quick),
    ]


def _balance(results: Results, quick: bool) -> Claim:
    dynamic = {s: values(results, quick, s, DYNAMIC, "beta") for s in SETUPS}
    static = {s: values(results, quick, s, STATIC, "beta").mean() for s in SETUPS}
    least = min(float(found.min()) for found in dynamic.values())
    words = joined(f"setup {s[-1]} {static[s]:.2f}" for s in SETUPS)
    return Claim(
        "10",
        f"dynamic: balance factor always 1 (asked for: at least {BETA_BAR})",
        f"least of {sum(map(len, dynamic.values()))} runs {least:.4f}; static, means: {words}",
        verdict(least >= BETA_BAR, "E12", "E13", "E14"),
        "switch where S(parent) - S(other) > L; one attempt every 8 d_max periods",
    )


def _loss(results: Results, quick: bool, setup: str) -> Claim:
    found = values(results, quick, setup, DYNAMIC, "loss")
    least = bound(results, quick, setup)
    reason = ""
    if setup == SETUPS[-1]:
        longer = values(results, quick, setup, QUEUED, "loss").mean()
        reason = (
            f"above the bound because a queue of {DYNAMIC.queue} frames smooths little where a "
            f"subtree alone nearly fills its cable: with {QUEUED.queue} frames the loss is "
            f"{percent(longer, 2)}, the bound {percent(least, 2)}"
        )
    return Claim(
        "10",
        f"setup {setup[-1]}: remaining loss is that of the network's capacity "
        f"({percent(least, 1)}; asked for: at most 2 points more)",
        f"mean {percent(found.mean(), 1)}, at most {percent(found.max(), 1)}, {len(found)} runs",
        verdict(float(found.mean()) <= least + LOSS_POINTS_BAR),
        reason,
    )


def _gain(results: Results, quick: bool, setup: str) -> Claim:
    static, dynamic = (values(results, quick, setup, m, "loss") for m in MODES)
    mean = mean_interval(static.tolist())
    gain = mean.value - float(dynamic.mean())
    measured = (
        f"static {percent(mean.value, 1)} (95 % interval {percent(mean.low, 1)} to "
        f"{percent(mean.high, 1)}, worst {percent(static.max(), 1)}), dynamic "
        f"{percent(dynamic.mean(), 1)}: {100 * gain:.1f} points less"
    )
    bar = GAIN_BAR.get(setup)
    words = " (asked for: 10)" if bar else ""
    return Claim(
        "10",
        f"setup {setup[-1]}: about 10 points less loss than the static tree{words}",
        measured,
        verdict(gain >= (bar or 0.09), "E32", "E34"),
    )


def _spread(results: Results, quick: bool) -> Claim:
    most = {}
    for setup in SETUPS:
        static, dynamic = (values(results, quick, setup, m, "loss") for m in MODES)
        most[setup] = float(static.max() - dynamic.mean())
    top = max(most, key=lambda s: most[s])
    spread = [
        max(float(np.ptp(values(results, quick, s, m, "loss"))) for s in SETUPS) for m in MODES
    ]
    return Claim(
        "10",
        "about 30 % less loss at most, and more deterministic results",
        f"largest gain over one static tree {100 * most[top]:.0f} points (setup {top[-1]}); loss "
        f"differs by up to {100 * spread[0]:.0f} points between static trees, "
        f"{100 * spread[1]:.1f} dynamic",
        verdict(most[top] >= 0.25 and spread[1] < spread[0] / 3, "E32"),
    )


EXPERIMENT = Experiment(
    "fig10",
    "Fig. 10: balance factor and data loss, setups 5-7",
    "Data at 250 Hz per cell, beacons at 10 Hz. Dots: one run each; bars and numbers: means. Loss "
    "is counted after settling (static 4 s, dynamic 120 s).",
    points,
    draw,
    judge,
)
