"""Beyond the paper: the same with 2 ms to switch, against CSMA/CD with the same turnaround."""

from matplotlib.figure import Figure

from innervate.networks.radio.analysis import formulas as forms
from innervate.networks.radio.papers import practice
from innervate.networks.radio.papers.common import SIZES, TURNAROUND_US, first_from
from innervate.papers.experiment import Claim, Claims, Measured, Point, beyond, verdict
from innervate.papers.words import joined

TITLE = "Beyond the paper: 2 ms to switch"
CAPTION = (
    "As before with a turnaround of 2 ms. D2, D2': the better of backoff slots of 1 and 11; 'back "
    "at once': they need no time to listen again. Purple: up to four packets a turn."
)
SETTING = practice.Setting(TURNAROUND_US)
FOUR = practice.Setting(TURNAROUND_US, per_turn=4)


def points(quick: bool) -> list[Point]:
    """Disasters and saturation; up to four packets a turn in saturation."""
    return practice.points(SETTING, quick, FOUR)


def draw(got: Measured) -> Figure:
    """Throughput S above, T_D below, with a turnaround of 2 ms; a column a packet length."""
    return practice.draw(got, (SETTING, FOUR), ", ta = 2 ms", 5.4, 1.3)


def judge(got: Measured) -> Claims:
    """As without a turnaround; with four packets a turn."""
    yield practice.complete(got, SETTING)
    yield practice.linear(got, SETTING)
    yield practice.near_bound(got, SETTING, 0.92)
    for back in practice.readings(SETTING):
        yield _against(got, back)
    yield practice.near_bound(got, FOUR, 0.92)
    yield practice.fair(got, SETTING, FOUR)
    yield _unattainable(got)


def _against(got: Measured, back: int) -> Claim:
    words, passed = [], True
    for size in SIZES:
        ours = practice.throughput(got, SETTING, size)
        for name, mac in zip(("D2", "D2'"), practice.WITH_RETURN, strict=True):
            theirs = practice.rival(got, SETTING, mac, size, back)
            n = first_from(practice.ns(got.quick), ours > theirs)
            passed = passed and n == 2
            pair = f"n = 2: {ours[0]:.4f} against {theirs[0]:.4f}"
            words.append(f"T = {size}, {name}: from n = {n} ({pair})")
    return beyond(
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


def _unattainable(got: Measured) -> Claim:
    words, above = [], True
    for size in SIZES:
        most = float(practice.throughput(got, SETTING, size).max())
        paper = forms.reserved_throughput(10, size)
        above = above and most >= paper
        words.append(
            f"T = {size}: bound {practice.bound(SETTING, size):.3f}, reached {most:.3f}, slotted "
            f"{paper:.3f} at n = 10"
        )
    return beyond(
        "with 2 ms the S of Figs. 4 and 5 can be had with one packet a turn",
        joined(words, "; "),
        verdict(above),
        "Figs. 4 and 5 have no turnaround in them; no protocol passes T / (T + ta + d)",
    )
