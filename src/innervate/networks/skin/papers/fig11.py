"""Fig. 11: a controlled arm whose skin loses a cable; 20 Hz beacons, k = 8."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from innervate import scenario
from innervate.networks.skin.analysis import formulas
from innervate.networks.skin.analysis.rows import unrouted_steps
from innervate.networks.skin.analysis.summary import recoveries
from innervate.networks.skin.papers import arm
from innervate.networks.skin.papers.common import joined, seeds_of
from innervate.networks.skin.sim.simulate import simulate
from innervate.papers.experiment import Claim, Experiment, Point, Results, Span, about, verdict
from innervate.plot import style

SETUP = "setup-4"  # 7 columns along the forearm, 5 rows round it; h = 5, so ceil(h/2) = 3
COLUMNS, ROWS, DEPTH = 7, 5, 3
BEACON_HZ, K = 20, 8
DATA_HZ = 100
LEAD_S = 4.0  # until the slowest start-up is over; the figure's time starts here
UNPLUG_S = 2.6
DURATION_S = 8.0
SHOWN_SEED = 1
AROUND_500 = about(500.0)  # ms, the mean
OFF = Span(0.0, 0.1)  # largest difference from no failure, of the whole movement
FASTER = Span(0.0, 1.1)  # highest joint speed after the unplugging, of the usual one
TWO_SECONDS = about(2000.0)  # ms without a route beyond the detection
KEPT = 5  # of the arm's steps one in five is stored

# Name, rule, unplugged.
CASES = (
    ("no failure", "feasible", False),
    ("dynamic", "feasible", True),
    ("static tree", "static", True),
)
LOOKS = (("no failure", style.INK, "-"), ("dynamic", style.BLUE, (0, (4, 1.5))),
         ("static tree", style.VERMILION, (0, (1.5, 1.2))))  # fmt: skip


def seeds(quick: bool) -> range:
    """Seeds of the runs of each case: 20, or 3 if `quick`."""
    return seeds_of(3 if quick else 20)


def _key(name: str, seed: int) -> str:
    return f"fig11 {name} {BEACON_HZ} Hz k={K} seed {seed}"


def points(quick: bool) -> list[Point]:
    """Each case with each seed."""
    return [
        Point.of(_key(name, seed), 0.4, measure, rule, cut, seed)
        for seed in seeds(quick)
        for name, rule, cut in CASES
    ]


def touch() -> list[list[float]]:
    """A hand that strokes round the forearm and along it: [t_s, x_mm, y_mm] on the skin."""
    path = [[0.0, 20.0, -150.0], [1.0, 20.0, -150.0]]
    for t in np.arange(1.2, 6.01, 0.1):
        y = 24.2 - 34.0 * np.cos(2 * np.pi * (t - 0.2) / 4.0)
        path.append(
            [round(float(t), 3), round(20.0 + 12.0 * (float(t) - 1.2), 2), round(float(y), 2)]
        )
    path.append([6.2, 80.0, -150.0])
    return [[round(LEAD_S + t, 3), x, y] for t, x, y in path]


def measure(rule: str, cut: bool, seed: int) -> dict[str, Any]:
    """The arm's joints, the cells heard, and how the network recovered."""
    event = [{"action": "cut", "interface": 1, "at_s": LEAD_S + UNPLUG_S}] if cut else []
    overrides: list[tuple[str, Any]] = [
        ("protocol.rule", rule),
        ("protocol.updates", "periodic"),
        ("protocol.beacon_hz", BEACON_HZ),
        ("protocol.k", K),
        ("data.rate_hz", DATA_HZ),
        ("touch", {"path": touch(), "radius_mm": 26.0, "force_n": 1.5}),
        ("event", event),
        ("duration_s", LEAD_S + DURATION_S),
    ]
    result = simulate(scenario.plan(scenario.load(SETUP, overrides, seed)), deliveries=True)
    steps = slice(round(LEAD_S * 1e6 / arm.STEP_US), None)
    moved = arm.move(result.deliveries, arm.torque_table(ROWS, COLUMNS), result.ended_us)
    moved = {name: values[steps] for name, values in moved.items()}
    unrouted = unrouted_steps(result)
    found: dict[str, Any] = {
        "angle": np.degrees(moved["angle"])[::KEPT].round(3).T.tolist(),
        "speed_max": float(np.degrees(np.abs(_after(moved["speed"])).max())),
        "heard": moved["heard"][::KEPT].astype(int).tolist(),
        "unrouted_max": int(unrouted.cells[unrouted.time_us > 1e6 * LEAD_S].max(initial=0)),
    }
    if cut:
        found |= recoveries(result)[0]
    return found


def _after(values: Any) -> Any:
    """The part of values by step that lies behind the unplugging."""
    return values[round(UNPLUG_S * 1e6 / arm.STEP_US) :]


def angles(results: Results, name: str, seed: int) -> Any:
    """Both joints over time, degrees, shape (2, steps)."""
    return np.array(results[_key(name, seed)]["angle"])


def apart(results: Results, name: str, seed: int) -> float:
    """Largest difference from the run without a failure, degrees."""
    off = angles(results, name, seed) - angles(results, "no failure", seed)
    return float(np.abs(off).max())


def draw(results: Results, quick: bool) -> Figure:
    """Joints, their difference from no failure, cells heard."""
    figure, axes = style.panels(
        style.WIDE_IN, 4.6, 4, 1, sharex=True, height_ratios=(1.2, 1.2, 0.9, 0.9)
    )
    time = np.arange(len(angles(results, "dynamic", SHOWN_SEED)[0])) * KEPT * arm.STEP_US / 1e6
    for name, colour, dash in LOOKS:
        joints = angles(results, name, SHOWN_SEED)
        for ax, values in zip(axes[:2], joints, strict=True):
            ax.plot(time, values, color=colour, ls=dash, lw=1.1, label=name)
        off = np.abs(joints - angles(results, "no failure", SHOWN_SEED)).max(axis=0)
        axes[2].plot(time, off, color=colour, ls=dash, lw=1.1)
        heard = results[_key(name, SHOWN_SEED)]["heard"]
        axes[3].plot(time, heard, color=colour, ls=dash, lw=1.1)
    for ax in axes:
        ax.axvline(UNPLUG_S, color=style.SOFT, lw=0.8, ls="--")
    words = ("joint 1 (°)", "joint 2 (°)", "off by (°)", "cells heard")
    for ax, word in zip(axes, words, strict=True):
        ax.set_ylabel(word)
    axes[1].text(UNPLUG_S + 0.08, 0.04, "unplugged", transform=axes[1].get_xaxis_transform(),
                 fontsize=6.5)  # fmt: skip
    axes[3].set_xlabel("time (s)")
    axes[0].set_xlim(0, DURATION_S)
    axes[3].set_ylim(0, 1.12 * ROWS * COLUMNS)
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside upper center", ncols=3)
    figure.align_ylabels(axes)
    return figure


def judge(results: Results, quick: bool) -> list[Claim]:
    """Convergence of about 500 ms; joints before, during and after."""
    return [_converged(results, quick), _smooth(results, quick), _static(results, quick)]


def _all(results: Results, quick: bool, name: str, value: str) -> Any:
    return np.array([results[_key(name, seed)][value] for seed in seeds(quick)])


def _converged(results: Results, quick: bool) -> Claim:
    found = _all(results, quick, "dynamic", "converged_ms")
    middle = 1e3 * formulas.convergence_by_depth_s(DEPTH, K, BEACON_HZ)
    half = 1e3 * formulas.convergence_error_s(BEACON_HZ)
    setup_1 = 1e3 * formulas.convergence_s(BEACON_HZ, K)
    detected = _all(results, quick, "dynamic", "detected_ms")
    inside = float((np.abs(found - middle) <= half).mean())
    return Claim(
        "11",
        f"{BEACON_HZ} Hz, k = {K}: total convergence of around 500 ms (the mean "
        f"{AROUND_500.low:.0f} to {AROUND_500.high:.0f} ms)",
        f"{found.mean():.0f} ms ({found.min():.0f} to {found.max():.0f}), of it detection "
        f"{detected.mean():.0f} ms; {len(found)} runs of 35 cells; inside Eq. 7's band "
        f"({middle:.0f} +-{half:.0f} ms) {100 * inside:.0f} %",
        verdict(AROUND_500.has(float(found.mean())), "E30"),
        f"a patch with d_m = {DEPTH}; a skin like setup 1 would take {setup_1:.0f} ms",
    )


def _smooth(results: Results, quick: bool) -> Claim:
    off = np.array([apart(results, "dynamic", seed) for seed in seeds(quick)])
    span = float(np.ptp(angles(results, "no failure", SHOWN_SEED), axis=1).max())
    fast, usual = (_all(results, quick, n, "speed_max") for n in ("dynamic", "no failure"))
    ratio = float((fast / usual).max())
    return Claim(
        "11",
        f"joint states show no negative effect of the failure (at most {100 * OFF.high:.0f} % of "
        f"the movement off, at most {FASTER.high:g} times as fast)",
        f"largest difference from the same run without a failure {off.mean():.1f} deg (worst "
        f"{off.max():.1f}), of a movement of {span:.0f} deg; highest joint speed after the "
        f"unplugging at most {ratio:.2f} of the usual",
        verdict(OFF.has(float(off.max()) / span) and FASTER.has(ratio)),
        "cells that are not heard keep their last force until their route is back, so the arm lags "
        "behind the hand for half a second",
    )


def _static(results: Results, quick: bool) -> Claim:
    off, dynamic = (
        np.array([apart(results, name, seed) for seed in seeds(quick)])
        for name in ("static tree", "dynamic")
    )
    outage = _all(results, quick, "static tree", "routed_ms").astype(float)
    lost = {
        name: int(_all(results, quick, name, "unrouted_max").max()) for name, _, c in CASES if c
    }
    detected = _all(results, quick, "static tree", "detected_ms").astype(float)
    down = outage - detected
    return Claim(
        "11",
        "the static tree needs a restart of about two seconds (without a route "
        f"{TWO_SECONDS.low:.0f} to {TWO_SECONDS.high:.0f} ms beyond the detection), the dynamic "
        "protocol none",
        f"static: routed again after {np.nanmean(outage):.0f} ms, {np.nanmean(down):.0f} ms of it "
        f"after the detection; difference {off.mean():.1f} deg "
        f"(worst {off.max():.1f}), {off.mean() / dynamic.mean():.1f} times the dynamic one; cells "
        "without a route at most " + joined(f"{name} {n}" for name, n in lost.items()),
        verdict(TWO_SECONDS.has(*down) and bool(off.mean() > dynamic.mean())),
        "detection of 400 ms and the restart, which is set to 2 s (restart_s); all cells are "
        "silent meanwhile",
    )


EXPERIMENT = Experiment(
    "fig11",
    "Fig. 11: a failure at a controlled arm",
    "A two-joint arm gives way to a hand that strokes round its forearm, controlled by what the PC "
    "hears of 35 cells (100 Hz). Interface 1 is unplugged at 2.6 s. Beacons at 20 Hz, k = 8.",
    points,
    draw,
    judge,
)
