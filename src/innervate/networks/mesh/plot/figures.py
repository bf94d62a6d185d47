"""Figures of a mesh run, for `Run.plot`: field, latency, delivery, alarms."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Polygon

from innervate.networks.mesh.analysis.alarms import all_crossings
from innervate.networks.mesh.analysis.fence import position_cm
from innervate.networks.mesh.analysis.messages import (
    DELIVERED,
    NEVER,
    counted,
    latencies_us,
    messages,
)
from innervate.networks.mesh.analysis.paths import Ground
from innervate.networks.mesh.plot.map import monitor_of
from innervate.networks.mesh.plot.sheet import laid_out
from innervate.plot import style

BINS = 40


def draw(run: Any, figure: str = "field", **options: Any) -> Figure:
    """One of FIGURES of a run (anything with a `result`); save it with `.savefig`.

    Raises:
        ValueError: no figure of that name.
    """
    if figure not in FIGURES:
        raise ValueError(f'no figure "{figure}"; there are {", ".join(FIGURES)}')
    with style.house():
        return FIGURES[figure](run.result, **options)


def field(result: Any) -> Figure:
    """Nodes, good links, fence and robots, and who was off at the end."""
    plan = result.plan
    true = len(plan.positions_cm) == plan.nodes
    places = np.array(plan.positions_cm if true else laid_out(plan), np.float64) / 100
    made, (ax,) = style.panels(style.COLUMN_IN, 3.4)
    for a, b in plan.good:
        ax.plot(*places[[a, b]].T, color=style.FAINT, lw=0.6, zorder=1)
    for ring in _rings(plan) if true else ():
        ax.add_patch(Polygon(ring, fill=False, edgecolor=style.INK, lw=1.0))
    for walk in plan.walks if true else ():
        ax.plot(*(np.array([p[1:] for p in walk.points]) / 100).T, color=style.BLUE, ls=":", lw=1)
    on = np.array(Ground(plan).on_at(result.ended_us), np.bool_)
    ax.plot(*places[on].T, ls="none", marker="o", color=style.SKY, ms=4, zorder=3)
    ax.plot(*places[~on].T, ls="none", marker="x", color=style.VERMILION, ms=4, zorder=3,
            label="off")  # fmt: skip
    for node, marker, name in (
        (plan.ranks.index(0), "s", "gateway"), (monitor_of(plan), "o", "monitor"),
    ):  # fmt: skip
        fill = style.INK if name == "gateway" else "none"
        ax.plot(*places[[node]].T, ls="none", marker=marker, ms=7, mfc=fill, mec=style.INK,
                label=name, zorder=2)  # fmt: skip
    walks = {walk.node: walk for walk in plan.walks}
    for crossing in all_crossings(result) if true else ():
        x, y = position_cm(walks[crossing.robot], crossing.crossed_us)
        ax.plot([x / 100], [y / 100], marker="v", color=style.VERMILION, ms=5, zorder=4)
    ax.set_aspect("equal")
    ax.legend(loc="lower left", bbox_to_anchor=(0, 1), ncols=3)
    ax.set_xlabel("m" if true else "")
    if not true:
        ax.set_xticks([])
        ax.set_yticks([])
    return made


def _rings(plan: Any) -> list[Any]:
    """Corners of the fence's rings, m."""
    params, rings, seen = plan.params, [], set()
    for first in range(params["points"]):
        ring, i = [], first
        while i not in seen:
            seen.add(i)
            ring.append([
                (plan.origin_cm[axis] + params["unit_cm"] * params[name][i]) / 100
                for axis, name in enumerate(("px", "py"))
            ])  # fmt: skip
            i = params["after"][i]
        if ring:
            rings.append(ring)
    return rings


def latency(result: Any) -> Figure:
    """Share of the messages delivered within a time."""
    found = np.sort(latencies_us(messages(result))) / 1e3
    made, (ax,) = style.panels(style.COLUMN_IN, 2.2)
    if len(found):
        shares = 100.0 * np.arange(len(found) + 1) / len(found)
        ax.step(np.append(0.0, found), shares, where="post", color=style.BLUE)
        for share, dash in ((50, "-"), (99, ":")):
            at = float(np.percentile(found, share))
            ax.axvline(at, color=style.INK, lw=0.8, ls=dash, label=f"{share} %: {at:.3g} ms")
        ax.set_xlim(0, 1.04 * float(found[-1]))
        ax.legend(loc="best")
    ax.set_ylim(0, 104)
    ax.set_xlabel("from offer to delivery (ms)")
    ax.set_ylabel("messages delivered (%)")
    return made


def delivery(result: Any, bins: int = BINS) -> Figure:
    """Share of the messages offered in each part of the run that were delivered."""
    found = counted(messages(result))
    made, (ax,) = style.panels(style.COLUMN_IN, 2.2)
    if len(found.state):
        at = found.offered_us / 1e6
        asked, edges = np.histogram(at, bins)
        came, _ = np.histogram(at[found.state == DELIVERED], edges)
        some = asked > 0
        ax.step(edges[:-1][some], 100.0 * came[some] / asked[some], where="post", color=style.BLUE)
        for fault in result.plan.faults:
            ax.axvline(fault.at_us / 1e6, color=style.VERMILION, lw=0.8, ls=":")
    ax.set_ylim(0, 104)
    ax.set_xlabel("time (s)")
    ax.set_ylabel("messages delivered (%)")
    return made


def alarms(result: Any) -> Figure:
    """Each crossing: when the monitor knew, and how far the robot was out by then."""
    found = [crossing for crossing in all_crossings(result) if crossing.accepted_us != NEVER]
    made, (ax,) = style.panels(style.COLUMN_IN, 2.2)
    for flooded, marker, colour in ((False, "o", style.BLUE), (True, "^", style.ORANGE)):
        part = [crossing for crossing in found if crossing.flooded == flooded]
        if part:
            waits = [(crossing.accepted_us - crossing.raised_us) / 1e3 for crossing in part]
            ax.plot(waits, [crossing.overrun_m for crossing in part], ls="none", marker=marker,
                    color=colour, label="flooded" if flooded else "routed")  # fmt: skip
    if found:
        ax.legend(loc="best")
    ax.set_xlim(left=0)
    ax.set_ylim(bottom=0)
    ax.set_xlabel("from the alarm to the monitor (ms)")
    ax.set_ylabel("farthest outside (m)")
    return made


FIGURES: dict[str, Callable[..., Figure]] = {
    "field": field,
    "latency": latency,
    "delivery": delivery,
    "alarms": alarms,
}
