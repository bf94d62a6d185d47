"""Fig. 8b: convergence over the distance between the interface ports, setups 1-4, against Eq. 6."""

from math import ceil
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from innervate.networks.skin.analysis.rows import parent_changes
from innervate.networks.skin.papers import common
from innervate.networks.skin.papers.common import RULES, Case, Rule, number
from innervate.networks.skin.sim.simulate import simulate
from innervate.papers import drawing
from innervate.papers.experiment import Claim, Claims, Measured, Point, Span, sized, verdict
from innervate.papers.words import joined, percent
from innervate.plot import style

TITLE = "Fig. 8b: convergence over the distance between the interface ports"
CAPTION = (
    "Cut of interface 1 at 250 Hz. Grey boxes: Eq. 6, +-2 periods. Markers: mean; bars: least to "
    "greatest of all seeds."
)
# Setups and their h: cells on the shortest path between the two interfaces [skin 1a].
SETUPS = {"setup-4": 5, "setup-3": 7, "setup-2": 9, "setup-1": 13}
KS = (3, 5, 8)
HZ = 250
BAND = 2  # periods, Eq. 6
COLUMNS = 11  # of setup 2, which is wider than high
WIDE = Case("setup-2", HZ, 3)
INSIDE = Span(0.95, 1.0)  # share of the recoveries in the band
SLOPE = Span(0.4, 0.6)  # periods a cell
FIT = Span(0.8, 1.0)  # R2 of the line
seeds = sized(8, 40)  # of the recoveries of each setting


def last(quick: bool) -> Point:
    """Who switches last in setup 2."""
    return Point.each(f"fig8b last cells of {WIDE}", 0.03, seeds(quick), last_cells)


def points(quick: bool) -> list[Point]:
    """Four setups, three k, all rules."""
    made = [rule.case(setup, HZ, k) for rule in RULES for setup in SETUPS for k in KS]
    return [*(one.point(seeds(quick)) for one in made), last(quick)]


def last_cells(seed: int) -> dict[str, Any]:
    """Of setup 2: was the last switch at an outer column; and how the middle fared.

    `middle` is the convergence in periods of the columns next to the interfaces' alone.
    """
    result = simulate(WIDE.plan(seed))
    changes = parent_changes(result)
    cut_us = result.plan.faults[0].at_us
    after = (changes.time_us > cut_us) & ~changes.balancing
    column = changes.cell % COLUMNS
    inner = after & (np.abs(column - COLUMNS // 2) <= 1)
    middle = float(changes.time_us[inner][-1] - cut_us) / 1e3 / WIDE.period_ms
    outer = bool(column[after][-1] in (0, 1, COLUMNS - 2, COLUMNS - 1))
    return {"outer": outer, "middle": middle}


def converged(got: Measured, setup: str, k: int, rule: Rule) -> Any:
    """Convergence of every seed, in periods."""
    return rule.case(setup, HZ, k).periods(got, seeds(got.quick), "converged_ms")


def draw(got: Measured) -> Figure:
    """One panel a rule; grey boxes are Eq. 6 and its band."""
    figure, first = common.rule_panels(3.0, lambda ax, rule: _panel(ax, got, rule))
    first.set_ylabel("convergence (ms)")
    drawing.logarithmic(first, y=[20, 30, 50, 100, 200, 400])
    drawing.legend(figure, first, "upper center", ncols=5)
    return figure


def _panel(ax: Axes, got: Measured, rule: Rule) -> None:
    half = BAND * 1e3 / HZ
    for place, (setup, distance) in enumerate(SETUPS.items()):
        for i, k in enumerate(KS):
            x = place + 0.27 * (i - 1)
            middle = (ceil(distance / 2) + k) * 1e3 / HZ
            edges = [x - 0.11, x + 0.11]
            ax.fill_between(edges, middle - half, middle + half, color=style.FAINT, lw=0,
                            label="Eq. 6 and its band" if place == i == 0 else None)  # fmt: skip
            ax.plot(edges, [middle, middle], color=style.SOFT, lw=0.9)
            ms = converged(got, setup, k, rule) * 1e3 / HZ
            ax.plot([x, x], [np.nanmin(ms), np.nanmax(ms)], color=style.SERIES[i], lw=1)
            ax.plot(x, common.mean_of(ms), style.MARKERS[i], color=style.SERIES[i],
                    label=f"k = {k}" if place == 0 else None)  # fmt: skip
    drawing.each_mode(ax, [f"{distance}\n{number(setup)}" for setup, distance in SETUPS.items()])
    ax.set_xlabel("cells between the interface ports, h")


def judge(got: Measured) -> Claims:
    """The band, and how convergence grows with h."""
    for rule in RULES:
        yield _band(got, rule)
        yield _slope(got, rule)


def _band(got: Measured, rule: Rule) -> Claim:
    off = {
        setup: np.concatenate([converged(got, setup, k, rule) - k - ceil(h / 2) for k in KS])
        for setup, h in sorted(SETUPS.items())
    }
    shares = {setup: Span(-BAND, BAND).share(some) for setup, some in off.items()}
    wider = min(Span(-3, 3).share(some) for some in off.values())
    fine = INSIDE.has(*shares.values())
    reason = "E25: recovery counts up round a loop before it finds the other interface"
    if rule.name == "feasible":
        outer, middle = (got[last(got.quick)][name] for name in ("outer", "middle"))
        reason = (
            "E22: ceil(h/2) is the depth on the path between the interfaces alone. Setup 2 is "
            "wider than high: the last to switch is a cell of the outer columns in "
            f"{sum(outer)} of {len(outer)} runs (k = 3); the middle columns take "
            f"{sum(middle) / len(middle):.1f} T, Eq. 6 says 8"
        )
    return Claim(
        "8b",
        f"{rule.words}: convergence = (ceil(h/2) + k) T +-2 T (Eq. 6) for setups 1-4 "
        f"at 250 Hz, k 3, 5, 8 (at least {percent(INSIDE.low)} inside)",
        f"inside the band of {len(off['setup-1'])} each (mean distance from Eq. 6): "
        + joined(
            f"{number(s)} {percent(n)} ({common.mean_of(off[s]):+.1f} T)" for s, n in shares.items()
        )
        + f"; within +-3 T at least {percent(wider)}",
        verdict(fine, "E21", "E22"),
        "a mean with a band, not a bound" if fine else reason,
    )


def _slope(got: Measured, rule: Rule) -> Claim:
    h = np.array([distance for distance in SETUPS.values() for _ in KS], float)
    mean = np.array([common.mean_of(converged(got, s, k, rule)) - k for s in SETUPS for k in KS])
    slope, offset = np.polyfit(h, mean, 1)
    fit = float(np.corrcoef(h, mean)[0, 1] ** 2)
    return Claim(
        "8b",
        f"{rule.words}: convergence grows almost linearly with h (R2 at least "
        f"{FIT.low:g}), half a period a cell ({SLOPE.low:g} to {SLOPE.high:g})",
        f"{slope:.2f} T a cell, {offset:+.1f} T at h = 0, R2 = {fit:.2f}",
        verdict(SLOPE.has(float(slope)) and FIT.has(fit)),
        "E25: counting up round the loop takes longer, the deeper the part that was cut off"
        if rule.name != "feasible"
        else "E22: setup 2, wider than high, lies above the line",
    )
