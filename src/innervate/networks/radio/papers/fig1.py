"""Fig. 1: four robots collide, report and take turns; every event of it to the microsecond."""

from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from innervate.networks.radio.analysis import formulas as forms
from innervate.networks.radio.papers import lanes
from innervate.networks.radio.papers.common import TAU_US
from innervate.networks.radio.papers.medium import START_US, Channel, aired, said
from innervate.networks.radio.protocol import constants
from innervate.networks.radio.slotted.drive import SLOT
from innervate.papers.experiment import Claim, Claims, Measured, Point, verdict
from innervate.papers.words import joined
from innervate.plot import style
from innervate.sim.tables import uniform

TITLE = "Fig. 1: a collision is resolved"
CAPTION = (
    "Event level, T = 25, no turnaround. Above: the whole; below: reports and window enlarged. Each"
    " robot's own CD and VOC below its frames."
)
R1, R2, R3, R4 = range(4)
NAMES = ("Robot1", "Robot2", "Robot3", "Robot4")
CHANNEL = Channel("paper", 4, 25, starts_us=(1248, 1040, 624, 0))
# Worked by hand from the paper's rules (us from the first start): robot, from, to.
PACKETS = (
    (R4, 0, 5200), (R3, 624, 5824), (R2, 1040, 6240), (R1, 1248, 6448),
    (R4, 11856, 17056), (R3, 17160, 22360), (R2, 22464, 27664), (R1, 27768, 32968),
)  # fmt: skip
REPORTS = ((R2, 6552, 6760), (R3, 7280, 7488), (R4, 7904, 8112))
HEARD_MS = 6.864  # the end of the first CR-R's reception
UNTIL_US = 33_500
PACKET_US = 25 * SLOT


def measure() -> dict[str, Any]:
    """The run and what its stations said."""
    result = CHANNEL.run(1)
    found = lanes.record(result, UNTIL_US)
    found["packets"] = aired(result, constants.DATA)
    found["reports"] = aired(result, constants.CRR)
    for name, code in (("counts", constants.REPORT_COUNT), ("roles", constants.REPORT_ROLE)):
        found[name] = [said(result, code)[node][0][0] for node in range(4)]
    return found


def chain(n: int, seed: int) -> tuple[int, ...]:
    """Starts more than a slot apart, all before the first packet ends."""
    room = max(0, PACKET_US // (n - 1) - SLOT - 30)
    gaps = SLOT + 1 + uniform(seed, "gaps", n - 1, room + 1)
    return (0, *(int(at) for at in gaps.cumsum()))


def durations(quick: bool) -> list[list[int]]:
    """Measured T_D, by the closed form (us), and whether first ended was first served."""
    found = []
    for n in range(2, 21):
        for seed in range(1, 3 if quick else 11):
            starts = chain(n, seed)
            result = Channel("paper", n, 25, starts_us=starts).run(seed)
            ends = sorted(start + PACKET_US for start in starts)
            exact = forms.resolved_duration_us(
                ends[-1], n, PACKET_US, TAU_US, SLOT, ends[-1] - ends[-2]
            )
            order = result.packets[result.packets["end"].argsort()]["node"].tolist()
            measured = int(result.packets["end"].max()) - START_US
            found.append([measured, exact, int(order == list(range(n)))])
    return found


def chains(quick: bool) -> Point:
    """Collisions of 2 to 20 whose durations are held against the closed form."""
    return Point.of(f"fig1 chains of {38 if quick else 190}", 0.5, durations, quick)


def points(quick: bool) -> list[Point]:
    """The run of the figure, and others like it."""
    return [Point.of("fig1 run", 0.1, measure), chains(quick)]


def draw(got: Measured) -> Figure:
    """The paper's figure, and its middle enlarged."""
    figure, (whole, middle) = style.panels(style.WIDE_IN, 4.6, 2, 1)
    for ax in (whole, middle):
        lanes.draw(ax, got.values["fig1 run"], NAMES, range(4), waves=True)
    whole.set_xlim(-0.3, UNTIL_US / 1e3)
    whole.legend(handles=lanes.keys(waves=True), loc="lower left", ncols=6,
                 bbox_to_anchor=(0, 1), columnspacing=1.2)  # fmt: skip
    middle.set_xlim(4.9, 12.6)
    middle.text(REPORTS[0][2] / 1e3 + 0.06, R2 + 0.12, "reports", fontsize=6)
    for (node, start, _), name in zip(REPORTS[1:], ("$T_{c1}$", "$T_{c2}$"), strict=True):
        _span(middle, start / 1e3, node + 0.1)
        middle.text((HEARD_MS + start / 1e3) / 2, node, name, ha="center", fontsize=6)
    _span(middle, 11.856, R4 - 0.22)
    words = "$T - T_{c0}$ from the end of the first CR-R"
    middle.text(10, R4 + 0.02, words, ha="center", fontsize=6)
    return figure


def _span(ax: Axes, until_ms: float, y: float) -> None:
    how = {"arrowstyle": "<->", "lw": 0.6, "shrinkA": 0, "shrinkB": 0}
    ax.annotate("", (until_ms, y), (HEARD_MS, y), arrowprops=how)


def judge(got: Measured) -> Claims:
    """Events, rules 3 to 5, order, durations."""
    run = got.values["fig1 run"]
    wanted = [list(one) for one in (*PACKETS, *REPORTS)]
    found = run["packets"] + run["reports"]
    same = 2 * sum(one == other for one, other in zip(found, wanted, strict=False))
    yield Claim(
        "1",
        "the example of Fig. 1: four robots collide, three report, all retransmit in turn",
        f"{same} of 22 starts and ends are those worked by hand, to the microsecond",
        verdict(same == 22 and len(found) == 11, "Q2", "Q4"),
        "starts 0, 624, 1040, 1248 us; readings Q4: T_cn and T - T_c0 count from the end of "
        "the first CR-R's reception",
    )
    counts, turns = run["counts"], [run["turns"][str(node)] for node in range(4)]
    words = joined(f"{NAMES[i]} {counts[i]}, turn {turns[i]}" for i in range(4))
    yield Claim(
        "1",
        "rule (5): a node which receives n CR-Rs after its own transmits at the n + 1st turn",
        f"CR-Rs heard, turn: {words}",
        verdict(counts == [3, 2, 1, 0] and turns == [4, 3, 2, 1]),
    )
    at = run["reports"][0][1]
    yield Claim(
        "1",
        "the second latest node transmits a CR-R at the moment that CD becomes 0",
        f"Robot2, at {at} us; the last end, 6448 us, has reached it at {6448 + TAU_US}",
        verdict(run["roles"][R2] == constants.REPORTER and at == 6448 + TAU_US),
    )
    many = got[chains(got.quick)]
    exact = sum(measured == form for measured, form, _ in many)
    fifo = sum(first for *_, first in many)
    yield Claim(
        "2.2",
        "each node can retransmit according to a priority scheme (first in, first out), n = 2..20",
        f"ends more than a slot apart: {fifo} of {len(many)} collisions in order, {exact} of "
        f"{len(many)} of the duration of the closed form, to the microsecond",
        verdict(fifo == exact == len(many), "Q6"),
        "carrier sense does not let stations of one packet length end so far apart: see F1",
    )
