"""F3: CSMA/CD's advantage with few stations is capture: one station has the channel."""

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from innervate.networks.radio.analysis import formulas as forms
from innervate.networks.radio.papers import common
from innervate.networks.radio.papers.common import CONTENDING, LOOKS, RESERVED, SIZES, Curve
from innervate.networks.radio.slotted.model import slotted
from innervate.papers.experiment import Claim, Claims, Measured, Point, beyond, verdict
from innervate.papers.words import joined
from innervate.plot import style

TITLE = "F3: what CSMA/CD's advantage is made of"
CAPTION = (
    "Slotted level, saturation. a: a stretch of one run, each station in its lane. b, c: means "
    "of all runs, bands from 5 to 95 %; D2 and D2' differ in whether a winner draws a backoff."
)
NS = (2, 3, 4, 5, 7, 10, 15, 20, 30, 50, 70, 100)
SMALL = (2, 3, 4, 5, 7, 10)
SHOWN = 5
TURNS = 120
STRIPS = ("csma-cd-d2", "csma-cd-d2p", RESERVED)


def curve(mac: str, size: int, quick: bool) -> Curve:
    """Fairness and S over n."""
    if mac == RESERVED:
        return Curve(mac, size, "saturated", NS, 1, 2000)
    return Curve(mac, size, "saturated", NS, 5 if quick else 20, 4000 if quick else 10_000)


def points(quick: bool) -> list[Point]:
    """All CSMA/CD at both packet lengths, and who gets through in a run."""
    made = [curve(mac, size, quick).point() for mac in (*CONTENDING, RESERVED) for size in SIZES]
    return [*made, Point.of(f"order of successes n={SHOWN}", 0.1, orders)]


def orders() -> dict[str, list[int]]:
    """Stations in the order of success, in a stretch of a saturated run."""
    return {
        mac: slotted(mac, SHOWN, 5, "saturated", packets=400).order[600 : 600 + TURNS]
        for mac in STRIPS
    }


def draw(got: Measured) -> Figure:
    """Who gets through; Jain's index; S with and without capture."""
    figure = style.figure(style.WIDE_IN, 3.4)
    above, below = figure.subfigures(2, 1, height_ratios=(1, 1.75), squeeze=False).flat
    _strips(above.subplots(), got.values[f"order of successes n={SHOWN}"])
    left, right = below.subplots(1, 2)
    for mac in (*CONTENDING, RESERVED):
        curve(mac, 5, got.quick).draw(left, got, "jain_round")
    left.plot(NS, [1 / n for n in NS], color=style.SOFT, ls=":", lw=0.9, label="1/n: one has all")
    for mac in STRIPS:
        curve(mac, 5, got.quick).draw(right, got)
    for ax in (left, right):
        common.stations_axis(ax)
        ax.set_ylim(0, 1.04)
    left.set(ylabel="Jain's index over one round", title="b  fairness, T = 5")
    left.legend(loc="center right", bbox_to_anchor=(1, 0.72))
    right.set(ylabel="throughput S", title="c  the winner draws a backoff, too: D2', T = 5")
    right.legend(loc="upper right", ncols=3, columnspacing=1)
    return figure


def _strips(ax: Axes, found: dict[str, list[int]]) -> None:
    for place, mac in enumerate(STRIPS):
        for i, station in enumerate(found[mac]):
            # Each station has its own height as well as its own colour.
            ax.plot([i, i + 1], [place + 0.26 - 0.13 * station] * 2, color=style.SERIES[station],
                    lw=1.9, solid_capstyle="butt")  # fmt: skip
    ax.set_yticks(range(3), [LOOKS[mac].name for mac in STRIPS])
    ax.set(ylim=(2.55, -0.55), xlim=(0, TURNS))
    ax.set_xlabel("packets in the order in which they get through")
    ax.set_title(f"a  whose packet it is, {SHOWN} stations in lanes, T = 5")
    ax.grid(axis="y", visible=False)


def _small(got: Measured, size: int) -> Claim:
    """The reason that the paper gives for what it sees at small n, at each of them."""
    ours = [forms.reserved_throughput(n, size) for n in SMALL]
    whole, drawn, jain = (
        curve(mac, size, got.quick).mean(got, name)[[NS.index(n) for n in SMALL]].tolist()
        for mac, name in zip((*STRIPS[:2], STRIPS[0]), ("", "", "jain_round"), strict=True)
    )
    words = [
        f"n = {n}: {w:.3f}, {d:.3f} against {o:.3f}, Jain {j:.2f}"
        for n, o, w, d, j in zip(SMALL, ours, whole, drawn, jain, strict=True)
    ]
    led = [n for n, o, w in zip(SMALL, ours, whole, strict=True) if w > o]
    still = [n for n, o, d in zip(SMALL, ours, drawn, strict=True) if n in led and d > o]
    share = f"at n = {joined(still)} only" if still else "at none of them"
    return Claim(
        "4, 5",
        f"T = {size}: CSMA/CD is more effective in small-size systems, due to CSMA/CD-R's fixed "
        "time T - T_c0",
        f"S of D2, of D2' (the winner draws a backoff too) against CSMA/CD-R, and D2's fairness "
        f"over one round: {joined(words, '; ')} ({curve(STRIPS[0], size, got.quick).seeds} runs)",
        verdict(bool(led) and still == led),
        f"F3: D2 leads at n = {joined(led)}, and without capture {share}: the fixed time "
        "explains it there, capture at the others",
    )


def judge(got: Measured) -> Claims:
    """The reason of the paper, and the other one."""
    for size in SIZES:
        yield _small(got, size)
    jain = {mac: curve(mac, 5, got.quick).mean(got, "jain_round") for mac in CONTENDING}
    ours = [curve(RESERVED, size, got.quick).mean(got, "jain_round") for size in SIZES]
    yield beyond(
        "CSMA/CD-R serves everybody once a round; capture does not come back",
        "Jain's index over one round at n = 5: CSMA/CD-R 1.00, "
        + joined(f"{common.SHORT[mac]} {of[NS.index(5)]:.2f}" for mac, of in jain.items()),
        verdict(all(bool((found == 1).all()) for found in ours), "Q3"),
        "D2' draws one slot or none after its own packet: who got through still has the best "
        "chance",
    )
