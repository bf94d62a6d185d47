"""Figs. 4 and 5: throughput S in saturation over n, T = 5 and 25; all protocols beside it."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from innervate.analysis import radio_formulas as forms
from innervate.papers.experiment import Claim, Experiment, Point, Results, verdict
from innervate.papers.radio.common import (
    CONTENDING,
    FEW,
    LOOKS,
    RESERVED,
    SIZES,
    WHOLE,
    Curve,
    band,
    first_from,
    joined,
    line,
    percent,
    stations_axis,
)
from innervate.papers.radio.labels import end_labels
from innervate.plot import style
from innervate.sim.slotted_drive import SLOT, dcf_here

PEERS = ("p-persistent", "slotted-aloha", "dcf", "tree", "tdma")
CROSSING = (*range(2, 46), 50, 70, 100)
NAMES = ("csma-cd-d1", "csma-cd-d2", "csma-cd-d2p")


def curve(mac: str, packet_slots: int, quick: bool) -> Curve:
    """Throughput over n of one protocol."""
    if mac == f"{RESERVED} B":
        ns = FEW if quick else WHOLE
        return Curve(RESERVED, packet_slots, "saturated", ns, 1, 2000, (("reading", "B"),))
    if mac in (RESERVED, "tdma"):
        return Curve(mac, packet_slots, "saturated", FEW if quick else WHOLE, 1, 2000)
    if mac in CONTENDING:
        ns, seeds = (CROSSING, 5) if quick else (WHOLE, 12)
        return Curve(mac, packet_slots, "saturated", ns, seeds, 4000 if quick else 8000)
    ns, seeds = (FEW, 2) if quick else (WHOLE, 3)
    return Curve(mac, packet_slots, "saturated", ns, seeds, 4000 if quick else 10_000)


def points(quick: bool) -> list[Point]:
    """All protocols at both packet lengths."""
    macs = (RESERVED, f"{RESERVED} B", *CONTENDING, *PEERS)
    return [curve(mac, size, quick).point() for size in SIZES for mac in macs]


def draw(results: Results, quick: bool) -> Figure:
    """One panel a packet length, every protocol by its name."""
    figure, axes = style.panels(style.WIDE_IN, 3.1, 1, 2)
    for ax, number, size in zip(axes, (4, 5), SIZES, strict=True):
        _panel(ax, results, quick, size)
        ax.set_title(f"Fig. {number}  T = {size}")
    axes[0].set_ylabel("channel throughput S")
    return figure


def _panel(ax: Axes, results: Results, quick: bool, size: int) -> None:
    stations_axis(ax)
    ax.set_xlim(1.9, 105)
    ax.set_ylim(0, 1.0)
    ends = []
    for mac in ("tdma", *PEERS[:-1], *reversed(CONTENDING), f"{RESERVED} B", RESERVED):
        one, look = curve(mac, size, quick), LOOKS[mac]
        values = one.mean(results, "throughput")
        line(ax, look, one.ns, values)
        if mac in CONTENDING:
            band(ax, look, one.ns, one.all(results, "throughput"))
        ends.append((float(values[-1]), look.name, look.colour))
    end_labels(ax, ends)


def judge(results: Results, quick: bool) -> list[Claim]:
    """Small n, large n, where they cross; the formula; closed forms of the others."""
    return [
        _small(results, quick),
        *(_crossing(results, quick, size) for size in SIZES),
        _large(results, quick),
        _rising(results, quick),
        _formula(results, quick),
        _peers(results, quick),
    ]


def reserved(ns: tuple[int, ...], size: int) -> np.ndarray:
    """S of CSMA/CD-R, reading A."""
    return np.array([forms.reserved_throughput(n, size) for n in ns])


def contended(results: Results, quick: bool, mac: str, size: int) -> np.ndarray:
    """S of a CSMA/CD over the n of its curve."""
    found: np.ndarray = curve(mac, size, quick).mean(results, "throughput")
    return found


def crossing(results: Results, quick: bool, mac: str, size: int) -> int | None:
    """From which n on CSMA/CD-R has the higher S."""
    ns = curve(mac, size, quick).ns
    return first_from(ns, reserved(ns, size) > contended(results, quick, mac, size))


def _small(results: Results, quick: bool) -> Claim:
    words, higher = [], []
    for size in SIZES:
        ours = forms.reserved_throughput(2, size)
        theirs = [contended(results, quick, mac, size)[0] for mac in CONTENDING]
        higher += [value > ours for value in theirs]
        listed = joined(f"{value:.3f}" for value in theirs)
        words.append(f"T = {size}: {listed} against {ours:.3f}")
    return Claim(
        "4, 5",
        "When a small number of nodes collides, S in CSMA/CD is higher than in CSMA/CD-R",
        f"n = 2, D1, D2, D2' against CSMA/CD-R, {joined(words, '; ')}",
        verdict(all(higher), "Q1", "Q3", "Q14"),
        "F3: mostly capture: who got through sends again at once while the others back off",
    )


def _crossing(results: Results, quick: bool, size: int) -> Claim:
    found = {mac: crossing(results, quick, mac, size) for mac in CONTENDING}
    words = joined(f"{name} from n = {found[mac]}" for name, mac in _short())
    runs = curve("csma-cd-d1", size, quick).seeds
    return Claim(
        str(SIZES.index(size) + 4),
        f"T = {size}: CSMA/CD-R shows increasingly superior performance as n increases",
        f"CSMA/CD-R has the higher S than {words} ({runs} runs each)",
        verdict(all(found.values()), "Q14"),
        "which CSMA/CD the paper means it does not say; where the curves cross depends on it",
    )


def _short() -> list[tuple[str, str]]:
    return list(zip(("D1", "D2", "D2'"), CONTENDING, strict=True))


def _large(results: Results, quick: bool) -> Claim:
    words, better = [], []
    for size in SIZES:
        ours = forms.reserved_throughput(100, size)
        gains = [ours / contended(results, quick, mac, size)[-1] for mac in CONTENDING]
        better += [gain > 1 for gain in gains]
        words.append(f"T = {size}: " + joined(f"{gain:.2f}" for gain in gains))
    return Claim(
        "4, 5",
        "CSMA/CD-R is superior in scalability",
        f"n = 100, S of CSMA/CD-R over that of D1, D2, D2': {joined(words, '; ')}",
        verdict(all(better), "Q3", "Q14"),
        "with the order after a collision given; what a medium delivers of it: F1, F2",
    )


def _rising(results: Results, quick: bool) -> Claim:
    ns = curve(RESERVED, 5, quick).ns
    found = {size: curve(RESERVED, size, quick).mean(results, "throughput") for size in SIZES}
    words = joined(f"T = {size}: {s[0]:.3f} to {s[-1]:.3f}" for size, s in found.items())
    return Claim(
        "4, 5",
        "S increases with n in the first part",
        f"rises at every step of n = 2..{ns[-1]}; {words}",
        verdict(all(bool((np.diff(s) > 0).all()) for s in found.values())),
        "and in the last part as well (F5)",
    )


def _formula(results: Results, quick: bool) -> Claim:
    worst = 0.0
    for size in SIZES:
        for mac, letter in ((RESERVED, "A"), (f"{RESERVED} B", "B")):
            one = curve(mac, size, quick)
            exact = [forms.reserved_throughput(n, size, letter) for n in one.ns]
            worst = max(worst, float(np.abs(one.mean(results, "throughput") - exact).max()))
    return Claim(
        "beyond",
        "S = n T / (n (T + 1) + 2 T + 2) for every n (reading A); B likewise",
        f"largest difference {worst:.1e}, n = 2..100, T = 5 and 25, both readings",
        verdict(worst < 1e-9),
        "every round is one collision, one window of T and n turns: nothing is left to chance",
    )


def _peers(results: Results, quick: bool) -> Claim:
    words, passed = [], True
    for mac, allowed in (("slotted-aloha", 0.02), ("p-persistent", 0.02), ("tree", 0.02),
                         ("tdma", 1e-9), ("dcf", 0.04)):  # fmt: skip
        off = []
        for size in SIZES:
            one = curve(mac, size, quick)
            found = one.mean(results, "throughput")
            off += [abs(s / _closed(mac, n, size) - 1) for n, s in zip(one.ns, found, strict=True)]
        passed = passed and float(np.mean(off)) < allowed
        words.append(f"{LOOKS[mac].name} {percent(float(np.mean(off)), 1)}")
    return Claim(
        "beyond",
        "the protocols beside it agree with their closed forms (mean within 2 %, DCF 4 %)",
        f"mean difference, n = 2..100, T = 5 and 25: {joined(words)}",
        verdict(passed),
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


EXPERIMENT = Experiment(
    "fig4_5",
    "Figs. 4, 5: throughput in saturation",
    "Slotted level, the order after a collision given (Q3). D1: a collision costs one slot; D2: a "
    "whole packet; D2': D2 whose winner draws a backoff too. Means; bands: 5 to 95 % of the runs.",
    points,
    draw,
    judge,
)
