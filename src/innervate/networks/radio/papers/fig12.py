"""Fig. 12: five real robots, T = 25. The text leaves three readings of T; all of them.

Whatever T contains, a radio that sends a CR-R switches for it, too: X2, in which the 25 slots of a
packet hold its switching, therefore gives the CR-Rs the paper's 20 slots as well.
"""

from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from innervate.networks.radio.papers import common
from innervate.networks.radio.papers.common import LOOKS, RESERVED, TURNAROUND_US, Curve, Options
from innervate.networks.radio.papers.medium import Channel
from innervate.networks.radio.slotted.drive import SLOT
from innervate.papers import drawing
from innervate.papers.experiment import Claim, Claims, Measured, Point, beyond, verdict
from innervate.papers.words import joined, percent
from innervate.plot import style

TITLE = "Fig. 12: five robots, three readings"
CAPTION = (
    "The paper's figure is not available as an image; its text leaves three readings of T = 25 "
    "(Q16). Slotted level with its switching; black: practical mode on the event level, whose "
    "X2 has no switching at all. Bars: from 5 to 95 % of the runs."
)
NS = (2, 3, 4, 5)
MACS = (RESERVED, "csma-cd-d2", "csma-cd-d2p")
TRAFFIC = ("saturated", "disaster")
SWITCHING = 20  # slots, "20 slots for transitions" (section 4)


class Reading(NamedTuple):
    """What T = 25 is [radio Q16]."""

    # name, words: as in the table
    name: str
    words: str
    size: int  # slots on the air
    turnaround: bool  # a hand-over costs 2 ms besides
    report: int = 0  # slots of switching that the CR-Rs cost, where no turnaround does


SIMULATED = Reading("simulation", "T = 25, no turnaround (Fig. 5)", 25, False)
READINGS = (
    Reading("X1", "25 slots on air, 2 ms per hand-over", 25, True),
    Reading("X2", "switching in the 25 slots, 20 slots for the CR-Rs", 25, False, SWITCHING),
    Reading("X3", "5 slots on air, 2 ms per hand-over", 5, True),
)


def curve(mac: str, reading: Reading, traffic: str, quick: bool) -> Curve:
    """The slotted level with that switching."""
    options: Options = (("turnaround_slots", common.TURNAROUND),) if reading.turnaround else ()
    if reading.report and mac == RESERVED:
        options = (("window", reading.size + reading.report),)
    if traffic == "disaster":
        return Curve(mac, reading.size, traffic, NS, 200 if quick else 2000, options=options)
    seeds = 1 if mac == RESERVED else (5 if quick else 40)
    return Curve(mac, reading.size, traffic, NS, seeds, 4000 if quick else 10_000, options)


def event(
    reading: Reading, n: int, quick: bool, mode: str = "practical", traffic: str = "saturated"
) -> Point:
    """The event level with that turnaround; there X2 has none, not for CR-Rs either."""
    ta = TURNAROUND_US if reading.turnaround else 0
    packets = 1 if traffic == "disaster" else 40 if quick else 200
    seeds = 20 if traffic == "disaster" else 2 if quick else 10
    return Channel(mode, n, reading.size, ta, traffic, packets=packets).point(seeds)


def points(quick: bool) -> list[Point]:
    """All readings on the slotted level, and what the practical mode does on the medium."""
    cases = [(mac, reading) for reading in READINGS for mac in MACS] + [(RESERVED, SIMULATED)]
    made = [curve(*case, traffic, quick).point() for case in cases for traffic in TRAFFIC]
    for reading in READINGS:
        for n in NS:
            made += [event(reading, n, quick, mode) for mode in ("practical", "paper")]
            made.append(event(reading, n, quick, traffic="disaster"))
    return made


def draw(got: Measured) -> Figure:
    """Above S, below T_D; a column a reading."""
    figure, axes = style.panels(style.WIDE_IN, 4.2, 2, 3, sharex=True, sharey="row")
    for above, below, reading in zip(axes[:3], axes[3:], READINGS, strict=True):
        _panel(above, got, reading, "saturated", "throughput")
        _panel(below, got, reading, "disaster", "duration")
        above.set_title(f"{reading.name}  " + reading.words.replace(", ", ",\n"))
        below.set(xticks=NS, xlabel="robots n")
    axes[0].set(ylabel="throughput S (air time)", ylim=(0, 1.04))
    axes[3].set(ylabel="$T_D$ (slots)", ylim=(0, None))
    axes[5].set_ylim(0)
    drawing.legend(figure, axes[0], "lower center", ncols=3)
    return figure


def _panel(ax: Axes, got: Measured, reading: Reading, traffic: str, name: str) -> None:
    for mac in MACS:
        common.bars(ax, LOOKS[mac], NS, curve(mac, reading, traffic, got.quick).all(got))
    ax.plot(NS, _simulated(got, traffic), color=style.BLUE, ls=style.DASHES[2], lw=0.9,
            label="CSMA/CD-R simulated, T = 25")  # fmt: skip
    found = [got[event(reading, n, got.quick, traffic=traffic)][name] for n in NS]
    common.bars(ax, LOOKS["practical"], NS, found)


def _simulated(got: Measured, traffic: str) -> Any:
    """S or T_D of CSMA/CD-R with T = 25 and no switching, over n."""
    return curve(RESERVED, SIMULATED, traffic, got.quick).mean(got)


def judge(got: Measured) -> Claims:
    """The arithmetic, each reading, who is ahead, the medium."""
    both = 2 * TURNAROUND_US / SLOT
    yield Claim(
        "12",
        "2 ms to change a mode means 20 slots for both transitions; with 2 of header and 3 of data "
        "T = 25",
        f"{both:.1f} slots for both; 20 + 2 + 3 = 25",
        verdict(round(both) in (19, 20), "Q16"),
        "2 ms per direction, rounded up",
    )
    for reading in READINGS:
        yield _reading(got, reading)
    yield _ahead(got)
    yield _medium(got)


def is_similar_but_poorer(found: Any, plain: Any, longer: Any, shorter: Any) -> bool:
    """Poorer at every n, and similar: S above half, rising, and T_D less than twice.

    S over n of the reading and of the simulation, then T_D of both.
    """
    found, plain, longer, shorter = map(np.asarray, (found, plain, longer, shorter))
    poorer = bool((found < plain - 1e-9).all() and (longer > shorter + 1e-9).all())
    rising = bool((np.diff(found) > 0).all())
    return poorer and rising and bool((found > plain / 2).all() and (longer < 2 * shorter).all())


def _reading(got: Measured, reading: Reading) -> Claim:
    plain, shorter = (_simulated(got, traffic) for traffic in TRAFFIC)
    found, longer = (curve(RESERVED, reading, t, got.quick).mean(got) for t in TRAFFIC)
    share = percent(found[-1] / plain[-1])
    reasons = {
        "X1": f"at n = 5 {share} of the simulation's S: the turnaround is "
        "paid at the opening, the reservation and every turn",
        "X2": f"{share} of the simulation's S at n = 5: packets hold "
        "their switching, the CR-Rs of a resolution pay theirs; of T only 3 slots in 25 are data, "
        f"S of data {3 / 25 * found[-1]:.3f}",
        "X3": f"not similar: {share} of the simulation's S at n = 5, and "
        "T_D shorter, as packets are",
    }
    return Claim(
        "12",
        f"{reading.name} ({reading.words}): results are similar to the simulation (S above half of "
        "it, rising, T_D less than twice), but poorer",
        f"n = 2..5: S {joined(f'{s:.3f}' for s in found)} against "
        f"{joined(f'{s:.3f}' for s in plain)} of the simulation; T_D "
        f"{joined(f'{t:.0f}' for t in longer)} against {joined(f'{t:.0f}' for t in shorter)} "
        f"slots, {100 * (longer[-1] / shorter[-1] - 1):+.0f} % at n = 5",
        verdict(is_similar_but_poorer(found, plain, longer, shorter), "Q16"),
        reasons[reading.name] + ". The figure's image is not available to compare with",
    )


def _ahead(got: Measured) -> Claim:
    words, ahead = [], True
    for reading in READINGS:
        ours, d2, d2p = (
            float(curve(mac, reading, "saturated", got.quick).mean(got)[-1]) for mac in MACS
        )
        words.append(f"{reading.name} {ours:.3f} against {d2:.3f}, {d2p:.3f}")
        ahead = ahead and ours > d2p
    return Claim(
        "12",
        "five robots: CSMA/CD-R is ahead of CSMA/CD without capture (D2') in every reading",
        f"S, CSMA/CD-R against D2, D2': {joined(words, '; ')}",
        verdict(ahead, "Q14", "Q16"),
        "slotted level, the order after a collision given",
    )


def _medium(got: Measured) -> Claim:
    words, ours = [], 0
    for reading in READINGS:
        paper, practical = (
            got[event(reading, 5, got.quick, mode)] for mode in ("paper", "practical")
        )
        lost = sum(paper["silent"]) / sum(paper["completed"])
        ours += sum(practical["silent"])
        words.append(
            f"{reading.name} {np.mean(practical['throughput']):.3f} (practical), as "
            f"published {percent(lost)} of the packets lost silently"
        )
    return beyond(
        "five robots on the event level: the practical mode loses nothing in any reading",
        f"S, n = 5, saturation: {joined(words, '; ')}",
        verdict(ours == 0),
        "F2: what the experiment did against unnoticed collisions the text does not say",
    )
