"""Figures of a mesh run, for `Run.plot`: field, latency, delivery, alarms."""

from collections.abc import Callable
from typing import Any

from matplotlib.figure import Figure

from innervate.networks.mesh.analysis.alarms import all_crossings
from innervate.networks.mesh.analysis.messages import NEVER
from innervate.networks.mesh.plot import charts
from innervate.networks.mesh.plot import map as mesh_map
from innervate.networks.mesh.plot.sheet import Sheet
from innervate.plot import paint, style
from innervate.plot.figures import chart, nothing


def field(run: Any) -> Figure:
    """Nodes, good links, fence and robots, crossings, and who was off at the end."""
    crossings = all_crossings(run.result)
    drawing = mesh_map.field_map(run.result, Sheet(run.result.plan), "The field", crossings)
    return paint.figure(paint.keyed(drawing, mesh_map.legend(run.result, crossings, ())))


def latency(run: Any) -> Figure:
    """Share of the messages delivered within a time."""
    return chart(charts.latency(run.result, run.summary), "no message was delivered")


def delivery(run: Any, bins: int = charts.BINS) -> Figure:
    """Share of the messages offered in each part of the run that were delivered."""
    return chart(charts.over_time(run.result, bins), "no message was offered")


def alarms(run: Any) -> Figure:
    """Each crossing: when the monitor knew, and how far the robot was out by then."""
    crossings = all_crossings(run.result)
    found = [crossing for crossing in crossings if crossing.accepted_us != NEVER]
    if not found:
        return nothing("no alarm reached the monitor" if crossings else "no fence was crossed")
    made, (ax,) = style.panels(style.COLUMN_IN, 2.2)
    for flooded, marker, colour in ((False, "o", style.BLUE), (True, "^", style.ORANGE)):
        part = [crossing for crossing in found if crossing.flooded == flooded]
        if part:
            waits = [(crossing.accepted_us - crossing.raised_us) / 1e3 for crossing in part]
            ax.plot(waits, [crossing.overrun_m for crossing in part], ls="none", marker=marker,
                    color=colour, label="flooded" if flooded else "routed")  # fmt: skip
    ax.legend(loc="best")
    ax.set(xlim=(0, None), ylim=(0, None), xlabel="from the alarm to the monitor (ms)",
           ylabel="farthest outside (m)")  # fmt: skip
    return made


FIGURES: dict[str, Callable[..., Figure]] = {
    "field": field, "latency": latency, "delivery": delivery, "alarms": alarms,
}  # fmt: skip
