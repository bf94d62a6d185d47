"""Fairness and delay: who has to wait how long, in saturation and under light load."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from innervate.networks.radio.papers.common import LOOKS, MACS, RESERVED, joined
from innervate.networks.radio.papers.medium import Channel
from innervate.networks.radio.slotted.model import slotted
from innervate.papers.experiment import Claim, Experiment, Point, Results, verdict
from innervate.plot import style

N, SIZE = 10, 25
LOADS = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6)
LIGHT = ("csma-cd-d1", "csma-cd-d2", RESERVED)
EVENT = ("paper", "practical")
SHARES = (50, 95, 99)
FILLS = (style.INK, style.SOFT, style.FAINT, style.INK)
WAITS = ("50 %", "95 %", "99 %", "longest")
NAMES = {"paper": "CSMA/CD-R, event level", "practical": "practical mode, event level"}


def seeds(quick: bool) -> range:
    """Seeds of the runs of each protocol: 10, or 3 if `quick`."""
    return range(1, 4 if quick else 11)


def packets(quick: bool) -> int:
    """Packets of a station in a run."""
    return 300 if quick else 1000


def points(quick: bool) -> list[Point]:
    """Saturation and Poisson traffic, slotted and event level."""
    made = [_slotted_point(mac, None, quick) for mac in MACS]
    made += [_slotted_point(mac, load, quick) for mac in LIGHT for load in LOADS]
    made += [event(mode, load, quick).point(seeds(quick)) for mode in EVENT for load in LOADS]
    return made + [event(mode, 0, quick).point(seeds(quick)) for mode in EVENT]


def event(mode: str, load: float, quick: bool) -> Channel:
    """The same on the event level; load 0 = saturated."""
    traffic = "poisson" if load else "saturated"
    return Channel(mode, N, SIZE, traffic=traffic, load=load, packets=packets(quick) // 5)


def _key(mac: str, load: float | None, quick: bool) -> str:
    words = "saturated" if load is None else f"load {load:g}"
    return f"delays {mac} n={N} T={SIZE} {words} {packets(quick)} seeds 1-{len(seeds(quick))}"


def _slotted_point(mac: str, load: float | None, quick: bool) -> Point:
    return Point.of(_key(mac, load, quick), 0.03 * len(seeds(quick)), waits, mac, load, quick)


def waits(mac: str, load: float | None, quick: bool) -> dict[str, Any]:
    """Delay percentiles over all runs, mean Jain indices, share served that waited longest."""
    delays, jains, rounds, firsts = [], [], [], []
    most = 0.0
    for seed in seeds(quick):
        traffic = "saturated" if load is None else "poisson"
        run = slotted(mac, N, SIZE, traffic, packets=packets(quick), seed=seed, load=load)
        delays.append(run.delay_slots)
        # A station that got nothing has waited all the time.
        starved = run.elapsed_slots if min(run.successes) == 0 else 0.0
        most = max(most, float(run.delay_slots.max()), starved)
        jains.append(run.jain)
        rounds.append(run.jain_round)
        firsts.append(longest(run.order))
    found = np.percentile(np.concatenate(delays), SHARES).tolist()
    return {
        "delay": [*found, most],
        "jain": float(np.mean(jains)),
        "jain_round": float(np.mean(rounds)),
        "longest": float(np.mean(firsts)),
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


def draw(results: Results, quick: bool) -> Figure:
    """Delay percentiles in saturation; 95th percentile over the load."""
    figure, (left, right) = style.panels(style.WIDE_IN, 3.3, 1, 2, width_ratios=(1.25, 1))
    rows: list[tuple[str, list[float]]] = [
        (LOOKS[mac].name if mac != RESERVED else "CSMA/CD-R, slotted",
         results[_key(mac, None, quick)]["delay"])
        for mac in MACS
        if mac != "csma-cd-r"
    ]  # fmt: skip
    rows.append(("CSMA/CD-R, slotted", results[_key(RESERVED, None, quick)]["delay"]))
    rows += [(NAMES[mode], _event_waits(results, mode, quick)) for mode in EVENT]
    for place, (_, values) in enumerate(rows):
        left.plot([values[0], values[-1]], [place, place], color=style.SOFT, lw=0.8)
        for i, value in enumerate(values):
            left.plot(value, place, style.MARKERS[i], color=style.INK, mfc=FILLS[i], ms=4,
                      label=WAITS[i] if place == 0 else None)  # fmt: skip
    left.set_xscale("log")
    left.set_yticks(range(len(rows)), [name for name, _ in rows])
    left.set_ylim(len(rows) - 0.4, -0.6)
    left.set_xlabel("wait for the next packet to get through (slots)")
    left.set_title(f"a  saturation, n = {N}, T = {SIZE}")
    left.legend(loc="upper center", bbox_to_anchor=(0.4, -0.19), ncols=4, columnspacing=1)
    _loads(right, results, quick)
    return figure


def _event_delay(results: Results, mode: str, load: float, quick: bool) -> list[float]:
    found = results[event(mode, load, quick).key_of(seeds(quick))]["delay"]
    return [float(np.mean([one[f"p{share}"] for one in found])) for share in SHARES]


def _event_waits(results: Results, mode: str, quick: bool) -> list[float]:
    found = np.array(results[event(mode, 0, quick).key_of(seeds(quick))]["waits"])
    return [*found[:, :3].mean(axis=0).tolist(), float(found[:, 3].max())]


def _loads(ax: Axes, results: Results, quick: bool) -> None:
    for mac in LIGHT:
        look = LOOKS[mac]
        values = [results[_key(mac, load, quick)]["delay"][1] for load in LOADS]
        ax.plot(LOADS, values, color=look.colour, ls=look.dash, marker=look.marker,
                label=look.name)  # fmt: skip
    for mode, colour, marker in zip(EVENT, (style.SKY, style.BLACK), ("P", "X"), strict=True):
        values = [_event_delay(results, mode, load, quick)[1] for load in LOADS]
        ax.plot(LOADS, values, color=colour, marker=marker, ls="-", label=NAMES[mode])
    ax.set_yscale("log")
    ax.set_xlabel("load (packets per packet time)")
    ax.set_ylabel("95 % of the delays below (slots)")
    ax.set_title("b  random arrivals")
    ax.set_ylim(25, 8e6)
    ax.set_yticks([1e2, 1e3, 1e4, 1e5])
    ax.minorticks_off()
    ax.legend(loc="upper left")


def judge(results: Results, quick: bool) -> list[Claim]:
    """First in first out of CSMA/CD; fairness; the tail of the delays."""
    d = {mac: results[_key(mac, None, quick)] for mac in MACS}
    practical = results[event("practical", 0, quick).key_of(seeds(quick))]
    paper = results[event("paper", 0, quick).key_of(seeds(quick))]
    contending = ("csma-cd-d1", "csma-cd-d2", "csma-cd-d2p")
    longest_words = joined(
        f"{n} {d[m]['longest']:.2f}" for n, m in zip(("D1", "D2", "D2'"), contending, strict=True)
    )
    jain_words = joined(f"{LOOKS[m].name} {d[m]['jain_round']:.2f}" for m in MACS)
    tails = {
        "CSMA/CD-R, slotted": d[RESERVED]["delay"],
        "D1": d["csma-cd-d1"]["delay"],
        "D2": d["csma-cd-d2"]["delay"],
        "D2'": d["csma-cd-d2p"]["delay"],
        "practical": _event_waits(results, "practical", quick),
    }
    fifo = {
        mode: float(np.mean(results[event(mode, 0.3, quick).key_of(seeds(quick))]["fifo"]))
        for mode in EVENT
    }
    return [
        Claim(
            "3",
            "CSMA/CD cannot guarantee the first-in-first-out",
            f"share of packets that go to the station that waited longest, n = {N}, T = {SIZE}: "
            f"{longest_words} (1.00 = first in, first out)",
            verdict(max(d[m]["longest"] for m in contending) < 0.9),
        ),
        Claim(
            "3",
            "CSMA/CD-R guarantees the first-in-first-out, whenever packets arrive",
            f"event level, load 0.3, n = {N}: pairs that waited together and were served in order: "
            f"as published {fifo['paper']:.2f}, practical {fifo['practical']:.2f}",
            verdict(min(fifo.values()) > 0.99),
            "only those who collided are put in order, and only by their ends (F1); a packet that "
            "comes later in an idle moment goes out at once (Q7)",
        ),
        Claim(
            "beyond",
            "over one round CSMA/CD-R is fair where contention is not",
            f"Jain's index over one round, n = {N}, T = {SIZE}: {jain_words}; event level: as "
            f"published {np.mean(paper['jain_round']):.2f}, practical "
            f"{np.mean(practical['jain_round']):.3f}",
            verdict(
                d[RESERVED]["jain_round"] == 1 and float(np.mean(practical["jain_round"])) > 0.99
            ),
            "the slotted level is given the order; on the event level it is what the practical "
            "mode keeps and the published rules lose to ties (F1)",
        ),
        Claim(
            "beyond",
            "in saturation nobody waits long under CSMA/CD-R",
            f"slots, 50 / 95 / 99 % / longest, of {len(seeds(quick))} runs: "
            + joined(
                (f"{name} {' / '.join(f'{x:,.0f}' for x in some)}" for name, some in tails.items()),
                "; ",
            ),
            verdict(
                max(tails["CSMA/CD-R, slotted"][3], tails["practical"][3])
                < min(tails[name][3] for name in ("D1", "D2", "D2'"))
            ),
            "most waits of CSMA/CD are short because one station waits for nothing while the "
            "others get nothing (F3)",
        ),
    ]


EXPERIMENT = Experiment(
    "fairness",
    "Fairness and delay",
    "a: time between two packets of a station, and the longest that any waited. b: Poisson "
    "arrivals, from the offer to the end of the packet. Event level: means of the runs.",
    points,
    draw,
    judge,
)
