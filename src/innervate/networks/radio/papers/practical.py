"""Beyond the paper: the practical mode on the event level against the paper's slotted level."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from innervate.networks.radio.analysis import formulas as forms
from innervate.networks.radio.papers import practice, practice_figures
from innervate.networks.radio.papers.common import SIZES, joined
from innervate.networks.radio.papers.practice import Setting, ns
from innervate.papers.experiment import Claim, Experiment, Point, Results, verdict
from innervate.plot import style

SETTING = Setting(0)
BARS = {5: 5, 25: 2}  # from which n on D2 has to be passed


def points(quick: bool) -> list[Point]:
    """Disasters and saturation without a turnaround."""
    return practice.points(SETTING, quick)


def draw(results: Results, quick: bool) -> Figure:
    """Throughput S above and disaster's duration T_D below, a column a packet length."""
    figure, axes = style.panels(style.WIDE_IN, 5.0, 2, 2, height_ratios=(1.1, 1))
    for above, below, letter, size in zip(axes[:2], axes[2:], "ab", SIZES, strict=True):
        practice_figures.saturated(above, results, SETTING, size, quick)
        practice_figures.disaster(below, results, SETTING, size, quick)
        above.set_title(f"{letter}  T = {size}, saturation")
        below.set_title(f"{'cd'['ab'.index(letter)]}  T = {size}, disaster")
    axes[0].set_ylabel("throughput S")
    axes[2].set_ylabel("$T_D$ (slots)")
    return figure


def judge(results: Results, quick: bool) -> list[Claim]:
    """Complete, linear, near the bound, against the others."""
    return [
        practice.complete(results, SETTING, quick),
        practice.linear(results, SETTING, quick),
        practice.near_bound(results, SETTING, quick, 0.97),
        _passes_slotted(results, quick),
        _against(results, quick),
        practice.fair(results, (SETTING,), quick),
        _small(results, quick),
    ]


def _passes_slotted(results: Results, quick: bool) -> Claim:
    words, gains = [], []
    for size in SIZES:
        ours = practice.throughput(results, SETTING, size, quick)
        paper = np.array([forms.reserved_throughput(n, size) for n in ns(quick)])
        gains.append(float((ours - paper).min()))
        words.append(
            f"T = {size}: {ours.min():.3f} to {ours.max():.3f}, least lead {gains[-1]:.3f}"
        )
    return Claim(
        "beyond",
        "its S is above the paper's slotted S at every n = 2..100",
        joined(words, "; "),
        verdict(min(gains) > 0),
        "n T / (n (T + 1) + 2 T + 2) is no limit: stations with more packets keep their order, and "
        "a hand-over costs a delay and not a slot",
    )


def _against(results: Results, quick: bool) -> Claim:
    words, passed = [], True
    for size in SIZES:
        d2, d2p = (
            practice.least_from(results, SETTING, mac, size, quick) for mac in practice.WITH_RETURN
        )
        passed = passed and d2 is not None and d2 <= BARS[size] and d2p == 2
        words.append(f"T = {size}: D2 from n = {d2}, D2' from n = {d2p}")
    return Claim(
        "beyond",
        "its S beats D2' at every n >= 2 and D2 from n = 5 (T = 5) and n = 2 (T = 25) on",
        f"higher than {joined(words, '; ')}",
        verdict(passed, "Q14"),
    )


def _small(results: Results, quick: bool) -> Claim:
    words, shorter = [], []
    for size in SIZES:
        ours = practice.duration(results, SETTING, size, quick)[:2]
        theirs = practice.rival(results, SETTING, "csma-cd-d2", size, quick, 0, "disaster")[:2]
        shorter += (ours < theirs).tolist()
        pairs = joined(f"{a:.0f} against {b:.0f}" for a, b in zip(ours, theirs, strict=True))
        words.append(f"T = {size}: {pairs}")
    return Claim(
        "beyond",
        "its T_D is shorter than that of D2 at n = 2 and 3, too",
        f"slots, n = 2, 3, {joined(words, '; ')}",
        verdict(all(shorter)),
        "its weak spot: an opening and a window cost more than two stations' backoff; D2 is told "
        "of every collision for nothing",
    )


EXPERIMENT = Experiment(
    "practical",
    "Beyond the paper: the practical mode",
    "Practical mode: event level, delays 52..104 us. All others: slotted level. Dotted: the "
    "hand-over bound T / (T + d). Below: means of all runs and a fitted line.",
    points,
    draw,
    judge,
)
