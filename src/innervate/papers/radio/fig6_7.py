"""Figs. 6 and 7: how long a disaster takes, T_D over n, T = 5 and 25; all protocols beside it."""

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
    slope,
    stations_axis,
)
from innervate.papers.radio.labels import end_labels
from innervate.plot import style

PEERS = ("p-persistent", "slotted-aloha", "dcf", "tree", "tdma")
CROSSING = (*range(2, 16), 20, 30, 50, 70, 100)


def curve(mac: str, size: int, quick: bool) -> Curve:
    """T_D over n of one protocol."""
    if mac == f"{RESERVED} B":
        return Curve(RESERVED, size, "disaster", WHOLE, 1, options=(("reading", "B"),))
    if mac == RESERVED:
        return Curve(mac, size, "disaster", WHOLE, 1)
    if mac in CONTENDING:
        ns, seeds = (CROSSING, 400) if quick else (WHOLE, 500)
        return Curve(mac, size, "disaster", ns, seeds)
    return Curve(mac, size, "disaster", FEW if quick else WHOLE, 30 if quick else 60)


def points(quick: bool) -> list[Point]:
    """All protocols at both packet lengths."""
    macs = (RESERVED, f"{RESERVED} B", *CONTENDING, *PEERS)
    return [curve(mac, size, quick).point() for size in SIZES for mac in macs]


def draw(results: Results, quick: bool) -> Figure:
    """Above all protocols, logarithmic; below small n, T_D a station."""
    figure, axes = style.panels(style.WIDE_IN, 5.4, 2, 2, height_ratios=(1.25, 1))
    for above, below, number, size in zip(axes[:2], axes[2:], (6, 7), SIZES, strict=True):
        _whole(above, results, quick, size)
        above.set_title(f"Fig. {number}  T = {size}")
        _few(below, results, quick, size)
        below.set_title(f"small n, T = {size}")
    axes[0].set_ylabel("total duration $T_D$ (slots)")
    axes[2].set_ylabel("$T_D$ (slots)")
    return figure


def _whole(ax: Axes, results: Results, quick: bool, size: int) -> None:
    stations_axis(ax)
    ax.set_yscale("log")
    ax.set_xlim(1.9, 105)
    ends = []
    for mac in ("tdma", *reversed(PEERS[:-1]), *reversed(CONTENDING), f"{RESERVED} B", RESERVED):
        one, look = curve(mac, size, quick), LOOKS[mac]
        values = one.mean(results, "duration")
        line(ax, look, one.ns, values)
        if mac in CONTENDING:
            band(ax, look, one.ns, one.all(results, "duration"))
        ends.append((float(values[-1]), look.name, look.colour))
    end_labels(ax, ends)


def _few(ax: Axes, results: Results, quick: bool, size: int) -> None:
    for mac in (*reversed(CONTENDING), RESERVED):
        one = curve(mac, size, quick)
        values = one.mean(results, "duration")
        line(ax, LOOKS[mac], one.ns[:9], values[:9], marks=range(2, 11))
        if mac in CONTENDING:
            band(ax, LOOKS[mac], one.ns[:9], one.all(results, "duration")[:9])
    ax.set_ylim(0)
    ax.set_xticks(range(2, 11))
    ax.set_xlabel("stations n")
    ax.legend(loc="upper left")


def judge(results: Results, quick: bool) -> list[Claim]:
    """Linear; small n; large n; where they cross."""
    return [
        *(_linear(results, quick, size) for size in SIZES),
        _small(results, quick),
        *(_crossing(results, quick, size) for size in SIZES),
        _large(results, quick),
    ]


def _linear(results: Results, quick: bool, size: int) -> Claim:
    one = curve(RESERVED, size, quick)
    values = one.mean(results, "duration")
    rise, start, fit = slope(one.ns, values)
    return Claim(
        str(SIZES.index(size) + 6),
        f"T = {size}: T_D in CSMA/CD-R is proportional to n linearly",
        f"T_D = {start:.0f} + {rise:.3f} n slots, R^2 = {fit:.6f}, n = 2..100",
        verdict(fit > 0.999999, "Q1", "Q3"),
        "linear, not proportional: the collision and the window come first",
    )


def _small(results: Results, quick: bool) -> Claim:
    words, shorter = [], []
    for size in SIZES:
        one = curve("csma-cd-d1", size, quick)
        theirs = one.mean(results, "duration")
        for n in (2, 3):
            ours = forms.reserved_duration_slots(n, size)
            value = float(theirs[one.ns.index(n)])
            shorter.append(value < ours)
            words.append(f"T = {size}, n = {n}: {value:.1f} against {ours}")
    return Claim(
        "6, 7",
        "When a small number of nodes collides, T_D in CSMA/CD is relatively small",
        f"slots, D1 against CSMA/CD-R, {joined(words, '; ')}",
        verdict(all(shorter), "Q14"),
        "D2, whose collisions cost a packet, is shorter at n = 2 only: "
        + joined(
            f"{forms.pair_duration_slots(size, size + 1):.1f} against "
            f"{forms.reserved_duration_slots(2, size)} (T = {size})"
            for size in SIZES
        ),
    )


def crossing(results: Results, quick: bool, mac: str, size: int) -> int | None:
    """From which n on CSMA/CD-R has the shorter T_D."""
    one = curve(mac, size, quick)
    ours = np.array([forms.reserved_duration_slots(n, size) for n in one.ns])
    return first_from(one.ns, ours < one.mean(results, "duration"))


def _crossing(results: Results, quick: bool, size: int) -> Claim:
    found = [crossing(results, quick, mac, size) for mac in CONTENDING]
    pairs = zip(("D1", "D2", "D2'"), found, strict=True)
    words = joined(f"{name} from n = {n}" for name, n in pairs)
    runs = curve("csma-cd-d1", size, quick).seeds
    return Claim(
        str(SIZES.index(size) + 6),
        f"T = {size}: CSMA/CD-R is superior as the number of collisions increases",
        f"T_D of CSMA/CD-R is shorter than of {words} ({runs} runs each)",
        verdict(all(found), "Q14"),
        "D2' only adds backoffs after the own packet: it differs from D2 by chance alone",
    )


def _large(results: Results, quick: bool) -> Claim:
    words, better = [], []
    for size in SIZES:
        ours = forms.reserved_duration_slots(100, size)
        gains = [curve(m, size, quick).mean(results, "duration")[-1] / ours for m in CONTENDING]
        better += [gain > 1 for gain in gains]
        words.append(f"T = {size}: " + joined(f"{gain:.2f}" for gain in gains))
    return Claim(
        "6, 7",
        "CSMA/CD's duration increases abruptly as the number of collisions increases",
        f"n = 100, T_D of D1, D2, D2' over that of CSMA/CD-R: {joined(words, '; ')}",
        verdict(all(better), "Q14"),
        "faster than linear, but no square of n: see there (Q15)",
    )


EXPERIMENT = Experiment(
    "fig6_7",
    "Figs. 6, 7: total duration of a disaster",
    "Slotted level: all stations have one packet at time 0. Means; bands: 5 to 95 % of the runs. "
    "Above: all protocols, both axes logarithmic; below: the same at small n.",
    points,
    draw,
    judge,
)
