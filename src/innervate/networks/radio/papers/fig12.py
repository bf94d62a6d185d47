"""Fig. 12: five real robots, T = 25. The text leaves three readings of T; all of them.

Whatever T contains, a radio that sends a CR-R switches for it, too: X2, in which the 25 slots of a
packet hold its switching, therefore gives the CR-Rs the paper's 20 slots as well.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from innervate.networks.radio.papers.common import (
    LOOKS,
    RESERVED,
    TURNAROUND,
    TURNAROUND_US,
    Curve,
    Options,
    bars,
    joined,
    percent,
)
from innervate.networks.radio.papers.medium import Channel
from innervate.networks.radio.slotted.drive import SLOT
from innervate.papers.experiment import Claim, Experiment, Point, Results, verdict
from innervate.plot import style

NS = (2, 3, 4, 5)
MACS = (RESERVED, "csma-cd-d2", "csma-cd-d2p")


SWITCHING = 20  # slots, "20 slots for transitions" (section 4)


class Reading(NamedTuple):
    """What T = 25 is [radio Q16].

    Attributes:
        name, words: as in the table.
        size: slots on the air.
        turnaround: a hand-over costs 2 ms besides.
        report: slots of switching that the CR-Rs cost, where no turnaround does.
    """

    name: str
    words: str
    size: int
    turnaround: bool
    report: int = 0


SIMULATED = Reading("simulation", "T = 25, no turnaround (Fig. 5)", 25, False)
READINGS = (
    Reading("X1", "25 slots on air, 2 ms per hand-over", 25, True),
    Reading("X2", "switching in the 25 slots, 20 slots for the CR-Rs", 25, False, SWITCHING),
    Reading("X3", "5 slots on air, 2 ms per hand-over", 5, True),
)


def curve(mac: str, reading: Reading, traffic: str, quick: bool) -> Curve:
    """The slotted level with that switching."""
    options: Options = (("turnaround_slots", TURNAROUND),) if reading.turnaround else ()
    if reading.report and mac == RESERVED:
        options = (("window", reading.size + reading.report),)
    if traffic == "disaster":
        return Curve(mac, reading.size, traffic, NS, 200 if quick else 2000, options=options)
    seeds = 1 if mac == RESERVED else (5 if quick else 40)
    return Curve(mac, reading.size, traffic, NS, seeds, 4000 if quick else 10_000, options)


def channel(
    reading: Reading, n: int, quick: bool, mode: str = "practical", traffic: str = "saturated"
) -> Channel:
    """The event level with that turnaround; there X2 has none, not for CR-Rs either."""
    ta = TURNAROUND_US if reading.turnaround else 0
    packets = 1 if traffic == "disaster" else 40 if quick else 200
    return Channel(mode, n, reading.size, ta, traffic, packets=packets)


DISASTERS = range(1, 21)  # event-level disasters each


def seeds(quick: bool) -> range:
    """Seeds of the saturated event-level runs: 10, or 2 if `quick`."""
    return range(1, 3 if quick else 11)


def points(quick: bool) -> list[Point]:
    """All readings on the slotted level, and what the practical mode does on the medium."""
    made = [
        curve(mac, reading, traffic, quick).point()
        for reading in READINGS
        for mac in MACS
        for traffic in ("saturated", "disaster")
    ]
    made += [
        curve(RESERVED, SIMULATED, traffic, quick).point() for traffic in ("saturated", "disaster")
    ]
    made += [
        channel(reading, n, quick, mode).point(seeds(quick))
        for reading in READINGS
        for n in NS
        for mode in ("practical", "paper")
    ]
    return made + [
        channel(reading, n, quick, traffic="disaster").point(DISASTERS)
        for reading in READINGS
        for n in NS
    ]


def draw(results: Results, quick: bool) -> Figure:
    """Above S, below T_D; a column a reading."""
    figure, axes = style.panels(style.WIDE_IN, 4.2, 2, 3, sharex=True, sharey="row")
    for above, below, reading in zip(axes[:3], axes[3:], READINGS, strict=True):
        _panel(above, results, quick, reading, "saturated", "throughput")
        _panel(below, results, quick, reading, "disaster", "duration")
        above.set_title(f"{reading.name}  " + reading.words.replace(", ", ",\n"))
        below.set_xticks(NS)
        below.set_xlabel("robots n")
    axes[0].set_ylabel("throughput S (air time)")
    axes[0].set_ylim(0, 1.04)
    axes[3].set_ylabel("$T_D$ (slots)")
    axes[3].set_ylim(0)
    axes[5].set_ylim(0)
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=3)
    return figure


def _panel(
    ax: Axes, results: Results, quick: bool, reading: Reading, traffic: str, name: str
) -> None:
    for mac in MACS:
        bars(ax, LOOKS[mac], NS, curve(mac, reading, traffic, quick).all(results, name))
    plain = curve(RESERVED, SIMULATED, traffic, quick).mean(results, name)
    ax.plot(NS, plain, color=style.BLUE, ls=style.DASHES[2], lw=0.9,
            label="CSMA/CD-R simulated, T = 25")  # fmt: skip
    many = seeds(quick) if traffic == "saturated" else DISASTERS
    found = [results[channel(reading, n, quick, traffic=traffic).key_of(many)][name] for n in NS]
    look = LOOKS["practical"]
    bars(ax, look, NS, found)


def judge(results: Results, quick: bool) -> list[Claim]:
    """The arithmetic, each reading, who is ahead, the medium."""
    return [
        _arithmetic(),
        *(_reading(results, quick, reading) for reading in READINGS),
        _ahead(results, quick),
        _medium(results, quick),
    ]


def _arithmetic() -> Claim:
    both = 2 * TURNAROUND_US / SLOT
    return Claim(
        "12",
        "2 ms to change a mode means 20 slots for both transitions; with 2 of header and 3 of data "
        "T = 25",
        f"{both:.1f} slots for both; 20 + 2 + 3 = 25",
        verdict(round(both) in (19, 20), "Q16"),
        "2 ms per direction, rounded up",
    )


def is_similar_but_poorer(found: Any, plain: Any, longer: Any, shorter: Any) -> bool:
    """Poorer at every n, and similar: S above half, rising, and T_D less than twice.

    Args:
        found: S over n, of the reading.
        plain: S over n, of the simulation.
        longer: T_D over n, of the reading.
        shorter: T_D over n, of the simulation.
    """
    found, plain, longer, shorter = map(np.asarray, (found, plain, longer, shorter))
    poorer = bool((found < plain - 1e-9).all() and (longer > shorter + 1e-9).all())
    rising = bool((np.diff(found) > 0).all())
    return poorer and rising and bool((found > plain / 2).all() and (longer < 2 * shorter).all())


def _reading(results: Results, quick: bool, reading: Reading) -> Claim:
    plain, shorter = (
        curve(RESERVED, SIMULATED, traffic, quick).mean(results, name)
        for traffic, name in (("saturated", "throughput"), ("disaster", "duration"))
    )
    found = curve(RESERVED, reading, "saturated", quick).mean(results, "throughput")
    longer = curve(RESERVED, reading, "disaster", quick).mean(results, "duration")
    words = (
        f"n = 2..5: S {joined(f'{s:.3f}' for s in found)} against "
        f"{joined(f'{s:.3f}' for s in plain)} of the simulation; T_D "
        f"{joined(f'{t:.0f}' for t in longer)} against {joined(f'{t:.0f}' for t in shorter)} "
        f"slots, {100 * (longer[-1] / shorter[-1] - 1):+.0f} % at n = 5"
    )
    reasons = {
        "X1": f"at n = 5 {percent(found[-1] / plain[-1])} of the simulation's S: the turnaround is "
        "paid at the opening, the reservation and every turn",
        "X2": f"{percent(found[-1] / plain[-1])} of the simulation's S at n = 5: packets hold "
        "their switching, the CR-Rs of a resolution pay theirs; of T only 3 slots in 25 are data, "
        f"S of data {3 / 25 * found[-1]:.3f}",
        "X3": f"not similar: {percent(found[-1] / plain[-1])} of the simulation's S at n = 5, and "
        "T_D shorter, as packets are",
    }
    passed = is_similar_but_poorer(found, plain, longer, shorter)
    return Claim(
        "12",
        f"{reading.name} ({reading.words}): results are similar to the simulation (S above half of "
        "it, rising, T_D less than twice), but poorer",
        words,
        verdict(passed, "Q16"),
        reasons[reading.name] + ". The figure's image is not available to compare with",
    )


def _ahead(results: Results, quick: bool) -> Claim:
    words = []
    for reading in READINGS:
        one, *others = (
            float(curve(mac, reading, "saturated", quick).mean(results, "throughput")[-1])
            for mac in MACS
        )
        words.append(f"{reading.name} {one:.3f} against {joined(f'{s:.3f}' for s in others)}")
    ahead = [
        float(curve(RESERVED, reading, "saturated", quick).mean(results, "throughput")[-1])
        > float(curve("csma-cd-d2p", reading, "saturated", quick).mean(results, "throughput")[-1])
        for reading in READINGS
    ]
    return Claim(
        "12",
        "five robots: CSMA/CD-R is ahead of CSMA/CD without capture (D2') in every reading",
        f"S, CSMA/CD-R against D2, D2': {joined(words, '; ')}",
        verdict(all(ahead), "Q14", "Q16"),
        "slotted level, the order after a collision given",
    )


def _medium(results: Results, quick: bool) -> Claim:
    words, ours = [], []
    for reading in READINGS:
        found = {
            mode: results[channel(reading, 5, quick, mode).key_of(seeds(quick))]
            for mode in ("paper", "practical")
        }
        lost = sum(found["paper"]["silent"]) / sum(found["paper"]["completed"])
        ours.append(sum(found["practical"]["silent"]))
        words.append(
            f"{reading.name} {np.mean(found['practical']['throughput']):.3f} (practical), as "
            f"published {percent(lost)} of the packets lost silently"
        )
    return Claim(
        "beyond",
        "five robots on the event level: the practical mode loses nothing in any reading",
        f"S, n = 5, saturation: {joined(words, '; ')}",
        verdict(not any(ours)),
        "F2: what the experiment did against unnoticed collisions the text does not say",
    )


EXPERIMENT = Experiment(
    "fig12",
    "Fig. 12: five robots, three readings",
    "The paper's figure is not available as an image; its text leaves three readings of T = 25 "
    "(Q16). Slotted level with its switching; black: practical mode on the event level, whose "
    "X2 has no switching at all. Bars: from 5 to 95 % of the runs.",
    points,
    draw,
    judge,
)
