"""Fairness and delay: who has to wait how long, in saturation and under light load."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from innervate.networks.radio.papers.common import CONTENDING, LOOKS, MACS, RESERVED, SHORT
from innervate.networks.radio.papers.medium import Channel
from innervate.networks.radio.slotted.model import slotted
from innervate.papers import drawing
from innervate.papers.experiment import Claim, Claims, Measured, Point, beyond, sized, verdict
from innervate.papers.words import joined
from innervate.plot import style

TITLE = "Fairness and delay"
CAPTION = (
    "a: time between two packets of a station, and the longest that any waited. b: Poisson "
    "arrivals, from the offer to the end of the packet. Event level: means of the runs."
)
N, SIZE = 10, 25
seeds = sized(3, 10)  # how many runs of each protocol
packets = sized(300, 1000)  # of a station in a run
LOADS = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6)
LIGHT = ("csma-cd-d1", "csma-cd-d2", RESERVED)
SHARES = (50, 95, 99)
FILLS = (style.INK, style.SOFT, style.FAINT, style.INK)
WAITS = ("50 %", "95 %", "99 %", "longest")
EVENT = {"paper": "CSMA/CD-R, event level", "practical": "practical mode, event level"}


def points(quick: bool) -> list[Point]:
    """Saturation and Poisson traffic, slotted and event level."""
    made = [level(mac, None, quick) for mac in MACS]
    made += [level(mac, load, quick) for mac in LIGHT for load in LOADS]
    return made + [event(mode, load, quick) for mode in EVENT for load in (*LOADS, 0)]


def event(mode: str, load: float, quick: bool) -> Point:
    """The same on the event level; load 0 = saturated."""
    traffic = "poisson" if load else "saturated"
    channel = Channel(mode, N, SIZE, traffic=traffic, load=load, packets=packets(quick) // 5)
    return channel.point(seeds(quick))


def level(mac: str, load: float | None, quick: bool) -> Point:
    """The slotted level; no load = saturated."""
    words = "saturated" if load is None else f"load {load:g}"
    key = f"delays {mac} n={N} T={SIZE} {words} {packets(quick)} seeds 1-{seeds(quick)}"
    return Point.of(key, 0.03 * seeds(quick), waits, mac, load, quick)


def waits(mac: str, load: float | None, quick: bool) -> dict[str, Any]:
    """Delay percentiles over all runs, mean Jain index, share served that waited longest."""
    traffic = "saturated" if load is None else "poisson"
    runs = [
        slotted(mac, N, SIZE, traffic, packets=packets(quick), seed=seed, load=load)
        for seed in range(1, seeds(quick) + 1)
    ]
    # A station that got nothing has waited all the time.
    starved = [run.elapsed_slots for run in runs if min(run.successes) == 0]
    most = max(0.0, *starved, *(float(run.delay_slots.max()) for run in runs))
    found = np.percentile(np.concatenate([run.delay_slots for run in runs]), SHARES).tolist()
    return {
        "delay": [*found, most],
        "jain_round": float(np.mean([run.jain_round for run in runs])),
        "longest": float(np.mean([longest(run.order) for run in runs])),
    }


def longest(order: list[int]) -> float:
    """In saturation: share of successes of the station whose last one is the longest ago."""
    queue: list[int] = []
    hits = counted = 0
    for station in order:
        if station in queue:
            counted += len(queue) > 1
            hits += len(queue) > 1 and queue[0] == station
            queue.remove(station)
        queue.append(station)
    return hits / counted if counted else 0.0


def _event_waits(got: Measured, mode: str) -> list[float]:
    found = np.array(got[event(mode, 0, got.quick)]["waits"])
    return [*found[:, :3].mean(axis=0).tolist(), float(found[:, 3].max())]


def draw(got: Measured) -> Figure:
    """Delay percentiles in saturation; 95th percentile over the load."""
    figure, (left, right) = style.panels(style.WIDE_IN, 3.3, 1, 2, width_ratios=(1.25, 1))
    slotted_level = {mac: got[level(mac, None, got.quick)]["delay"] for mac in MACS}
    rows = {LOOKS[mac].name: slotted_level[mac] for mac in MACS if mac != RESERVED}
    rows["CSMA/CD-R, slotted"] = slotted_level[RESERVED]
    rows |= {name: _event_waits(got, mode) for mode, name in EVENT.items()}
    for place, values in enumerate(rows.values()):
        left.plot([values[0], values[-1]], [place, place], color=style.SOFT, lw=0.8)
        for i, value in enumerate(values):
            left.plot(value, place, style.MARKERS[i], color=style.INK, mfc=FILLS[i], ms=4,
                      label=WAITS[i] if place == 0 else None)  # fmt: skip
    left.set_xscale("log")
    drawing.rows(left, list(rows))
    left.set_xlabel("wait for the next packet to get through (slots)")
    left.set_title(f"a  saturation, n = {N}, T = {SIZE}")
    left.legend(loc="upper center", bbox_to_anchor=(0.4, -0.19), ncols=4, columnspacing=1)
    _loads(right, got)
    return figure


def _loads(ax: Axes, got: Measured) -> None:
    for mac in LIGHT:
        values = [got[level(mac, load, got.quick)]["delay"][1] for load in LOADS]
        ax.plot(LOADS, values, **LOOKS[mac].how)
    for mode, colour, marker in zip(EVENT, (style.SKY, style.BLACK), ("P", "X"), strict=True):
        found = [got[event(mode, load, got.quick)]["delay"] for load in LOADS]
        values = [float(np.mean([one["p95"] for one in some])) for some in found]
        ax.plot(LOADS, values, color=colour, marker=marker, ls="-", label=EVENT[mode])
    ax.set(yscale="log", ylim=(25, 8e6), yticks=[1e2, 1e3, 1e4, 1e5], title="b  random arrivals")
    ax.set(xlabel="load (packets per packet time)", ylabel="95 % of the delays below (slots)")
    ax.minorticks_off()
    ax.legend(loc="upper left")


def judge(got: Measured) -> Claims:
    """First in first out of CSMA/CD; fairness; the tail of the delays."""
    found = {mac: got[level(mac, None, got.quick)] for mac in MACS}
    yield Claim(
        "3",
        "CSMA/CD cannot guarantee the first-in-first-out",
        f"share of packets that go to the station that waited longest, n = {N}, T = {SIZE}: "
        + joined(f"{name} {found[mac]['longest']:.2f}" for mac, name in SHORT.items())
        + " (1.00 = first in, first out)",
        verdict(max(found[mac]["longest"] for mac in CONTENDING) < 0.9),
    )
    fifo = {mode: float(np.mean(got[event(mode, 0.3, got.quick)]["fifo"])) for mode in EVENT}
    yield Claim(
        "3",
        "CSMA/CD-R guarantees the first-in-first-out, whenever packets arrive",
        f"event level, load 0.3, n = {N}: pairs that waited together and were served in order: "
        f"as published {fifo['paper']:.2f}, practical {fifo['practical']:.2f}",
        verdict(min(fifo.values()) > 0.99),
        "only those who collided are put in order, and only by their ends (F1); a packet that "
        "comes later in an idle moment goes out at once (Q7)",
    )
    paper, practical = (np.mean(got[event(mode, 0, got.quick)]["jain_round"]) for mode in EVENT)
    jains = joined(f"{LOOKS[mac].name} {found[mac]['jain_round']:.2f}" for mac in MACS)
    yield beyond(
        "over one round CSMA/CD-R is fair where contention is not",
        f"Jain's index over one round, n = {N}, T = {SIZE}: {jains}; event level: as "
        f"published {paper:.2f}, practical {practical:.3f}",
        verdict(found[RESERVED]["jain_round"] == 1 and float(practical) > 0.99),
        "the slotted level is given the order; on the event level it is what the practical "
        "mode keeps and the published rules lose to ties (F1)",
    )
    yield _tails(got, {mac: found[mac]["delay"] for mac in MACS})


def _tails(got: Measured, delays: dict[str, list[float]]) -> Claim:
    theirs = {name: delays[mac] for mac, name in SHORT.items()}
    practical = _event_waits(got, "practical")
    tails = {"CSMA/CD-R, slotted": delays[RESERVED], **theirs, "practical": practical}
    words = (f"{name} {' / '.join(f'{x:,.0f}' for x in some)}" for name, some in tails.items())
    return beyond(
        "in saturation nobody waits long under CSMA/CD-R",
        f"slots, 50 / 95 / 99 % / longest, of {seeds(got.quick)} runs: " + joined(words, "; "),
        verdict(max(delays[RESERVED][3], practical[3]) < min(some[3] for some in theirs.values())),
        "most waits of CSMA/CD are short because one station waits for nothing while the "
        "others get nothing (F3)",
    )
