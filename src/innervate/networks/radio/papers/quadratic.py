"""Q15: is CSMA/CD's T_D a square of n? Not with any backoff that doubles."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from matplotlib.figure import Figure

from innervate.networks.radio.papers.common import RESERVED, SIZES, Curve, joined, stations_axis
from innervate.networks.radio.papers.labels import end_labels
from innervate.papers.experiment import Claim, Experiment, Point, Results, verdict
from innervate.plot import style

NS = (2, 5, 10, 20, 50, 100)


class Variant(NamedTuple):
    """A CSMA/CD: which collision cost, which backoff."""

    name: str
    mac: str
    backoff: str


VARIANTS = (
    Variant("D1, doubling", "csma-cd-d1", "binary"),
    Variant("D2, doubling", "csma-cd-d2", "binary"),
    Variant("D2', doubling", "csma-cd-d2p", "binary"),
    Variant("D1, k+1", "csma-cd-d1", "linear"),
    Variant("D2, k+1", "csma-cd-d2", "linear"),
    Variant("D2', k+1", "csma-cd-d2p", "linear"),
)
COLOURS = (style.GREEN, style.VERMILION, style.ORANGE)


def curve(variant: Variant | None, size: int, quick: bool) -> Curve:
    """T_D of one variant; without one, of CSMA/CD-R."""
    if variant is None:
        return Curve(RESERVED, size, "disaster", NS, 1)
    options = (("backoff", variant.backoff),)
    return Curve(variant.mac, size, "disaster", NS, 60 if quick else 400, options=options)


def points(quick: bool) -> list[Point]:
    """All variants, both packet lengths."""
    return [curve(v, size, quick).point() for v in (None, *VARIANTS) for size in SIZES]


def exponent(results: Results, quick: bool, variant: Variant | None, size: int) -> float:
    """Slope in the double logarithm."""
    values = curve(variant, size, quick).mean(results, "duration")
    return float(np.polyfit(np.log(NS), np.log(values), 1)[0])


def draw(results: Results, quick: bool) -> Figure:
    """T_D at T = 25, and all exponents."""
    figure, (left, right) = style.panels(style.WIDE_IN, 2.9, 1, 2, width_ratios=(1.35, 1))
    stations_axis(left)
    left.set_yscale("log")
    ends = []
    for i, variant in enumerate(VARIANTS):
        values = curve(variant, 25, quick).mean(results, "duration")
        colour, doubling = COLOURS[i % 3], variant.backoff == "binary"
        left.plot(NS, values, style.MARKERS[i], ls=style.DASHES[0 if doubling else 1],
                  color=colour)  # fmt: skip
        ends.append((float(values[-1]), variant.name, colour))
    ours = curve(None, 25, quick).mean(results, "duration")
    left.plot(NS, ours, "o-", color=style.BLUE)
    ends.append((float(ours[-1]), "CSMA/CD-R", style.BLUE))
    x = np.array([2, 100])
    left.plot(x, 25 * x**2.0, color=style.BLACK, lw=0.8, ls=":")
    ends.append((25 * 100.0**2, "25 n²", style.BLACK))
    left.set_xlim(1.9, 105)
    end_labels(left, ends)
    left.set_ylabel("$T_D$ (slots)")
    left.set_title("a  T = 25")
    for place, one in enumerate((None, *VARIANTS)):
        for i, size in enumerate(SIZES):
            value = exponent(results, quick, one, size)
            right.plot(value, place, style.MARKERS[i], color=style.SERIES[i], ms=4,
                       label=f"T = {size}" if place == 0 else None)  # fmt: skip
    right.axvline(2, color=style.BLACK, lw=0.8, ls=":")
    right.text(1.98, 0, "square of n", ha="right", va="center", color=style.INK, fontsize=6.5)
    right.set_yticks(range(7), ["CSMA/CD-R", *(v.name for v in VARIANTS)])
    right.set_ylim(6.6, -0.6)
    right.set_xlim(0.75, 2.15)
    right.set_xlabel("exponent of $T_D$ over n = 2..100")
    right.set_title("b  fitted exponents")
    right.legend(loc="center", bbox_to_anchor=(0.68, 0.64))
    return figure


def judge(results: Results, quick: bool) -> list[Claim]:
    """Not the square with doubling; nearly with linear windows."""
    runs = curve(VARIANTS[0], 25, quick).seeds
    doubling = {
        (v.name, size): exponent(results, quick, v, size) for v in VARIANTS[:3] for size in SIZES
    }
    most = max(doubling.values())
    listed = joined(
        f"{v.name.split(',')[0]} {doubling[v.name, 5]:.2f}, {doubling[v.name, 25]:.2f}"
        for v in VARIANTS[:3]
    )
    linear = {size: exponent(results, quick, VARIANTS[4], size) for size in SIZES}
    return [
        Claim(
            "6, 7",
            "T_D in a CSMA/CD protocol is proportional to a square of n",
            f"exponents (T = 5, 25) with the doubling windows of 802.3: {listed} ({runs} runs "
            f"each, n = {joined(NS)})",
            verdict(most > 1.85),
            "Q15: doubling windows reach the size of n within log2 n collisions: T_D stays a small "
            "multiple of n packets",
        ),
        Claim(
            "6, 7",
            "some CSMA/CD has a T_D near the square of n (exponent 1.85 to 2.15)",
            f"k + 1 values after k collisions, a collision costs a packet (D2): {linear[25]:.2f} "
            f"(T = 25), {linear[5]:.2f} (T = 5)",
            verdict(1.85 < linear[25] < 2.15, "Q15"),
            "only at T = 25 and over this range of n, and no backoff that any standard has; the "
            "paper does not say which one it used",
        ),
    ]


EXPERIMENT = Experiment(
    "quadratic",
    "Q15: a square of n?",
    "Disaster durations with doubling windows (802.3) and with k + 1 values after k collisions. D1 "
    "pays one slot a collision, D2 a packet, D2' as D2.",
    points,
    draw,
    judge,
)
