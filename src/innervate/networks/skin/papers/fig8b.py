"""Fig. 8b: convergence over the distance between the interface ports, setups 1-4, against Eq. 6."""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from innervate.networks.skin.analysis.rows import parent_changes
from innervate.networks.skin.papers.common import (
    RULE_NAMES,
    RULES,
    Case,
    joined,
    mean_of,
    percent,
    periods,
    recovery_point,
    seeds_of,
)
from innervate.networks.skin.sim.simulate import simulate
from innervate.papers.experiment import Claim, Experiment, Point, Results, Span, verdict
from innervate.plot import style

# Setups and their h: cells on the shortest path between the two interfaces [skin 1a].
SETUPS = (("setup-4", 5), ("setup-3", 7), ("setup-2", 9), ("setup-1", 13))
KS = (3, 5, 8)
HZ = 250
BAND = 2  # periods, Eq. 6
COLUMNS = 11  # of setup 2, which is wider than high
WIDE = Case("setup-2", HZ, 3)
INSIDE = Span(0.95, 1.0)  # share of the recoveries in the band
SLOPE = Span(0.4, 0.6)  # periods a cell
FIT = Span(0.8, 1.0)  # R2 of the line


def case(setup: str, k: int, rule: str, m: int) -> Case:
    """The case of one setting, with periodic beacons."""
    return Case(setup, HZ, k, rule, "periodic", m)


def seeds(quick: bool) -> range:
    """How many recoveries a setting."""
    return seeds_of(8 if quick else 40)


def points(quick: bool) -> list[Point]:
    """Four setups, three k, both rules."""
    made = [
        recovery_point(case(setup, k, rule, m), seeds(quick))
        for rule, m in RULES
        for setup, _ in SETUPS
        for k in KS
    ]
    return [*made, Point.of(_last_key(quick), 0.03 * len(seeds(quick)), last_cells, seeds(quick))]


def _last_key(quick: bool) -> str:
    return f"fig8b last cells of {WIDE.key(seeds(quick))}"


def last_cells(some: Sequence[int]) -> dict[str, Any]:
    """Of setup 2: runs whose last switch was at an outer column; and how the middle fared.

    `middle` is the mean convergence in periods of the columns next to the interfaces' alone.
    """
    outer, middle = 0, []
    for seed in some:
        result = simulate(WIDE.plan(seed))
        changes = parent_changes(result)
        cut_us = result.plan.faults[0].at_us
        after = (changes.time_us > cut_us) & ~changes.balancing
        column = changes.cell % COLUMNS
        outer += bool(column[after][-1] in (0, 1, COLUMNS - 2, COLUMNS - 1))
        inner = after & (np.abs(column - COLUMNS // 2) <= 1)
        middle.append(float(changes.time_us[inner][-1] - cut_us) / 1e3 / WIDE.period_ms)
    return {"outer": outer, "runs": len(some), "middle": sum(middle) / len(middle)}


def converged(results: Results, quick: bool, setup: str, k: int, rule: str, m: int) -> np.ndarray:
    """Convergence of every seed, in periods."""
    found: np.ndarray = periods(results, case(setup, k, rule, m), seeds(quick), "converged_ms")
    return found


def draw(results: Results, quick: bool) -> Figure:
    """One panel a rule; grey boxes are Eq. 6 and its band."""
    figure, axes = style.panels(style.WIDE_IN, 3.0, 1, len(RULES), sharey=True)
    for ax, letter, (rule, m) in zip(axes, "abc", RULES, strict=True):
        _panel(ax, results, quick, rule, m)
        ax.set_title(f"{letter}  {RULE_NAMES[rule]}")
    axes[0].set_ylabel("convergence (ms)")
    axes[0].set_yscale("log")
    axes[0].set_yticks([20, 30, 50, 100, 200, 400], ["20", "30", "50", "100", "200", "400"])
    axes[0].minorticks_off()
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside upper center", ncols=5)
    return figure


def _panel(ax: Axes, results: Results, quick: bool, rule: str, m: int) -> None:
    half = BAND * 1e3 / HZ
    for place, (setup, distance) in enumerate(SETUPS):
        for i, k in enumerate(KS):
            x = place + 0.27 * (i - 1)
            middle = (ceil(distance / 2) + k) * 1e3 / HZ
            edges = [x - 0.11, x + 0.11]
            once = place == 0 and i == 0
            ax.fill_between(edges, middle - half, middle + half, color=style.FAINT, lw=0,
                            label="Eq. 6 and its band" if once else None)  # fmt: skip
            ax.plot(edges, [middle, middle], color=style.SOFT, lw=0.9)
            ms = converged(results, quick, setup, k, rule, m) * 1e3 / HZ
            colour = style.SERIES[i]
            ax.plot([x, x], [np.nanmin(ms), np.nanmax(ms)], color=colour, lw=1)
            ax.plot(x, mean_of(ms), style.MARKERS[i], color=colour,
                    label=f"k = {k}" if place == 0 else None)  # fmt: skip
    ticks = [f"{distance}\nsetup {setup[-1]}" for setup, distance in SETUPS]
    ax.set_xticks(range(len(SETUPS)), ticks)
    ax.set_xlabel("cells between the interface ports, h")
    ax.grid(axis="x", visible=False)


def judge(results: Results, quick: bool) -> list[Claim]:
    """The band, and how convergence grows with h."""
    return [
        claim
        for rule, m in RULES
        for claim in (_band(results, quick, rule, m), _slope(results, quick, rule, m))
    ]


def _band(results: Results, quick: bool, rule: str, m: int) -> Claim:
    shares, wider, means = {}, [], {}
    for setup, h in SETUPS:
        off = np.concatenate(
            [converged(results, quick, setup, k, rule, m) - k - ceil(h / 2) for k in KS]
        )
        shares[setup] = float((np.abs(off) <= BAND).mean())
        means[setup] = mean_of(off)
        wider.append(float((np.abs(off) <= 3).mean()))
    words = joined(
        f"setup {setup[-1]} {percent(share)} ({means[setup]:+.1f} T)"
        for setup, share in sorted(shares.items())
    )
    runs = len(seeds(quick)) * len(KS)
    failing = [setup[-1] for setup, share in sorted(shares.items()) if not INSIDE.has(share)]
    if rule == "feasible":
        last = results[_last_key(quick)]
        reason = (
            "E22: ceil(h/2) is the depth on the path between the interfaces alone. Setup 2 is "
            "wider than high: the last to switch is a cell of the outer columns in "
            f"{last['outer']} of {last['runs']} runs (k = 3); the middle columns take "
            f"{last['middle']:.1f} T, Eq. 6 says 8"
        )
    else:
        reason = "E25: recovery counts up round a loop before it finds the other interface"
    return Claim(
        "8b",
        f"{RULE_NAMES[rule]}: convergence = (ceil(h/2) + k) T +-2 T (Eq. 6) for setups 1-4 "
        f"at 250 Hz, k 3, 5, 8 (at least {percent(INSIDE.low)} inside)",
        f"inside the band of {runs} each (mean distance from Eq. 6): {words}; "
        f"within +-3 T at least {percent(min(wider))}",
        verdict(not failing, "E21", "E22"),
        reason if failing else "a mean with a band, not a bound",
    )


def _slope(results: Results, quick: bool, rule: str, m: int) -> Claim:
    h = np.array([distance for _, distance in SETUPS for _ in KS], float)
    mean = np.array(
        [mean_of(converged(results, quick, s, k, rule, m)) - k for s, _ in SETUPS for k in KS]
    )
    slope, offset = np.polyfit(h, mean, 1)
    fit = float(np.corrcoef(h, mean)[0, 1] ** 2)
    return Claim(
        "8b",
        f"{RULE_NAMES[rule]}: convergence grows almost linearly with h (R2 at least "
        f"{FIT.low:g}), half a period a cell ({SLOPE.low:g} to {SLOPE.high:g})",
        f"{slope:.2f} T a cell, {offset:+.1f} T at h = 0, R2 = {fit:.2f}",
        verdict(SLOPE.has(float(slope)) and FIT.has(fit)),
        "E25: counting up round the loop takes longer, the deeper the part that was cut off"
        if rule != "feasible"
        else "E22: setup 2, wider than high, lies above the line",
    )


EXPERIMENT = Experiment(
    "fig8b",
    "Fig. 8b: convergence over the distance between the interface ports",
    "Cut of interface 1 at 250 Hz. Grey boxes: Eq. 6, +-2 periods. Markers: mean; bars: least to "
    "greatest of all seeds.",
    points,
    draw,
    judge,
)
