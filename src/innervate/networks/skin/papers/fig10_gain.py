"""Fig. 10's verdicts on what the dynamic protocol gains, over the distribution of static trees."""

from __future__ import annotations

import numpy as np

from innervate.analysis.intervals import mean_interval
from innervate.networks.skin.papers.common import number
from innervate.networks.skin.papers.fig10_runs import (
    DYNAMIC,
    EVEN,
    MODES,
    SETUPS,
    STATIC,
    Mode,
    seeds,
    values,
)
from innervate.papers.experiment import Claim, Claims, Measured, Span, about, verdict
from innervate.papers.words import joined, percent

TEN_POINTS = about(0.10)
ASKED_POINTS = Span(0.10)
ASKED = SETUPS[:2]
THIRTY_POINTS = about(0.30)
STEADIER = Span(0.0, 1 / 3)  # spread of the dynamic losses, of the static one
FIFTH = about(0.20)
UPPER = 95  # percentile of the trees that stands for "at most"


def judge(got: Measured) -> Claims:
    """Points gained, with uneven and even forwarding, at most, spread, the largest subnetwork."""
    for setup in SETUPS:
        yield _gain(got, setup)
    yield from _means(got)
    yield _most(got)
    yield _spread(got)
    yield _largest(got)


def gains(got: Measured, setup: str, mode: Mode = STATIC) -> np.ndarray:
    """Loss of every static tree minus the mean dynamic loss."""
    return values(got, setup, mode, "loss") - float(values(got, setup, DYNAMIC, "loss").mean())


def _points(share: float) -> str:
    return f"{100 * share:.1f}"


def _gain(got: Measured, setup: str) -> Claim:
    found = gains(got, setup)
    static = values(got, setup, STATIC, "loss")
    mean = mean_interval(static.tolist())
    low, middle, high = np.percentile(found, [5, 50, 95])
    passed = TEN_POINTS.has(float(found.mean()))
    return Claim(
        "10",
        f"{number(setup)}: about 10 points less loss than the static tree (the mean "
        f"{_points(TEN_POINTS.low)} to {_points(TEN_POINTS.high)})",
        f"{100 * found.mean():.2f} points less: static {percent(mean.value, 1)} (95 % interval "
        f"{percent(mean.low, 1)} to {percent(mean.high, 1)}) over {len(found)} trees, dynamic "
        f"{percent(float(static.mean() - found.mean()), 1)}; by tree: median {_points(middle)}, "
        f"5 to 95 % {_points(low)} to {_points(high)}",
        verdict(passed, "E32", "E34"),
        f"set-up frames forwarded after {STATIC.forward_us[0]} to {STATIC.forward_us[1]} us"
        + ("" if passed else "; E34: the paper's networks are not known, these are ours"),
    )


def _means(got: Measured) -> Claims:
    even = {setup: float(gains(got, setup, EVEN).mean()) for setup in SETUPS}
    yield Claim(
        "10",
        "about 10 points in every setup also where cells forward what sets the tree up evenly "
        f"(after {EVEN.forward_us[0]} to {EVEN.forward_us[1]} us, at most a hop's latency)",
        f"points less loss: {joined(f'{number(s)} {_points(mean)}' for s, mean in even.items())}; "
        f"{len(seeds(got.quick, EVEN))} trees each",
        verdict(TEN_POINTS.has(*even.values()), "E32", "E34"),
        "how evenly cells of the static protocol forward is not published, and decides how uneven "
        "the trees are: the figure's gains rest on it",
    )
    means = {setup: float(gains(got, setup).mean()) for setup in ASKED}
    yield Claim(
        "10",
        "setups 5 and 6: at least 10 points less loss than the static tree (asked for)",
        joined(f"{number(setup)} {_points(mean)}" for setup, mean in means.items()),
        verdict(ASKED_POINTS.has(*means.values())),
    )


def _most(got: Measured) -> Claim:
    found = {setup: gains(got, setup) for setup in SETUPS}
    upper = {setup: float(np.percentile(found[setup], UPPER)) for setup in SETUPS}
    top = max(upper, key=lambda setup: upper[setup])
    reach = float((found[top] >= THIRTY_POINTS.low).mean())
    words = joined(f"{number(setup)} {_points(upper[setup])}" for setup in SETUPS)
    return Claim(
        "10",
        "at most about 30 points less loss (in one setup, of its trees the "
        f"{UPPER}th percentile, {_points(THIRTY_POINTS.low)} to {_points(THIRTY_POINTS.high)})",
        f"{UPPER}th percentile over {len(found[top])} trees: {words}; {number(top)}: mean "
        f"{_points(found[top].mean())}, {percent(reach)} of the trees reach "
        f"{_points(THIRTY_POINTS.low)}, the worst {_points(found[top].max())}",
        verdict(THIRTY_POINTS.has(upper[top]), "E32", "E34"),
        "a statement on the worst trees, not on what to expect",
    )


def _spread(got: Measured) -> Claim:
    static, dynamic = (
        max(float(np.ptp(values(got, setup, mode, "loss"))) for setup in SETUPS) for mode in MODES
    )
    return Claim(
        "10",
        "more deterministic results (loss spreads at most a third as much as between static trees)",
        f"loss differs by up to {_points(static)} points between static trees, "
        f"{_points(dynamic)} dynamic",
        verdict(STEADIER.has(dynamic / static)),
    )


def _largest(got: Measured) -> Claim:
    less = {}
    for setup in SETUPS:
        static, dynamic = (values(got, setup, mode, "loads").max(axis=1) for mode in MODES)
        less[setup] = 1 - float(dynamic.mean()) / static
    words = joined(
        f"{number(setup)} {percent(found.mean())} (by tree {percent(found.min())} to "
        f"{percent(found.max())})"
        for setup, found in less.items()
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
