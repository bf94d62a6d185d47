"""Eq. 9: bandwidth of beacons. The printed numbers are ten times too high (E28)."""

import numpy as np
from matplotlib.figure import Figure

from innervate.networks.skin.analysis import formulas
from innervate.networks.skin.analysis.frames import beacon_share
from innervate.networks.skin.papers.common import planned
from innervate.networks.skin.sim.simulate import simulate
from innervate.papers import drawing
from innervate.papers.experiment import Claim, Claims, Measured, Point, Span, sized, verdict
from innervate.papers.words import joined
from innervate.plot import style

SETUP = "setup-1"
UPDATES = ("periodic", "triggered", "wave")
PRINTED = {10: 0.006, 100: 0.06}
PERIODS = 400
TITLE = "Eq. 9: bandwidth of beacons"
CAPTION = f"Setup 1, {PERIODS} periods without a failure; mean over all directions of all cables."
ON_FORMULA = Span(-0.02, 0.02)  # share off Eq. 9
ON_PRINTED = Span(0.9, 1.1)  # of the printed number
MORE = Span(-1.0, 0.1)  # beacons of the wave mode beyond Eq. 9
hz = sized((10, 100, 250), (10, 20, 50, 100, 150, 200, 250))  # of beacons, one point each


def point(updates: str, beacon_hz: int) -> Point:
    """A run of a frequency and mode."""
    key = f"eq9 {SETUP} {updates} {beacon_hz} Hz, {PERIODS} periods, seed 1"
    return Point.of(key, 0.1, measure, updates, beacon_hz)


def points(quick: bool) -> list[Point]:
    """A run a frequency and mode."""
    return [point(updates, f) for updates in UPDATES for f in hz(quick)]


def measure(updates: str, beacon_hz: int) -> float | None:
    """Share of the cables' capacity that beacons took, start-up included, nothing failing."""
    plan = planned(SETUP, 1, PERIODS / beacon_hz, updates=updates, beacon_hz=beacon_hz)
    return beacon_share(simulate(plan))


def draw(got: Measured) -> Figure:
    """Eq. 9 as it computes, as printed, and as measured."""
    figure, (ax,) = style.panels(style.WIDE_IN, 2.8)
    fine = np.array([8, 300])
    shares = [100 * formulas.beacon_share(f) for f in fine]
    ax.plot(fine, shares, color=style.SOFT, label="Eq. 9", zorder=1)
    for i, updates in enumerate(UPDATES):
        colour = style.SERIES[i]
        ax.plot(hz(got.quick), [100 * got[point(updates, f)] for f in hz(got.quick)],
                style.MARKERS[i], color=colour, mfc="none" if i else colour, ms=3.5 + 1.5 * i,
                label=f"measured, {updates}")  # fmt: skip
    printed = [100 * share for share in PRINTED.values()]
    ax.plot(list(PRINTED), printed, "x", color=style.BLACK, ms=5, mew=1.4, label="printed numbers")
    drawing.logarithmic(ax, [10, 20, 50, 100, 250], [0.05, 0.1, 0.5, 1, 5, 10])
    ax.set(ylim=(0.03, 14), xlabel="beacon frequency $f_b$ (Hz)")
    ax.set_ylabel("share of the bandwidth (%)")
    ax.legend(loc="lower right")
    return figure


def judge(got: Measured) -> Claims:
    """The formula, the printed numbers, the price of waves."""
    periodic, wave = (
        {f: got[point(updates, f)] for f in hz(got.quick)} for updates in ("periodic", "wave")
    )
    off, more = (
        [share / formulas.beacon_share(f) - 1 for f, share in found.items()]
        for found in (periodic, wave)
    )
    yield Claim(
        "Eq. 9",
        f"beacons take f_b * 240 bit / 4 Mbit/s (within {100 * ON_FORMULA.high:.0f} %)",
        joined(f"{100 * periodic[f]:.3f} % at {f} Hz" for f in (10, 100, 250))
        + f"; {100 * min(off):+.1f} to {100 * max(off):+.1f} % off the formula",
        verdict(ON_FORMULA.has(*off)),
    )
    yield Claim(
        "Eq. 9",
        "0.6 % at 10 Hz, 6 % at 100 Hz",
        joined(f"{100 * periodic[f]:.3f} % at {f} Hz" for f in PRINTED),
        verdict(ON_PRINTED.has(*(periodic[f] / share for f, share in PRINTED.items()))),
        "E28: the printed numbers are ten times what Eq. 9 gives",
    )
    yield Claim(
        "Eq. 9",
        "beyond the paper: wave mode needs at most a tenth more beacons than Eq. 9",
        f"{100 * min(more):+.1f} % to {100 * max(more):+.1f} %, nothing failing",
        verdict(MORE.has(*more)),
        "a tick stays silent when its beacon went out with a wave shortly before",
    )
