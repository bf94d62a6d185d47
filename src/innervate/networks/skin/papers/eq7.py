"""Eq. 7: convergence of any single failure, random cables and all interface cables, setups 1-8."""

from functools import cache
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from innervate import scenario
from innervate.networks.skin.papers import common
from innervate.networks.skin.papers.common import RULES, SETUPS, Rule
from innervate.papers import drawing
from innervate.papers.experiment import Claim, Claims, Measured, Point, Span, verdict
from innervate.papers.words import percent
from innervate.plot import style

TITLE = "Eq. 7: convergence after any single failure"
CAPTION = (
    "One cable fails at a random moment at 250 Hz; dots: failures that cut some cell off. Line and "
    "grey band: (d_m + k) T and the error bar of 3 T."
)
HZ = 250
K = 3
BAND = 3
ALL = Span(1.0, 1.0)  # share of the failures: a bound has no exceptions
# ceil(h/2) where the interfaces lie opposite each other.
HALF = {"setup-1": 7, "setup-2": 5, "setup-3": 4, "setup-4": 3}
KINDS = {"random": "a random cable", "interface": "an interface cable"}


def seeds(quick: bool, cut: str) -> int:
    """Random cables want more runs: about half of them carry nobody's data."""
    if cut.startswith("random"):
        return 12 if quick else 120
    return 4 if quick else 40


@cache
def cuts(setup: str) -> list[str]:
    """A random cable, and every interface port of the setup that leaves another one."""
    ports = len(scenario.load(setup).model.interface)
    return ["random link", *(f"interface {i}" for i in range(ports))]


@cache
def depth(setup: str) -> int:
    """The deepest cell of a setup, d_m."""
    return int(common.plan_of(setup).depth_max)


def points(quick: bool) -> list[Point]:
    """All setups, all cuts, all rules."""
    return [
        rule.case(setup, HZ, K, cut).point(seeds(quick, cut))
        for rule in RULES
        for setup in SETUPS
        for cut in cuts(setup)
    ]


def ratios(got: Measured, setup: str, rule: Rule, kind: str) -> Any:
    """(convergence, routed) in periods of all failures that cut somebody off, a row each."""
    rows = [np.empty((0, 2))]
    for cut in cuts(setup):
        if cut.startswith(kind):
            point = rule.case(setup, HZ, K, cut).point(seeds(got.quick, cut))
            both = [got.floats(point, name) for name in ("converged_ms", "routed_ms")]
            rows.append(np.stack(both, axis=1)[got.floats(point, "cut_cells") > 0])
    return np.concatenate(rows) * HZ / 1e3


def draw(got: Measured) -> Figure:
    """Every failure as a dot over the bound of its setup, a panel a rule."""
    figure, first = common.rule_panels(3.2, lambda ax, rule: _panel(ax, got, rule))
    first.set_ylabel("convergence (periods)")
    drawing.logarithmic(first, y=[2, 5, 10, 20, 50, 100])
    first.set_ylim(1.5, 140)
    drawing.legend(figure, first, "upper center", ncols=4)
    return figure


def _panel(ax: Axes, got: Measured, rule: Rule) -> None:
    rng = np.random.default_rng(1)
    for x, setup in enumerate(SETUPS):
        said = (lambda words: words) if x == 0 else (lambda words: None)
        bound = depth(setup) + K
        edges = [x - 0.42, x + 0.42]
        ax.fill_between(edges, bound - BAND, bound + BAND, color=style.FAINT, lw=0)
        ax.plot(edges, [bound, bound], color=style.BLACK, lw=1,
                label=said("Eq. 7, $d_m$ = deepest cell, and its band"))  # fmt: skip
        if setup in HALF:
            ax.plot(edges, [HALF[setup] + K] * 2, color=style.BLACK, lw=0.8, ls=":",
                    label=said("Eq. 7, $d_m$ = ceil(h/2)"))  # fmt: skip
        for i, (kind, words) in enumerate(KINDS.items()):
            values = ratios(got, setup, rule, kind)[:, 0]
            values = values[np.isfinite(values)]
            at = x + (-0.2, 0.2)[i] + rng.uniform(-0.13, 0.13, len(values))
            ax.plot(at, values, style.MARKERS[i], color=style.SERIES[i], ms=1.8, mew=0, alpha=0.6,
                    label=said(words))  # fmt: skip
    ax.set_xticks(range(len(SETUPS)), [setup[-1] for setup in SETUPS])
    ax.set_xlabel("setup")


def judge(got: Measured) -> Claims:
    """Bounded, for all rules; a mean for interface cables."""
    for rule in RULES:
        for band in (BAND, 0):
            yield _bound(got, rule, band)
    over = np.concatenate([ratios(got, s, RULES[0], "interface")[:, 0] - h - K
                           for s, h in HALF.items()])  # fmt: skip
    above = float((over > 0).mean())
    yield Claim(
        "Eq. 7",
        "rule feasible: a bound also with d_m = ceil(h/2) (setups 1-4, interface cables)",
        f"{percent(above)} of {len(over)} failures above it, mean {over.mean():+.2f} T",
        verdict(ALL.has(1 - above)),
        "E21: a mean with a band, not a bound: half of all recoveries are slower than the mean",
    )


def _bound(got: Measured, rule: Rule, band: int) -> Claim:
    parts = [ratios(got, s, rule, kind) - depth(s) - K for s in SETUPS for kind in KINDS]
    over = np.concatenate(parts)
    over = over[np.isfinite(over[:, 0])]
    share, routed = (Span(high=band).share(part) for part in over.T)
    last = parts[-1][:, 0]
    return Claim(
        "Eq. 7",
        f"{rule.words}: any single failure converges within (d_m + k) T (k = {K}, {HZ} Hz)"
        + (f" + {band} T" if band else ", without the error bar"),
        f"{percent(share, 1)} of {len(over)} failures (setup 8, interface "
        f"cables: {(last <= band).sum()} of {len(last)}), mean {over[:, 0].mean():+.1f} T, 95 % "
        f"within {np.percentile(over[:, 0], 95):+.1f} T, worst {over[:, 0].max():+.1f} T; routed "
        f"within it: {percent(routed, 1)}",
        verdict(ALL.has(share), "E21", "E22"),
        "with d_m the deepest cell of the setup (E22), not ceil(h/2)"
        if rule.name == "feasible"
        else "E25: recoveries count up round loops; E26: with M = 1 parents go on changing long "
        "after every cell has a route again (phases drift, a nearer port is allowed now and "
        "then), so the last one comes late",
    )
