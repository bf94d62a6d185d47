"""Beyond the paper: the practical mode on the event level against the paper's slotted level."""

import numpy as np
from matplotlib.figure import Figure

from innervate.networks.radio.analysis import formulas as forms
from innervate.networks.radio.papers import practice
from innervate.networks.radio.papers.common import SIZES, first_from
from innervate.papers.experiment import Claim, Claims, Measured, Point, beyond, verdict
from innervate.papers.words import joined

TITLE = "Beyond the paper: the practical mode"
CAPTION = (
    "Practical mode: event level, delays 52..104 us. All others: slotted level. Dotted: the "
    "hand-over bound T / (T + d). Below: means of all runs and a fitted line."
)
SETTING = practice.Setting(0)
BARS = {5: 5, 25: 2}  # from which n on D2 has to be passed


def points(quick: bool) -> list[Point]:
    """Disasters and saturation without a turnaround."""
    return practice.points(SETTING, quick)


def draw(got: Measured) -> Figure:
    """Throughput S above and disaster's duration T_D below, a column a packet length."""
    return practice.draw(got, (SETTING,), "", 5.0, 1.1)


def judge(got: Measured) -> Claims:
    """Complete, linear, near the bound, against the others."""
    yield practice.complete(got, SETTING)
    yield practice.linear(got, SETTING)
    yield practice.near_bound(got, SETTING, 0.97)
    yield _passes_slotted(got)
    yield _against(got)
    yield practice.fair(got, SETTING)
    yield _small(got)


def _passes_slotted(got: Measured) -> Claim:
    words, gains = [], []
    for size in SIZES:
        ours = practice.throughput(got, SETTING, size)
        paper = [forms.reserved_throughput(n, size) for n in practice.ns(got.quick)]
        gains.append(float((ours - np.array(paper)).min()))
        words.append(
            f"T = {size}: {ours.min():.3f} to {ours.max():.3f}, least lead {gains[-1]:.3f}"
        )
    return beyond(
        "its S is above the paper's slotted S at every n = 2..100",
        joined(words, "; "),
        verdict(min(gains) > 0),
        "n T / (n (T + 1) + 2 T + 2) is no limit: stations with more packets keep their order, and "
        "a hand-over costs a delay and not a slot",
    )


def _against(got: Measured) -> Claim:
    words, passed = [], True
    for size in SIZES:
        ours = practice.throughput(got, SETTING, size)
        d2, d2p = (
            first_from(practice.ns(got.quick), ours > practice.rival(got, SETTING, mac, size))
            for mac in practice.WITH_RETURN
        )
        passed = passed and d2 is not None and d2 <= BARS[size] and d2p == 2
        words.append(f"T = {size}: D2 from n = {d2}, D2' from n = {d2p}")
    return beyond(
        "its S beats D2' at every n >= 2 and D2 from n = 5 (T = 5) and n = 2 (T = 25) on",
        f"higher than {joined(words, '; ')}",
        verdict(passed, "Q14"),
    )


def _small(got: Measured) -> Claim:
    words, shorter = [], True
    for size in SIZES:
        ours = practice.duration(got, SETTING, size)[:2]
        theirs = practice.rival(got, SETTING, "csma-cd-d2", size, 0, "disaster")[:2]
        shorter = shorter and bool((ours < theirs).all())
        pairs = joined(f"{a:.0f} against {b:.0f}" for a, b in zip(ours, theirs, strict=True))
        words.append(f"T = {size}: {pairs}")
    return beyond(
        "its T_D is shorter than that of D2 at n = 2 and 3, too",
        f"slots, n = 2, 3, {joined(words, '; ')}",
        verdict(shorter),
        "its weak spot: an opening and a window cost more than two stations' backoff; D2 is told "
        "of every collision for nothing",
    )
