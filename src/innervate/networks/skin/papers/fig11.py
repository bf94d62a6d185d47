"""Fig. 11: a controlled arm whose skin loses a cable; 20 Hz beacons, k = 8."""

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from innervate.networks.skin.analysis import formulas
from innervate.networks.skin.analysis.recovery import recoveries
from innervate.networks.skin.analysis.rows import unrouted_steps
from innervate.networks.skin.papers import arm
from innervate.networks.skin.papers.common import planned
from innervate.networks.skin.sim.simulate import simulate
from innervate.papers import drawing
from innervate.papers.experiment import Claim, Claims, Measured, Point, Span, about, verdict
from innervate.papers.words import joined
from innervate.plot import style

TITLE = "Fig. 11: a failure at a controlled arm"
CAPTION = (
    "A two-joint arm gives way to a hand that strokes round its forearm, controlled by what the PC "
    "hears of 35 cells (100 Hz). Interface 1 is unplugged at 2.6 s. Beacons at 20 Hz, k = 8."
)
SETUP = "setup-4"  # 7 columns along the forearm, 5 rows round it; h = 5, so ceil(h/2) = 3
COLUMNS, ROWS, DEPTH = 7, 5, 3
BEACON_HZ, K = 20, 8
DATA_HZ = 100
LEAD_S = 4.0  # until the slowest start-up is over; the figure's time starts here
UNPLUG_S = 2.6
DURATION_S = 8.0
AROUND_500 = about(500.0)  # ms, the mean
OFF = Span(0.0, 0.1)  # largest difference from no failure, of the whole movement
FASTER = Span(0.0, 1.1)  # highest joint speed after the unplugging, of the usual one
TWO_SECONDS = about(2000.0)  # ms without a route beyond the detection
KEPT = 5  # of the arm's steps one in five is stored
# Name, rule, unplugged, colour, dash.
CASES: tuple[tuple[str, str, bool, str, Any], ...] = (
    ("no failure", "feasible", False, style.INK, "-"),
    ("dynamic", "feasible", True, style.BLUE, (0, (4, 1.5))),
    ("static tree", "static", True, style.VERMILION, (0, (1.5, 1.2))),
)


def runs(name: str, quick: bool) -> Point:
    """All runs of one case."""
    rule, cut = next(case[1:3] for case in CASES if case[0] == name)
    seeds = 3 if quick else 20
    return Point.each(f"fig11 {name} {BEACON_HZ} Hz k={K}", 0.4, seeds, measure, rule, cut)


def points(quick: bool) -> list[Point]:
    """The runs of each case."""
    return [runs(name, quick) for name, *_ in CASES]


def touch() -> list[list[float]]:
    """A hand that strokes round the forearm and along it: [t_s, x_mm, y_mm] on the skin."""
    path = [[0.0, 20.0, -150.0], [1.0, 20.0, -150.0]]
    for t in np.arange(1.2, 6.01, 0.1):
        x, y = 20.0 + 12.0 * (float(t) - 1.2), 24.2 - 34.0 * np.cos(2 * np.pi * (t - 0.2) / 4.0)
        path.append([round(float(t), 3), round(x, 2), round(float(y), 2)])
    path.append([6.2, 80.0, -150.0])
    return [[round(LEAD_S + t, 3), x, y] for t, x, y in path]


def measure(rule: str, cut: bool, seed: int) -> dict[str, Any]:
    """The arm's joints, the cells heard, and how the network recovered."""
    event = [{"action": "cut", "interface": 1, "at_s": LEAD_S + UNPLUG_S}] if cut else []
    hand = {"path": touch(), "radius_mm": 26.0, "force_n": 1.5}
    more = {"data.rate_hz": DATA_HZ, "touch": hand, "event": event}
    plan = planned(SETUP, seed, LEAD_S + DURATION_S, more, rule=rule, updates="periodic",
                   beacon_hz=BEACON_HZ, k=K)  # fmt: skip
    result = simulate(plan, deliveries=True)
    steps = slice(round(LEAD_S * 1e6 / arm.STEP_US), None)
    moved = arm.move(result.deliveries, arm.torque_table(ROWS, COLUMNS), result.ended_us)
    moved = {name: values[steps] for name, values in moved.items()}
    late = moved["speed"][round(UNPLUG_S * 1e6 / arm.STEP_US) :]
    unrouted = unrouted_steps(result)
    found: dict[str, Any] = {
        "angle": np.degrees(moved["angle"])[::KEPT].round(3).T.tolist(),
        "speed_max": float(np.degrees(np.abs(late).max())),
        "heard": moved["heard"][::KEPT].astype(int).tolist(),
        "unrouted_max": int(unrouted.cells[unrouted.time_us > 1e6 * LEAD_S].max(initial=0)),
    }
    return {**found, **(recoveries(result)[0] if cut else {})}


def apart(got: Measured, name: str) -> Any:
    """Largest difference from the run without a failure, degrees, of every seed."""
    off = got.floats(runs(name, got.quick), "angle") - _calm(got)
    return np.abs(off).max(axis=(1, 2))


def _calm(got: Measured) -> Any:
    """Both joints over time without a failure, degrees, shape (seeds, 2, steps)."""
    return got.floats(runs("no failure", got.quick), "angle")


def draw(got: Measured) -> Figure:
    """Joints, their difference from no failure, cells heard; of the first seed."""
    figure, axes = style.panels(
        style.WIDE_IN, 4.6, 4, 1, sharex=True, height_ratios=(1.2, 1.2, 0.9, 0.9)
    )
    calm = _calm(got)[0]
    time = np.arange(calm.shape[1]) * KEPT * arm.STEP_US / 1e6
    for name, _, _, colour, dash in CASES:
        found = runs(name, got.quick)
        joints = got.floats(found, "angle")[0]
        off = np.abs(joints - calm).max(axis=0)
        for ax, values in zip(axes, (*joints, off, got[found]["heard"][0]), strict=True):
            label = name if ax in axes[:2] else None
            ax.plot(time, values, color=colour, ls=dash, lw=1.1, label=label)
    words = ("joint 1 (°)", "joint 2 (°)", "off by (°)", "cells heard")
    for ax, word in zip(axes, words, strict=True):
        ax.axvline(UNPLUG_S, color=style.SOFT, lw=0.8, ls="--")
        ax.set_ylabel(word)
    axes[1].text(UNPLUG_S + 0.08, 0.04, "unplugged", transform=axes[1].get_xaxis_transform(),
                 fontsize=6.5)  # fmt: skip
    axes[3].set_xlabel("time (s)")
    axes[0].set_xlim(0, DURATION_S)
    axes[3].set_ylim(0, 1.12 * ROWS * COLUMNS)
    drawing.legend(figure, axes[0], "upper center", ncols=3)
    figure.align_ylabels(axes)
    return figure


def judge(got: Measured) -> Claims:
    """Convergence of about 500 ms; joints before, during and after."""
    dynamic, calm = (runs(name, got.quick) for name in ("dynamic", "no failure"))
    found, detected = (got.floats(dynamic, f"{what}_ms") for what in ("converged", "detected"))
    middle = 1e3 * formulas.convergence_by_depth_s(DEPTH, K, BEACON_HZ)
    half = 1e3 * formulas.convergence_error_s(BEACON_HZ)
    setup_1 = 1e3 * formulas.convergence_s(BEACON_HZ, K)
    inside = Span(-half, half).share(found - middle)
    yield Claim(
        "11",
        f"{BEACON_HZ} Hz, k = {K}: total convergence of around 500 ms (the mean "
        f"{AROUND_500.low:.0f} to {AROUND_500.high:.0f} ms)",
        f"{found.mean():.0f} ms ({found.min():.0f} to {found.max():.0f}), of it detection "
        f"{detected.mean():.0f} ms; {len(found)} runs of 35 cells; inside Eq. 7's band "
        f"({middle:.0f} +-{half:.0f} ms) {100 * inside:.0f} %",
        verdict(AROUND_500.has(float(found.mean())), "E30"),
        f"a patch with d_m = {DEPTH}; a skin like setup 1 would take {setup_1:.0f} ms",
    )
    off = apart(got, "dynamic")
    span = float(np.ptp(_calm(got)[0], axis=1).max())
    ratio = float((got.floats(dynamic, "speed_max") / got.floats(calm, "speed_max")).max())
    yield Claim(
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
    yield _static(got)


def _static(got: Measured) -> Claim:
    cut = {name: runs(name, got.quick) for name in ("dynamic", "static tree")}
    off, dynamic = (apart(got, name) for name in ("static tree", "dynamic"))
    outage, detected = (got.floats(cut["static tree"], f"{w}_ms") for w in ("routed", "detected"))
    down = outage - detected
    lost = joined(f"{name} {max(got[one]['unrouted_max'])}" for name, one in cut.items())
    return Claim(
        "11",
        "the static tree needs a restart of about two seconds (without a route "
        f"{TWO_SECONDS.low:.0f} to {TWO_SECONDS.high:.0f} ms beyond the detection), the dynamic "
        "protocol none",
        f"static: routed again after {np.nanmean(outage):.0f} ms, {np.nanmean(down):.0f} ms of it "
        f"after the detection; difference {off.mean():.1f} deg "
        f"(worst {off.max():.1f}), {off.mean() / dynamic.mean():.1f} times the dynamic one; cells "
        f"without a route at most {lost}",
        verdict(TWO_SECONDS.has(*down) and bool(off.mean() > dynamic.mean())),
        "detection of 400 ms and the restart, which is set to 2 s (restart_s); all cells are "
        "silent meanwhile",
    )
