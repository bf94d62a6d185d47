"""F2: with 2 ms to switch, stations do not hear the collision that they are part of."""

from __future__ import annotations

from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from innervate.networks.radio.papers import lanes
from innervate.networks.radio.papers.common import TAU_US, TURNAROUND_US, joined, percent
from innervate.networks.radio.papers.medium import START_US, Channel
from innervate.papers.experiment import Claim, Experiment, Point, Results, verdict
from innervate.plot import style

TURNAROUNDS = (0, 52, 104, 150, 250, 500, 1000, 1500, 2000)
NS = (2, 5)
UNTIL_US = 16_000


def channel(mode: str, n: int, ta_us: int) -> Channel:
    """A collision as carrier sense allows it: all decide within tau + ta."""
    return Channel(mode, n, 25, ta_us, spread_us=TAU_US + ta_us - 1)


def seeds(quick: bool, mode: str) -> range:
    """The paper mode has 40 everywhere: it is held against numbers of 40 runs."""
    return range(1, 41 if mode == "paper" else 11 if quick else 201)


def points(quick: bool) -> list[Point]:
    """Turnarounds, both modes; a run to be shown."""
    made = [
        channel(mode, n, ta).point(seeds(quick, mode))
        for mode in ("paper", "practical")
        for n in NS
        for ta in TURNAROUNDS
    ]
    return [*made, Point.of("silent run", 0.1, shown)]


def shown() -> dict[str, Any]:
    """Two robots that lose a packet each; shown from the moment the first decides."""
    result = Channel("paper", 2, 25, TURNAROUND_US, starts_us=(0, 1500)).run(1)
    assert int(result.sent["time"].min()) >= START_US
    return lanes.record(result, UNTIL_US)


def lost(results: Results, quick: bool, mode: str, n: int, ta: int) -> tuple[int, int]:
    """Packets lost silently, of how many."""
    some = seeds(quick, mode)
    return sum(results[channel(mode, n, ta).key_of(some)]["silent"]), n * len(some)


def draw(results: Results, quick: bool) -> Figure:
    """Two robots; share lost over the turnaround."""
    figure, (left, right) = style.panels(style.WIDE_IN, 2.5, 1, 2, width_ratios=(1.25, 1))
    run = results["silent run"]
    lanes.draw(left, run, ("Robot1", "Robot2"), range(2), waves=True)
    left.set_xlim(-0.5, 12)
    left.set_title("a  two robots, 2 ms turnaround: nobody hears anybody")
    left.legend(handles=lanes.keys(waves=True, deaf=True), loc="upper center", ncols=3,
                bbox_to_anchor=(0.45, -0.22), columnspacing=1.2)  # fmt: skip
    _share(right, results, quick)
    return figure


def _share(ax: Axes, results: Results, quick: bool) -> None:
    x = [ta / 1e3 for ta in TURNAROUNDS]
    for i, (mode, words) in enumerate((("paper", "as published"), ("practical", "practical mode"))):
        for j, n in enumerate(NS):
            shares = [
                100 * hit / of for hit, of in (lost(results, quick, mode, n, ta) for ta in
                                               TURNAROUNDS)
            ]  # fmt: skip
            ax.plot(x, shares, style.MARKERS[2 * i + j], ls=style.DASHES[j],
                    color=style.SERIES[i], label=f"{words}, n = {n}")  # fmt: skip
    ax.set_xlabel("turnaround (ms)")
    ax.set_ylabel("packets lost silently (%)")
    ax.set_ylim(-4, 104)
    ax.set_title("b  collisions that nobody notices")
    ax.legend(loc="center", bbox_to_anchor=(0.7, 0.4))


def judge(results: Results, quick: bool) -> list[Claim]:
    """Claims on packets lost silently: as published, and in practical mode."""
    words, most = [], 0.0
    for n in NS:
        hit, of = lost(results, quick, "paper", n, TURNAROUND_US)
        most = max(most, hit / of)
        words.append(f"n = {n}: {hit} of {of} packets lost silently ({percent(hit / of, 1)})")
    none = [lost(results, quick, "paper", n, 0)[0] for n in NS]
    practical = [lost(results, quick, "practical", n, ta) for n in NS for ta in TURNAROUNDS]
    return [
        Claim(
            "4",
            "CSMA/CD-R works with modules that take 2 ms to change between sending and receiving",
            f"event level, T = 25, collisions of natural starts: {joined(words)}",
            verdict(most < 0.05),
            "F2: who ends second to last is deaf for 2 ms and misses the last one's tail, unless "
            "that ends 1.9 ms later; nobody reports. The experiment had something the text does "
            "not say",
        ),
        Claim(
            "2.2",
            "with no turnaround every collision is noticed",
            f"lost silently with ta = 0, n = {joined(NS)}: {joined(none)} packets of "
            f"{len(seeds(quick, 'paper'))} collisions each",
            verdict(not any(none), "Q6"),
        ),
        Claim(
            "beyond",
            "the practical mode loses no packet silently at any turnaround up to 2 ms",
            f"{sum(hit for hit, _ in practical)} of {sum(of for _, of in practical)} packets, "
            f"n = {joined(NS)}, turnaround 0 to 2 ms",
            verdict(not any(hit for hit, _ in practical)),
            "a packet counts as delivered only when the next frame says so, not when it is silent",
        ),
    ]


EXPERIMENT = Experiment(
    "silent",
    "F2: collisions that nobody notices",
    "a: two robots with 2 ms turnaround decide 1.5 ms apart; each is deaf while the other ends. "
    "b: share of packets whose sender takes them for delivered although nobody received them.",
    points,
    draw,
    judge,
)
