"""Fig. 10's verdicts on what the dynamic protocol gains, over the distribution of static trees."""

from __future__ import annotations

import numpy as np

from innervate.analysis.intervals import mean_interval
from innervate.papers.experiment import Claim, Results, Span, about, verdict
from innervate.papers.skin.common import joined, percent
from innervate.papers.skin.fig10_runs import (
    DYNAMIC,
    EVEN,
    MODES,
    SETUPS,
    STATIC,
    Mode,
    seeds,
    values,
)

TEN_POINTS = about(0.10)
ASKED_POINTS = Span(0.10)
ASKED = SETUPS[:2]
THIRTY_POINTS = about(0.30)
STEADIER = Span(0.0, 1 / 3)  # spread of the dynamic losses, of the static one
FIFTH = about(0.20)
UPPER = 95  # percentile of the trees that stands for "at most"


def judge(results: Results, quick: bool) -> list[Claim]:
    """Points gained, with uneven and even forwarding, at most, spread, the largest subnetwork."""
    return [
        *(_gain(results, quick, setup) for setup in SETUPS),
        _even(results, quick),
        _asked(results, quick),
        _most(results, quick),
        _spread(results, quick),
        _largest(results, quick),
    ]


def gains(results: Results, quick: bool, setup: str, mode: Mode = STATIC) -> np.ndarray:
    """Loss of every static tree minus the mean dynamic loss."""
    static = values(results, quick, setup, mode, "loss")
    return static - float(values(results, quick, setup, DYNAMIC, "loss").mean())


def _points(share: float) -> str:
    return f"{100 * share:.1f}"


def _gain(results: Results, quick: bool, setup: str) -> Claim:
    found = gains(results, quick, setup)
    static = values(results, quick, setup, STATIC, "loss")
    mean = mean_interval(static.tolist())
    low, middle, high = np.percentile(found, [5, 50, 95])
    passed = TEN_POINTS.has(float(found.mean()))
    return Claim(
        "10",
        f"setup {setup[-1]}: about 10 points less loss than the static tree (the mean "
        f"{_points(TEN_POINTS.low)} to {_points(TEN_POINTS.high)})",
        f"{100 * found.mean():.2f} points less: static {percent(mean.value, 1)} (95 % interval "
        f"{percent(mean.low, 1)} to {percent(mean.high, 1)}) over {len(found)} trees, dynamic "
        f"{percent(float(static.mean() - found.mean()), 1)}; by tree: median {_points(middle)}, "
        f"5 to 95 % {_points(low)} to {_points(high)}",
        verdict(passed, "E32", "E34"),
        f"set-up frames forwarded after {STATIC.forward_us[0]} to {STATIC.forward_us[1]} us"
        + ("" if passed else "; E34: the paper's networks are not known, these are ours"),
    )


def _even(results: Results, quick: bool) -> Claim:
    means = {s: float(gains(results, quick, s, EVEN).mean()) for s in SETUPS}
    words = joined(f"setup {s[-1]} {_points(means[s])}" for s in SETUPS)
    return Claim(
        "10",
        "about 10 points in every setup also where cells forward what sets the tree up evenly "
        f"(after {EVEN.forward_us[0]} to {EVEN.forward_us[1]} us, at most a hop's latency)",
        f"points less loss: {words}; {len(seeds(quick, EVEN))} trees each",
        verdict(TEN_POINTS.has(*means.values()), "E32", "E34"),
        "how evenly cells of the static protocol forward is not published, and decides how uneven "
        "the trees are: the figure's gains rest on it",
    )


def _asked(results: Results, quick: bool) -> Claim:
    means = {s: float(gains(results, quick, s).mean()) for s in ASKED}
    return Claim(
        "10",
        "setups 5 and 6: at least 10 points less loss than the static tree (asked for)",
        joined(f"setup {s[-1]} {_points(mean)}" for s, mean in means.items()),
        verdict(ASKED_POINTS.has(*means.values())),
    )


def _most(results: Results, quick: bool) -> Claim:
    found = {s: gains(results, quick, s) for s in SETUPS}
    upper = {s: float(np.percentile(found[s], UPPER)) for s in SETUPS}
    top = max(upper, key=lambda s: upper[s])
    reach = float((found[top] >= THIRTY_POINTS.low).mean())
    words = joined(f"setup {s[-1]} {_points(upper[s])}" for s in SETUPS)
    return Claim(
        "10",
        "at most about 30 points less loss (in one setup, of its trees the "
        f"{UPPER}th percentile, {_points(THIRTY_POINTS.low)} to {_points(THIRTY_POINTS.high)})",
        f"{UPPER}th percentile over {len(found[top])} trees: {words}; setup {top[-1]}: mean "
        f"{_points(found[top].mean())}, {percent(reach)} of the trees reach "
        f"{_points(THIRTY_POINTS.low)}, the worst {_points(found[top].max())}",
        verdict(THIRTY_POINTS.has(upper[top]), "E32", "E34"),
        "a statement on the worst trees, not on what to expect",
    )


def _spread(results: Results, quick: bool) -> Claim:
    spread = {
        mode: max(float(np.ptp(values(results, quick, s, mode, "loss"))) for s in SETUPS)
        for mode in MODES
    }
    return Claim(
        "10",
        "more deterministic results (loss spreads at most a third as much as between static trees)",
        f"loss differs by up to {_points(spread[STATIC])} points between static trees, "
        f"{_points(spread[DYNAMIC])} dynamic",
        verdict(STEADIER.has(spread[DYNAMIC] / spread[STATIC])),
    )


def _largest(results: Results, quick: bool) -> Claim:
    less = {}
    for setup in SETUPS:
        static, dynamic = (values(results, quick, setup, m, "loads").max(axis=1) for m in MODES)
        less[setup] = 1 - float(dynamic.mean()) / static
    words = joined(
        f"setup {s[-1]} {percent(found.mean())} (by tree {percent(found.min())} to "
        f"{percent(found.max())})"
        for s, found in less.items()
    )
    return Claim(
        "IV",
        "the largest subnetwork is about 20 % smaller than with the static protocol (means, "
        f"{percent(FIFTH.low)} to {percent(FIFTH.high)})",
        f"{words}; {len(less[SETUPS[0]])} trees each",
        verdict(FIFTH.has(*(float(found.mean()) for found in less.values())), "E34"),
        "it depends on the network, as the paper says, and on how evenly the static protocol "
        "forwards",
    )
