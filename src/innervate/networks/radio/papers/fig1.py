"""Fig. 1: four robots collide, report and take turns; every event of it to the microsecond."""

from __future__ import annotations

from typing import Any

from matplotlib.figure import Figure

from innervate.networks.radio.analysis import formulas as forms
from innervate.networks.radio.papers import lanes
from innervate.networks.radio.papers.common import TAU_US, joined
from innervate.networks.radio.papers.medium import START_US, Channel, aired, said
from innervate.networks.radio.protocol.constants import (
    CRR,
    DATA,
    REPORT_COUNT,
    REPORT_ROLE,
    REPORTER,
)
from innervate.networks.radio.slotted.drive import SLOT
from innervate.papers.experiment import Claim, Experiment, Point, Results, verdict
from innervate.plot import style
from innervate.sim.tables import uniform

R1, R2, R3, R4 = range(4)
NAMES = ("Robot1", "Robot2", "Robot3", "Robot4")
CHANNEL = Channel("paper", 4, 25, starts_us=(1248, 1040, 624, 0))
# Worked by hand from the paper's rules (us from the first start): robot, from, to.
PACKETS = (
    (R4, 0, 5200), (R3, 624, 5824), (R2, 1040, 6240), (R1, 1248, 6448),
    (R4, 11856, 17056), (R3, 17160, 22360), (R2, 22464, 27664), (R1, 27768, 32968),
)  # fmt: skip
REPORTS = ((R2, 6552, 6760), (R3, 7280, 7488), (R4, 7904, 8112))
UNTIL_US = 33_500
PACKET_US = 25 * SLOT


def measure() -> dict[str, Any]:
    """The run and what its stations said."""
    result = CHANNEL.run(1)
    found = lanes.record(result, UNTIL_US)
    found["packets"] = aired(result, DATA)
    found["reports"] = aired(result, CRR)
    found["counts"] = [said(result, REPORT_COUNT)[node][0][0] for node in range(4)]
    found["roles"] = [said(result, REPORT_ROLE)[node][0][0] for node in range(4)]
    return found


def chain(n: int, seed: int) -> tuple[int, ...]:
    """Starts more than a slot apart, all before the first packet ends."""
    room = max(0, PACKET_US // (n - 1) - SLOT - 30)
    gaps = SLOT + 1 + uniform(seed, "gaps", n - 1, room + 1)
    return (0, *(int(at) for at in gaps.cumsum()))


def chains(quick: bool) -> list[tuple[int, int]]:
    """(n, seed) of the collisions whose durations are held against the closed form."""
    return [(n, seed) for n in range(2, 21) for seed in range(1, 3 if quick else 11)]


def durations(quick: bool) -> list[list[int]]:
    """Measured T_D, by the closed form (us), and whether first ended was first served."""
    found = []
    for n, seed in chains(quick):
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


def points(quick: bool) -> list[Point]:
    """The run of the figure, and others like it."""
    chained = Point.of(f"fig1 chains of {len(chains(quick))}", 0.5, durations, quick)
    return [Point.of("fig1 run", 0.1, measure), chained]


def draw(results: Results, quick: bool) -> Figure:
    """The paper's figure, and its middle enlarged."""
    run = results["fig1 run"]
    figure, (whole, middle) = style.panels(style.WIDE_IN, 4.6, 2, 1)
    for ax in (whole, middle):
        lanes.draw(ax, run, NAMES, range(4), waves=True)
    whole.set_xlim(-0.3, UNTIL_US / 1e3)
    whole.legend(handles=lanes.keys(waves=True, deaf=True), loc="lower left", ncols=6,
                 bbox_to_anchor=(0, 1), columnspacing=1.2)  # fmt: skip
    middle.set_xlim(4.9, 12.6)
    for node, start, end, name in ((R2, 6552, 6760, "reports"), (R3, 7280, 7488, "$T_{c1}$"),
                                   (R4, 7904, 8112, "$T_{c2}$")):  # fmt: skip
        if node == R2:
            middle.text(end / 1e3 + 0.06, node + 0.12, name, fontsize=6)
            continue
        middle.annotate(
            "",
            (start / 1e3, node + 0.1),
            (6.864, node + 0.1),
            arrowprops={"arrowstyle": "<->", "lw": 0.6, "shrinkA": 0, "shrinkB": 0},
        )
        middle.text((6.864 + start / 1e3) / 2, node, name, ha="center", fontsize=6)
    middle.annotate(
        "",
        (11.856, R4 - 0.22),
        (6.864, R4 - 0.22),
        arrowprops={"arrowstyle": "<->", "lw": 0.6, "shrinkA": 0, "shrinkB": 0},
    )
    middle.text(10, R4 + 0.02, "$T - T_{c0}$ from the end of the first CR-R", ha="center",
                fontsize=6)  # fmt: skip
    return figure


def judge(results: Results, quick: bool) -> list[Claim]:
    """Events, rules 3 to 5, order, durations."""
    run = results["fig1 run"]
    wanted = [list(one) for one in (*PACKETS, *REPORTS)]
    found = run["packets"] + run["reports"]
    same = sum(2 if one == other else 0 for one, other in zip(found, wanted, strict=False))
    return [
        Claim(
            "1",
            "the example of Fig. 1: four robots collide, three report, all retransmit in turn",
            f"{same} of 22 starts and ends are those worked by hand, to the microsecond",
            verdict(same == 22 and len(found) == 11, "Q2", "Q4"),
            "starts 0, 624, 1040, 1248 us; readings Q4: T_cn and T - T_c0 count from the end of "
            "the first CR-R's reception",
        ),
        _rule_5(run),
        _reporter(run),
        _durations(results, quick),
    ]


def _rule_5(run: Any) -> Claim:
    counts, turns = run["counts"], [run["turns"][str(node)] for node in range(4)]
    words = joined(f"{NAMES[i]} {counts[i]}, turn {turns[i]}" for i in range(4))
    return Claim(
        "1",
        "rule (5): a node which receives n CR-Rs after its own transmits at the n + 1st turn",
        f"CR-Rs heard, turn: {words}",
        verdict(counts == [3, 2, 1, 0] and turns == [4, 3, 2, 1]),
    )


def _reporter(run: Any) -> Claim:
    at = run["reports"][0][1]
    return Claim(
        "1",
        "the second latest node transmits a CR-R at the moment that CD becomes 0",
        f"Robot2, at {at} us; the last end, 6448 us, has reached it at {6448 + TAU_US}",
        verdict(run["roles"][R2] == REPORTER and at == 6448 + TAU_US),
    )


def _durations(results: Results, quick: bool) -> Claim:
    found = results[f"fig1 chains of {len(chains(quick))}"]
    exact = sum(measured == form for measured, form, _ in found)
    fifo = sum(first for *_, first in found)
    return Claim(
        "2.2",
        "each node can retransmit according to a priority scheme (first in, first out), n = 2..20",
        f"ends more than a slot apart: {fifo} of {len(found)} collisions in order, {exact} of "
        f"{len(found)} of the duration of the closed form, to the microsecond",
        verdict(fifo == exact == len(found), "Q6"),
        "carrier sense does not let stations of one packet length end so far apart: see F1",
    )


EXPERIMENT = Experiment(
    "fig1",
    "Fig. 1: a collision is resolved",
    "Event level, T = 25, no turnaround. Above: the whole; below: reports and window enlarged. Each"
    " robot's own CD and VOC below its frames.",
    points,
    draw,
    judge,
)
