"""F5: the settling values 0.83 and 0.96 are limits; where they are reached; how flat S is."""

from math import inf

import numpy as np
from matplotlib.figure import Figure

from innervate.networks.radio.analysis import formulas as forms
from innervate.networks.radio.papers import common
from innervate.networks.radio.papers.common import RESERVED, SIZES, TAU_US, Curve
from innervate.networks.radio.papers.medium import START_US, Channel
from innervate.networks.radio.protocol.constants import DATA
from innervate.networks.radio.slotted.drive import SLOT
from innervate.papers.experiment import Claim, Claims, Measured, Point, verdict
from innervate.papers.words import joined, percent
from innervate.plot import style

TITLE = "F5: what the throughput settles at"
CAPTION = (
    "Slotted level, both readings of what a packet costs (Q1). Dashed: the limit of both; dotted: "
    "without slots. Grey: where the paper calls S independent of n."
)
SETTLED = {5: 0.83, 25: 0.96}
REACHED = {5: 0.825, 25: 0.955}  # what is rounded to it
COLOURS = (style.BLUE, style.SKY)  # readings A and B, as in Figs. 4 to 7
NS = (*range(2, 31), *range(35, 100, 5), *range(100, 401), 500, 700, 1000)
CHAIN = 20  # robots that end more than a slot apart


def curve(reading: str, size: int) -> Curve:
    """S over n; without chance, so one run each."""
    return Curve(RESERVED, size, "saturated", NS, 1, 1, (("reading", reading),))


def points(quick: bool) -> list[Point]:
    """Both readings, both packet lengths; turns without common slots."""
    made = [curve(reading, size).point() for reading in "AB" for size in SIZES]
    return [*made, Point.of(f"turns without slots n={CHAIN}", 0.1, turns)]


def turns() -> dict[str, float]:
    """Share of the time that packets fill in a chain of turns on the event level, and its gaps."""
    starts = tuple((SLOT + 1) * i for i in range(CHAIN))
    result = Channel("paper", CHAIN, 25, starts_us=starts).run(1)
    sent = result.sent[result.sent["kind"] == DATA]
    frames = np.sort(np.stack([sent["time"], sent["end"]], axis=1)[CHAIN:] - START_US, axis=0)
    gaps = frames[1:, 0] - frames[:-1, 1]
    share = (CHAIN - 1) * 25 * SLOT / (frames[-1, 0] - frames[0, 0])
    return {"share": float(share), "low_us": float(gaps.min()), "high_us": float(gaps.max())}


def draw(got: Measured) -> Figure:
    """S against its limit, both readings."""
    figure, axes = style.panels(style.WIDE_IN, 2.6, 1, 2)
    for ax, letter, size in zip(axes, "ab", SIZES, strict=True):
        for i, reading in enumerate("AB"):
            ax.plot(NS, curve(reading, size).mean(got), color=COLOURS[i],
                    ls=style.DASHES[i], label=f"CSMA/CD-R, reading {reading}")  # fmt: skip
            n = reached(got, reading, size)
            ax.plot([n], [REACHED[size]], style.MARKERS[i], color=COLOURS[i],
                    label=f"rounds to {SETTLED[size]} from n = {n:g}")  # fmt: skip
        limit, free = forms.slotted_bound(size), forms.handover_bound(size)
        ax.axhline(limit, color=style.BLACK, lw=0.8, ls="--", label=f"T / (T + 1) = {limit:.4f}")
        ax.axhline(free, color=style.SOFT, lw=0.8, ls=":", label=f"T / (T + 0.5) = {free:.3f}")
        ax.axvspan(30, 100, color=style.PALE, lw=0, zorder=0)
        ax.text(55, 0.31, "n = 30..100", ha="center", color=style.SOFT, fontsize=6.5)
        common.stations_axis(ax, (2, 5, 10, 30, 100, 300, 1000))
        ax.set(ylim=(0.28, 1.01), title=f"{letter}  T = {size}")
        ax.legend(loc="lower right", bbox_to_anchor=(1, 0.09))
    axes[0].set_ylabel("channel throughput S")
    return figure


def at(got: Measured, reading: str, size: int, n: int) -> float:
    """Throughput S with n stations, packets of `size` slots."""
    return float(curve(reading, size).mean(got)[NS.index(n)])


def reached(got: Measured, reading: str, size: int) -> float:
    """The least n with the settling value to two digits; infinite if there is none."""
    values = curve(reading, size).mean(got)
    found = common.first_from(NS, values >= REACHED[size] - 1e-12)
    return inf if found is None else found


def judge(got: Measured) -> Claims:
    """The values, the flatness, where, and without slots."""
    for size in SIZES:
        a, b = (at(got, reading, size, 1000) for reading in "AB")
        yield Claim(
            str(SIZES.index(size) + 4),
            f"settling value of CSMA/CD-R: {SETTLED[size]} when T = {size}",
            f"n = 1000: A {a:.4f}, B {b:.4f}; limit {forms.slotted_bound(size):.4f}",
            verdict(round(a, 2) == round(b, 2) == SETTLED[size], "Q1"),
            "T / (T + 1): one slot a packet beside the packet, whichever way it comes about",
        )
    ends = {size: [at(got, "A", size, n) for n in (30, 100)] for size in SIZES}
    gains = {size: high / low - 1 for size, (low, high) in ends.items()}
    words = (
        f"T = {size}: {low:.3f} to {high:.3f} ({percent(gains[size], 1)} more)"
        for size, (low, high) in ends.items()
    )
    yield Claim(
        "4, 5",
        "S is independent of n on higher n than 30 (within 5 %)",
        f"n = 30..100, {joined(words)}",
        verdict(max(gains.values()) < 0.05, "F5"),
        "not flat: what is missing to the limit falls as 2 / n, the round's collision and window",
    )
    yield from _inside(got)


def _inside(got: Measured) -> Claims:
    where = {size: [reached(got, reading, size) for reading in "AB"] for size in SIZES}
    words = (
        f"T = {size}: {at(got, 'A', size, 100):.3f} at n = 100, {REACHED[size]} from n = "
        f"{a:g} (A), {b:g} (B)"
        for size, (a, b) in where.items()
    )
    yield Claim(
        "4, 5",
        "the curves have settled at 0.83 and 0.96 where they are called independent of n",
        joined(words, "; "),
        verdict(max(map(max, where.values())) <= 100),
        "F5: the two numbers are the limits for n to infinity, not values at n up to 100",
    )
    found = got.values[f"turns without slots n={CHAIN}"]
    low, high = found["low_us"], found["high_us"]
    limits = [forms.handover_bound(size) for size in SIZES]
    yield Claim(
        "2.2",
        "an asynchronous protocol: the external synchronisation signal is not necessary",
        f"event level, {CHAIN} robots: turns {low:.0f} to {high:.0f} us apart, packets fill "
        f"{found['share']:.4f} of them (T = 25)",
        verdict(low == high == TAU_US, "F4"),
        "without slots a hand-over costs tau, half a slot: limits "
        f"{limits[0]:.3f} and {limits[1]:.3f}; 0.83 and 0.96 come from slotting",
    )
