"""Q15: is CSMA/CD's T_D a square of n? Not with any backoff that doubles."""

import numpy as np
from matplotlib.figure import Figure

from innervate.networks.radio.papers import common
from innervate.networks.radio.papers.common import RESERVED, SHORT, SIZES, Curve
from innervate.papers import drawing
from innervate.papers.experiment import Claim, Claims, Measured, Point, verdict
from innervate.papers.words import joined
from innervate.plot import style

TITLE = "Q15: a square of n?"
CAPTION = (
    "Disaster durations with doubling windows (802.3) and with k + 1 values after k collisions. D1 "
    "pays one slot a collision, D2 a packet, D2' as D2."
)
NS = (2, 5, 10, 20, 50, 100)
# A CSMA/CD by what a collision costs, and its backoff; and CSMA/CD-R.
VARIANTS = {
    f"{name}, {words}": (mac, backoff)
    for backoff, words in (("binary", "doubling"), ("linear", "k+1"))
    for mac, name in SHORT.items()
}
OURS = "CSMA/CD-R"
COLOURS = (style.GREEN, style.VERMILION, style.ORANGE)


def curve(name: str, size: int, quick: bool) -> Curve:
    """T_D of one of them."""
    if name == OURS:
        return Curve(RESERVED, size, "disaster", NS, 1)
    mac, backoff = VARIANTS[name]
    seeds = 60 if quick else 400
    return Curve(mac, size, "disaster", NS, seeds, options=(("backoff", backoff),))


def points(quick: bool) -> list[Point]:
    """All variants, both packet lengths."""
    return [curve(name, size, quick).point() for name in (OURS, *VARIANTS) for size in SIZES]


def exponent(got: Measured, name: str, size: int) -> float:
    """Slope in the double logarithm."""
    return float(np.polyfit(np.log(NS), np.log(curve(name, size, got.quick).mean(got)), 1)[0])


def draw(got: Measured) -> Figure:
    """T_D at T = 25, and all exponents."""
    figure, (left, right) = style.panels(style.WIDE_IN, 2.9, 1, 2, width_ratios=(1.35, 1))
    common.stations_axis(left)
    left.set_yscale("log")
    ends = []
    for i, name in enumerate((*VARIANTS, OURS)):
        values = curve(name, 25, got.quick).mean(got)
        colour = style.BLUE if name == OURS else COLOURS[i % 3]
        left.plot(NS, values, marker=style.MARKERS[i] if name != OURS else "o", color=colour,
                  ls=style.DASHES[1 if name.endswith("k+1") else 0])  # fmt: skip
        ends.append((float(values[-1]), name, colour))
    x = np.array([2, 100])
    left.plot(x, 25 * x**2.0, color=style.BLACK, lw=0.8, ls=":")
    ends.append((25 * 100.0**2, "25 n²", style.BLACK))
    left.set_xlim(1.9, 105)
    drawing.end_labels(left, ends)
    left.set(ylabel="$T_D$ (slots)", title="a  T = 25")
    for place, name in enumerate((OURS, *VARIANTS)):
        for i, size in enumerate(SIZES):
            right.plot(exponent(got, name, size), place, style.MARKERS[i], color=style.SERIES[i],
                       ms=4, label=f"T = {size}" if place == 0 else None)  # fmt: skip
    right.axvline(2, color=style.BLACK, lw=0.8, ls=":")
    right.text(1.98, 0, "square of n", ha="right", va="center", color=style.INK, fontsize=6.5)
    drawing.rows(right, (OURS, *VARIANTS))
    right.set(xlim=(0.75, 2.15), xlabel="exponent of $T_D$ over n = 2..100")
    right.set_title("b  fitted exponents")
    right.legend(loc="center", bbox_to_anchor=(0.68, 0.64))
    return figure


def judge(got: Measured) -> Claims:
    """Not the square with doubling; nearly with linear windows."""
    runs = curve("D1, doubling", 25, got.quick).seeds
    found = {
        name: [exponent(got, f"{name}, doubling", s) for s in SIZES] for name in SHORT.values()
    }
    words = joined(f"{name} {five:.2f}, {long:.2f}" for name, (five, long) in found.items())
    yield Claim(
        "6, 7",
        "T_D in a CSMA/CD protocol is proportional to a square of n",
        f"exponents (T = 5, 25) with the doubling windows of 802.3: {words} ({runs} runs "
        f"each, n = {joined(NS)})",
        verdict(max(map(max, found.values())) > 1.85),
        "Q15: doubling windows reach the size of n within log2 n collisions: T_D stays a small "
        "multiple of n packets",
    )
    five, long = (exponent(got, "D2, k+1", size) for size in SIZES)
    yield Claim(
        "6, 7",
        "some CSMA/CD has a T_D near the square of n (exponent 1.85 to 2.15)",
        f"k + 1 values after k collisions, a collision costs a packet (D2): {long:.2f} "
        f"(T = 25), {five:.2f} (T = 5)",
        verdict(1.85 < long < 2.15, "Q15"),
        "only at T = 25 and over this range of n, and no backoff that any standard has; the "
        "paper does not say which one it used",
    )
