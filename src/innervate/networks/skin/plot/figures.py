"""Figures of one run, for `Run.plot`: recovery, routes, loads, received."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from innervate.networks.skin.analysis.load import port_loads
from innervate.networks.skin.analysis.touch import WINDOW_S, received_image
from innervate.networks.skin.plot.axes import SkinAxes, port_fills
from innervate.networks.skin.plot.history import History, Moment
from innervate.networks.skin.plot.words import fault_words
from innervate.networks.skin.protocol.constants import PORTS
from innervate.plot import style
from innervate.topology import Graph

MARKS_MAX = 12


def draw(run: Any, figure: str = "recovery", **options: Any) -> Figure:
    """One of FIGURES of a run, with its options; save it with `.savefig`.

    Raises:
        ValueError: no figure of that name.
    """
    if figure not in FIGURES:
        raise ValueError(f'no figure "{figure}"; there are {", ".join(FIGURES)}')
    with style.house():
        return FIGURES[figure](run, **options)


def recovery(run: Any, from_s: float | None = None, to_s: float | None = None) -> Figure:
    """Cells that are on and have no way to the PC over time, and the scenario's events.

    Without a time span it shows what happened round the events, else the whole run.
    """
    history = History(run.result)
    times, cells = history.steps()
    first, last = _span(run, from_s, to_s)
    made, (ax,) = style.panels(style.COLUMN_IN, 2.2)
    x = np.append(times, run.result.ended_us) / 1e6
    y = np.append(cells, cells[-1] if len(cells) else 0)
    ax.fill_between(x, 0, y, step="post", color=style.ORANGE, alpha=0.35, lw=0)
    ax.step(x, y, where="post", color=style.VERMILION, lw=1)
    inside = y[(x >= first) & (x <= last)]
    top = max(1, int(inside.max())) if len(inside) else 1
    ax.set_ylim(0, 1.25 * top)
    _events(ax, run, first, last)
    ax.set_xlim(first, last)
    ax.set_xlabel("time (s)")
    ax.set_ylabel("cells without a route")
    return made


def _span(run: Any, from_s: float | None, to_s: float | None) -> tuple[float, float]:
    """The times asked for; else 20 % before the first event to twice the last routed time."""
    end_s = run.result.ended_us / 1e6
    found = run.summary["recoveries"]
    low, high = 0.0, end_s
    if found:
        waits = [one["others_ms"] or one["converged_ms"] or 0.0 for one in found]
        settled = max(one["at_s"] + wait / 1e3 for one, wait in zip(found, waits, strict=True))
        length = max(settled - found[0]["at_s"], 1e-3)
        low, high = found[0]["at_s"] - 0.3 * length, settled + 0.5 * length
    low = low if from_s is None else from_s
    high = high if to_s is None else to_s
    return max(0.0, low), min(end_s, max(high, low + 1e-6))


def _events(ax: Axes, run: Any, first: float, last: float) -> None:
    faults = [f for f in run.plan.faults if first <= f.at_us / 1e6 <= last]
    for i, fault in enumerate(faults):
        at = fault.at_us / 1e6
        ax.axvline(at, color=style.INK, lw=0.8, ls="--")
        if len(faults) <= MARKS_MAX:
            right = at > first + 0.5 * (last - first)
            ax.text(
                at, 0.99 - 0.08 * (i % 3), f" {fault_words(run.plan.graph, fault)} ",
                transform=ax.get_xaxis_transform(), ha="right" if right else "left", va="top",
                fontsize=6.5,
            )  # fmt: skip


def routes(run: Any, time_s: float | None = None) -> Figure:
    """Who sends through whom at a time (default: the end), coloured by interface port."""
    graph = run.plan.graph
    at_us = run.result.ended_us if time_s is None else round(1e6 * time_s)
    moment = History(run.result).at(at_us)
    made, (ax,) = style.panels(style.COLUMN_IN, 3.6)
    skin = SkinAxes(ax, graph)
    skin.cells(port_fills(moment.server))
    skin.tree(moment.hop)
    skin.ports(cut=_cut_ports(moment, graph))
    ax.set_title(f"routes at {at_us / 1e6:.3f} s")
    return made


def _cut_ports(moment: Moment, graph: Graph) -> list[int]:
    """Interface ports whose cable is down."""
    first = PORTS * graph.cells
    ends = [end for low in moment.down for end in (low, graph.peer[low])]
    return [end - first for end in ends if end >= first]


def loads(run: Any) -> Figure:
    """Cells that each interface port serves at the end, against the even split."""
    found = port_loads(run.result)
    made, (ax,) = style.panels(style.COLUMN_IN, 2.2)
    ax.bar(range(len(found)), found, 0.7, color=style.BLUE, alpha=0.5)
    even = sum(found) / max(1, len(found))
    ax.axhline(even, color=style.INK, lw=0.9, ls="--")
    ax.set_title(f"dashed: even split, {even:.1f} cells")
    if len(found) <= MARKS_MAX:
        ax.set_xticks(range(len(found)))
    ax.grid(axis="x", visible=False)
    ax.set_xlabel("interface port")
    ax.set_ylabel("cells served")
    return made


def received(run: Any, time_s: float | None = None, window_s: float = WINDOW_S) -> Figure:
    """The force the PC knew of at a time; hollow: no sample in the window before."""
    at_s = run.result.ended_us / 1e6 if time_s is None else time_s
    image = received_image(run, at_s, window_s)
    made, (ax,) = style.panels(style.COLUMN_IN, 3.6)
    skin = SkinAxes(ax, run.plan.graph)
    most = max(1, int(image.force_mn.max()))
    fills = [
        _heat(force / most) if known else "#ffffff"
        for force, known in zip(image.force_mn, image.known, strict=True)
    ]
    skin.cells(fills)
    moment = History(run.result).at(round(1e6 * at_s))
    skin.ports(cut=_cut_ports(moment, run.plan.graph))
    ax.set_title(f"force known at {at_s:.3f} s, darkest {most / 1000:.2f} N")
    return made


def _heat(share: float) -> tuple[float, float, float]:
    """Red, green and blue, 0 to 1, from nearly white at 0 to dark vermilion at 1."""
    pale, dark = np.array([0.965, 0.953, 0.933]), np.array([0.702, 0.290, 0.031])
    red, green, blue = pale + float(share) * (dark - pale)
    return float(red), float(green), float(blue)


FIGURES: dict[str, Callable[..., Figure]] = {
    "recovery": recovery,
    "routes": routes,
    "loads": loads,
    "received": received,
}
