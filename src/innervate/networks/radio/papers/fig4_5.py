"""Figs. 4 and 5: throughput S in saturation over n, T = 5 and 25; all protocols beside it."""

import numpy as np
from matplotlib.figure import Figure

from innervate.networks.radio.analysis import formulas as forms
from innervate.networks.radio.papers import common
from innervate.networks.radio.papers.common import RESERVED, SIZES, Curve
from innervate.networks.radio.slotted.drive import SLOT, dcf_here
from innervate.papers.experiment import Claim, Claims, Measured, Point, beyond, verdict
from innervate.papers.words import joined, percent
from innervate.plot import style

TITLE = "Figs. 4, 5: throughput in saturation"
CAPTION = (
    "Slotted level, the order after a collision given (Q3). D1: a collision costs one slot; D2: a "
    "whole packet; D2': D2 whose winner draws a backoff too. Means; bands: 5 to 95 % of the runs."
)
CROSSING = (*range(2, 46), 50, 70, 100)
# Closed forms, and how far off them the mean may be.
ALLOWED = {"slotted-aloha": 0.02, "p-persistent": 0.02, "tree": 0.02, "tdma": 1e-9, "dcf": 0.04}


def curve(mac: str, size: int, quick: bool) -> Curve:
    """Throughput over n of one protocol."""
    ns, seeds, successes = (common.FEW, 2, 4000) if quick else (common.WHOLE, 3, 10_000)
    if mac == common.READING_B:
        return Curve(RESERVED, size, "saturated", ns, 1, 2000, (("reading", "B"),))
    if mac in (RESERVED, "tdma"):
        return Curve(mac, size, "saturated", ns, 1, 2000)
    if mac in common.CONTENDING:
        ns, seeds, successes = (CROSSING, 5, 4000) if quick else (common.WHOLE, 12, 8000)
    return Curve(mac, size, "saturated", ns, seeds, successes)


def points(quick: bool) -> list[Point]:
    """All protocols at both packet lengths."""
    return [curve(mac, size, quick).point() for size in SIZES for mac in common.EVERYBODY]


def draw(got: Measured) -> Figure:
    """One panel a packet length, every protocol by its name."""
    figure, axes = style.panels(style.WIDE_IN, 3.1, 1, 2)
    macs = ("tdma", *common.PEERS[:-1], *reversed(common.CONTENDING), common.READING_B, RESERVED)
    for ax, number, size in zip(axes, (4, 5), SIZES, strict=True):
        common.stations_axis(ax)
        ax.set(xlim=(1.9, 105), ylim=(0, 1.0), title=f"Fig. {number}  T = {size}")
        common.everybody(ax, got, {mac: curve(mac, size, got.quick) for mac in macs})
    axes[0].set_ylabel("channel throughput S")
    return figure


def contended(got: Measured, size: int, place: int) -> list[float]:
    """S of each CSMA/CD at the first or the last n."""
    return [curve(mac, size, got.quick).mean(got)[place] for mac in common.CONTENDING]


def judge(got: Measured) -> Claims:
    """Small n, large n, where they cross; the formula; closed forms of the others."""
    yield _small(got)
    for size in SIZES:
        yield _crossing(got, size)
    yield _large(got)
    yield from _formula(got)
    yield _peers(got)


def _small(got: Measured) -> Claim:
    words, higher = [], []
    for size in SIZES:
        ours, theirs = forms.reserved_throughput(2, size), contended(got, size, 0)
        higher += [value > ours for value in theirs]
        words.append(f"T = {size}: {joined(f'{s:.3f}' for s in theirs)} against {ours:.3f}")
    return Claim(
        "4, 5",
        "When a small number of nodes collides, S in CSMA/CD is higher than in CSMA/CD-R",
        f"n = 2, D1, D2, D2' against CSMA/CD-R, {joined(words, '; ')}",
        verdict(all(higher), "Q1", "Q3", "Q14"),
        "F3: mostly capture: who got through sends again at once while the others back off",
    )


def _crossing(got: Measured, size: int) -> Claim:
    curves = [curve(mac, size, got.quick) for mac in common.CONTENDING]
    words, is_so = common.overtaken(
        got, curves, lambda n, s: forms.reserved_throughput(n, size) > s
    )
    return Claim(
        str(SIZES.index(size) + 4),
        f"T = {size}: CSMA/CD-R shows increasingly superior performance as n increases",
        f"CSMA/CD-R has the higher S than {words}",
        is_so,
        "which CSMA/CD the paper means it does not say; where the curves cross depends on it",
    )


def _large(got: Measured) -> Claim:
    gains = {
        size: [forms.reserved_throughput(100, size) / s for s in contended(got, size, -1)]
        for size in SIZES
    }
    words = (f"T = {s}: " + joined(f"{gain:.2f}" for gain in some) for s, some in gains.items())
    return Claim(
        "4, 5",
        "CSMA/CD-R is superior in scalability",
        f"n = 100, S of CSMA/CD-R over that of D1, D2, D2': {joined(words, '; ')}",
        verdict(min(map(min, gains.values())) > 1, "Q3", "Q14"),
        "with the order after a collision given; what a medium delivers of it: F1, F2",
    )


def _formula(got: Measured) -> Claims:
    found = {size: curve(RESERVED, size, got.quick).mean(got) for size in SIZES}
    yield Claim(
        "4, 5",
        "S increases with n in the first part",
        f"rises at every step of n = 2..{curve(RESERVED, 5, got.quick).ns[-1]}; "
        + joined(f"T = {size}: {s[0]:.3f} to {s[-1]:.3f}" for size, s in found.items()),
        verdict(all(bool((np.diff(s) > 0).all()) for s in found.values())),
        "and in the last part as well (F5)",
    )
    worst = 0.0
    for size in SIZES:
        for mac, letter in ((RESERVED, "A"), (common.READING_B, "B")):
            one = curve(mac, size, got.quick)
            exact = [forms.reserved_throughput(n, size, letter) for n in one.ns]
            worst = max(worst, float(np.abs(one.mean(got) - exact).max()))
    yield beyond(
        "S = n T / (n (T + 1) + 2 T + 2) for every n (reading A); B likewise",
        f"largest difference {worst:.1e}, n = 2..100, T = 5 and 25, both readings",
        verdict(worst < 1e-9),
        "every round is one collision, one window of T and n turns: nothing is left to chance",
    )


def _peers(got: Measured) -> Claim:
    off = {}
    for mac in ALLOWED:
        parts: list[float] = []
        for size in SIZES:
            one = curve(mac, size, got.quick)
            closed = [_closed(mac, n, size) for n in one.ns]
            parts += np.abs(one.mean(got) / closed - 1).tolist()
        off[mac] = float(np.mean(parts))
    return beyond(
        "the protocols beside it agree with their closed forms (mean within 2 %, DCF 4 %)",
        "mean difference, n = 2..100, T = 5 and 25: "
        + joined(f"{common.LOOKS[mac].name} {percent(mean, 1)}" for mac, mean in off.items()),
        verdict(all(off[mac] < allowed for mac, allowed in ALLOWED.items())),
        "Bianchi's DCF is an approximation itself, roughest at n = 2",
    )


def _closed(mac: str, n: int, size: int) -> float:
    if mac == "slotted-aloha":
        return forms.finite_aloha_throughput(n, 1 / n)
    if mac == "p-persistent":
        return forms.finite_csma_throughput(n, size, 1 / n)
    if mac == "tree":
        return forms.tree_throughput(n)
    if mac == "tdma":
        return forms.slotted_bound(size)
    times = dcf_here(size)
    return forms.dcf_throughput(
        n, times.window, times.stages, payload=size, success=times.success_us / SLOT,
        collision=times.collision_us / SLOT,
    )  # fmt: skip
