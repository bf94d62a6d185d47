"""F2: with 2 ms to switch, stations do not hear the collision that they are part of."""

from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from innervate.networks.radio.papers import lanes
from innervate.networks.radio.papers.common import TAU_US, TURNAROUND_US
from innervate.networks.radio.papers.medium import START_US, Channel
from innervate.papers.experiment import Claim, Claims, Measured, Point, beyond, verdict
from innervate.papers.words import joined, percent
from innervate.plot import style

TITLE = "F2: collisions that nobody notices"
CAPTION = (
    "a: two robots with 2 ms turnaround decide 1.5 ms apart; each is deaf while the other ends. "
    "b: share of packets whose sender takes them for delivered although nobody received them."
)
TURNAROUNDS = (0, 52, 104, 150, 250, 500, 1000, 1500, 2000)
NS = (2, 5)
MODES = {"paper": "as published", "practical": "practical mode"}
UNTIL_US = 16_000


def point(mode: str, n: int, ta_us: int, quick: bool) -> Point:
    """Collisions as carrier sense allows them: all decide within tau + ta.

    The paper mode has 40 everywhere: it is held against numbers of 40 runs.
    """
    seeds = 40 if mode == "paper" else 10 if quick else 200
    return Channel(mode, n, 25, ta_us, spread_us=TAU_US + ta_us - 1).point(seeds)


def points(quick: bool) -> list[Point]:
    """Turnarounds, both modes; a run to be shown."""
    made = [point(mode, n, ta, quick) for mode in MODES for n in NS for ta in TURNAROUNDS]
    return [*made, Point.of("silent run", 0.1, shown)]


def shown() -> dict[str, Any]:
    """Two robots that lose a packet each; shown from the moment the first decides."""
    result = Channel("paper", 2, 25, TURNAROUND_US, starts_us=(0, 1500)).run(1)
    assert int(result.sent["time"].min()) >= START_US
    return lanes.record(result, UNTIL_US)


def lost(got: Measured, mode: str, n: int, ta: int) -> tuple[int, int]:
    """Packets lost silently, of how many."""
    silent = got[point(mode, n, ta, got.quick)]["silent"]
    return sum(silent), n * len(silent)


def draw(got: Measured) -> Figure:
    """Two robots; share lost over the turnaround."""
    figure, (left, right) = style.panels(style.WIDE_IN, 2.5, 1, 2, width_ratios=(1.25, 1))
    lanes.draw(left, got.values["silent run"], ("Robot1", "Robot2"), range(2), waves=True)
    left.set(xlim=(-0.5, 12), title="a  two robots, 2 ms turnaround: nobody hears anybody")
    left.legend(handles=lanes.keys(waves=True), loc="upper center", ncols=3,
                bbox_to_anchor=(0.45, -0.22), columnspacing=1.2)  # fmt: skip
    _share(right, got)
    return figure


def _share(ax: Axes, got: Measured) -> None:
    x = [ta / 1e3 for ta in TURNAROUNDS]
    for i, (mode, words) in enumerate(MODES.items()):
        for j, n in enumerate(NS):
            found = [lost(got, mode, n, ta) for ta in TURNAROUNDS]
            ax.plot(x, [100 * hit / of for hit, of in found], ls=style.DASHES[j],
                    marker=style.MARKERS[2 * i + j], color=style.SERIES[i],
                    label=f"{words}, n = {n}")  # fmt: skip
    ax.set(xlabel="turnaround (ms)", ylabel="packets lost silently (%)", ylim=(-4, 104),
           title="b  collisions that nobody notices")  # fmt: skip
    ax.legend(loc="center", bbox_to_anchor=(0.7, 0.4))


def judge(got: Measured) -> Claims:
    """Claims on packets lost silently: as published, and in practical mode."""
    paper = {n: lost(got, "paper", n, TURNAROUND_US) for n in NS}
    words = joined(
        f"n = {n}: {hit} of {of} packets lost silently ({percent(hit / of, 1)})"
        for n, (hit, of) in paper.items()
    )
    yield Claim(
        "4",
        "CSMA/CD-R works with modules that take 2 ms to change between sending and receiving",
        f"event level, T = 25, collisions of natural starts: {words}",
        verdict(max(hit / of for hit, of in paper.values()) < 0.05),
        "F2: who ends second to last is deaf for 2 ms and misses the last one's tail, unless "
        "that ends 1.9 ms later; nobody reports. The experiment had something the text does "
        "not say",
    )
    none = [lost(got, "paper", n, 0) for n in NS]
    yield Claim(
        "2.2",
        "with no turnaround every collision is noticed",
        f"lost silently with ta = 0, n = {joined(NS)}: {joined(hit for hit, _ in none)} packets of "
        f"{none[0][1] // NS[0]} collisions each",
        verdict(not any(hit for hit, _ in none), "Q6"),
    )
    practical = [lost(got, "practical", n, ta) for n in NS for ta in TURNAROUNDS]
    hits, of = map(sum, zip(*practical, strict=True))
    yield beyond(
        "the practical mode loses no packet silently at any turnaround up to 2 ms",
        f"{hits} of {of} packets, n = {joined(NS)}, turnaround 0 to 2 ms",
        verdict(hits == 0),
        "a packet counts as delivered only when the next frame says so, not when it is silent",
    )
