"""The drawings of `practical` and `turnaround`: S and T_D of the practical mode over n."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

from innervate.networks.radio.papers.common import LOOKS, RESERVED, Look, line, slope, stations_axis
from innervate.networks.radio.papers.labels import end_labels
from innervate.networks.radio.papers.practice import (
    RETURNS,
    WITH_RETURN,
    Setting,
    bound,
    duration,
    ns,
    readings,
    reserved,
    rival,
    throughput,
)
from innervate.papers.experiment import Results
from innervate.plot import style


def saturated(
    ax: Axes, results: Results, setting: Setting, size: int, quick: bool,
    more: tuple[Setting, ...] = (),
) -> None:  # fmt: skip
    """Throughput S over the number of stations, all of them always with packets."""
    places = ns(quick)
    stations_axis(ax)
    ax.set_xlim(1.9, 105)
    ax.set_ylim(0, 1.0)
    ends = []

    def show(look: Look, values: np.ndarray) -> None:
        line(ax, look, places, values, marks=(2, 3, 4, 5, 10, 20, 50, 100))
        ends.append((float(values[-1]), look.name, look.colour))

    for mac in WITH_RETURN:
        for back in reversed(readings(setting)):
            look = LOOKS[mac]._replace(name=LOOKS[mac].name + RETURNS[back][0])
            if back:
                look = look._replace(dash=style.DASHES[2])
            show(look, rival(results, setting, mac, size, quick, back))
    plain = reserved(setting, size, "saturated", quick).mean(results, "throughput")
    show(LOOKS[RESERVED]._replace(name="CSMA/CD-R slotted"), plain)
    looks = (("practical mode", style.BLACK, "X"), ("4 packets a turn", style.PURPLE, "P"))
    for one, (name, colour, marker) in zip((setting, *more), looks, strict=False):
        show(Look(name, colour, "-", marker), throughput(results, one, size, quick))
        limit = bound(one, size)
        ax.axhline(limit, color=colour, lw=0.8, ls=":")
        ends.append((limit, f"its bound {limit:.3f}", colour))
    end_labels(ax, ends)


def disaster(ax: Axes, results: Results, setting: Setting, size: int, quick: bool) -> None:
    """T_D over n with the fitted line."""
    places = np.array(ns(quick))
    ours = duration(results, setting, size, quick)
    rise, start, fit = slope(places, ours)
    for mac in WITH_RETURN:
        values = np.min(
            [rival(results, setting, mac, size, quick, b, "disaster") for b in readings(setting)],
            axis=0,
        )
        look = LOOKS[mac]
        ax.plot(places, values, color=look.colour, ls=look.dash, marker=look.marker,
                label=look.name)  # fmt: skip
    plain = reserved(setting, size, "disaster", quick).mean(results, "duration")
    look = LOOKS[RESERVED]
    ax.plot(places, plain, color=look.colour, marker=look.marker, label="CSMA/CD-R slotted")
    ax.plot(places, ours, "X", color=style.BLACK, ms=4, label="practical mode")
    ax.plot(places, start + rise * places, color=style.BLACK, lw=0.8, ls="--",
            label=f"{start:.0f} + {rise:.1f} n\n$R^2$ = {fit:.4f}")  # fmt: skip
    ax.set_ylim(0, 1.75 * float(ours[-1]))
    ax.set_xlim(0, 105)
    ax.set_xlabel("stations n")
    ax.legend(loc="upper left", bbox_to_anchor=(1.02, 1))
