"""Beyond the paper: the same with 2 ms to switch, against CSMA/CD with the same turnaround."""

from __future__ import annotations

from matplotlib.figure import Figure

from innervate.networks.radio.analysis import formulas as forms
from innervate.networks.radio.papers import practice, practice_figures
from innervate.networks.radio.papers.common import SIZES, TURNAROUND_US, first_from, joined
from innervate.networks.radio.papers.practice import Setting
from innervate.papers.experiment import Claim, Experiment, Point, Results, verdict
from innervate.plot import style

SETTING = Setting(TURNAROUND_US)
FOUR = Setting(TURNAROUND_US, per_turn=4)


def points(quick: bool) -> list[Point]:
    """Disasters and saturation; up to four packets a turn in saturation."""
    return practice.points(SETTING, quick, (FOUR,))


def draw(results: Results, quick: bool) -> Figure:
    """Throughput S above, T_D below, with a turnaround of 2 ms; a column a packet length."""
    figure, axes = style.panels(style.WIDE_IN, 5.4, 2, 2, height_ratios=(1.3, 1))
    for above, below, letter, size in zip(axes[:2], axes[2:], "ab", SIZES, strict=True):
        practice_figures.saturated(above, results, SETTING, size, quick, (FOUR,))
        practice_figures.disaster(below, results, SETTING, size, quick)
        above.set_title(f"{letter}  T = {size}, ta = 2 ms, saturation")
        below.set_title(f"{'cd'['ab'.index(letter)]}  T = {size}, ta = 2 ms, disaster")
    axes[0].set_ylabel("throughput S")
    axes[2].set_ylabel("$T_D$ (slots)")
    return figure


def judge(results: Results, quick: bool) -> list[Claim]:
    """As without a turnaround; with four packets a turn."""
    return [
        practice.complete(results, SETTING, quick),
        practice.linear(results, SETTING, quick),
        practice.near_bound(results, SETTING, quick, 0.92),
        *(_against(results, quick, back) for back in practice.readings(SETTING)),
        practice.near_bound(results, FOUR, quick, 0.92),
        practice.fair(results, (SETTING, FOUR), quick),
        _unattainable(results, quick),
    ]


def _against(results: Results, quick: bool, back: int) -> Claim:
    words, passed = [], True
    for size in SIZES:
        ours = practice.throughput(results, SETTING, size, quick)
        for name, mac in zip(("D2", "D2'"), practice.WITH_RETURN, strict=True):
            theirs = practice.rival(results, SETTING, mac, size, quick, back)
            n = first_from(practice.ns(quick), ours > theirs)
            passed = passed and n == 2
            pair = f"n = 2: {ours[0]:.4f} against {theirs[0]:.4f}"
            words.append(f"T = {size}, {name}: from n = {n} ({pair})")
    return Claim(
        "beyond",
        "with 2 ms its S beats D2 and D2' with the same turnaround at every n >= 2, "
        + ("both ways" if back == 0 else "even if theirs is 0 on the way back"),
        joined(words, "; "),
        verdict(passed, "Q14"),
        _WHY[back],
    )


_WHY = (
    "D2, D2' with the better of backoff slots of 1 and 11, and told of every collision",
    "a gift no radio has: then the one station that captures the channel pays one turnaround a "
    "packet and nothing else; with up to four packets a turn the practical mode is above that, too",
)


def _unattainable(results: Results, quick: bool) -> Claim:
    words, above = [], []
    for size in SIZES:
        most = float(practice.throughput(results, SETTING, size, quick).max())
        paper = forms.reserved_throughput(10, size)
        above.append(most >= paper)
        words.append(
            f"T = {size}: bound {practice.bound(SETTING, size):.3f}, reached {most:.3f}, slotted "
            f"{paper:.3f} at n = 10"
        )
    return Claim(
        "beyond",
        "with 2 ms the S of Figs. 4 and 5 can be had with one packet a turn",
        joined(words, "; "),
        verdict(all(above)),
        "Figs. 4 and 5 have no turnaround in them; no protocol passes T / (T + ta + d)",
    )


EXPERIMENT = Experiment(
    "turnaround",
    "Beyond the paper: 2 ms to switch",
    "As before with a turnaround of 2 ms. D2, D2': the better of backoff slots of 1 and 11; 'back "
    "at once': they need no time to listen again. Purple: up to four packets a turn.",
    points,
    draw,
    judge,
)
