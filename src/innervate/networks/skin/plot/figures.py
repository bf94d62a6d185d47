"""Figures of one run, for `Run.plot`: recovery, routes, loads, received."""

from collections.abc import Callable
from typing import Any

from matplotlib.figure import Figure

from innervate.networks.skin.analysis.touch import WINDOW_S
from innervate.networks.skin.plot import map as skinmap
from innervate.networks.skin.plot.digest import Digest
from innervate.networks.skin.plot.report import legend, touch_legend
from innervate.networks.skin.plot.words import fault_words
from innervate.plot import paint, style
from innervate.plot.charts import Axis, Mark, Steps
from innervate.plot.figures import chart

NAMED_MAX = 12  # of the marked events; each takes a row above the curve


def recovery(run: Any, from_s: float | None = None, to_s: float | None = None) -> Figure:
    """Cells that are on and have no way to the PC over time, and the scenario's events.

    Without a time span it shows what happened round the events, else the whole run.
    """
    history = Digest(run.result, run.summary).history
    times, cells = history.steps()
    first, last = _span(run, from_s, to_s)
    inside = cells[(times >= 1e6 * first) & (times <= 1e6 * last)]
    top = 1.25 * max(1, int(inside.max(initial=0)))
    faults = [fault for fault in run.plan.faults if first <= fault.at_us / 1e6 <= last]
    named = len(faults) <= NAMED_MAX
    marks = [
        Mark(fault.at_us / 1e6, fault_words(run.plan.graph, fault) if named else "")
        for fault in faults
    ]
    x, y = Axis(first, last, "time (s)"), Axis(0.0, top)
    return chart(Steps(times / 1e6, cells, x, y, "cells without a way to the PC", "", marks))


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


def routes(run: Any, time_s: float | None = None) -> Figure:
    """Who sends through whom at a time (default: the end), as on maps of reports."""
    at_us = run.result.ended_us if time_s is None else round(1e6 * time_s)
    digest, title = Digest(run.result, run.summary), f"routes at {at_us / 1e6:.3f} s"
    drawing = skinmap.route_map(digest.sheet, digest.history.at(at_us), title, tips=False)
    return paint.figure(paint.keyed(drawing, legend(digest)), title, style.COLUMN_IN)


def loads(run: Any) -> Figure:
    """Cells that each interface port serves at the end, against the even split."""
    return chart(Digest(run.result, run.summary).loads(), "there is no interface port")


def received(run: Any, time_s: float | None = None, window_s: float = WINDOW_S) -> Figure:
    """The force the PC knew of at a time; hollow: no sample in the window before."""
    at_us = run.result.ended_us if time_s is None else round(1e6 * time_s)
    digest = Digest(run.result, run.summary)
    panel = digest.image(at_us, round(1e6 * window_s), "")
    title = f"force known at {at_us / 1e6:.3f} s; {panel.text}"
    drawing = paint.keyed(panel.drawing, touch_legend(digest))
    return paint.figure(drawing, title, style.COLUMN_IN)


FIGURES: dict[str, Callable[..., Figure]] = {
    "recovery": recovery, "routes": routes, "loads": loads, "received": received,
}  # fmt: skip
