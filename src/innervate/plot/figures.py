"""Figures of a run of any network, for `Run.plot`: delivered, latency."""

from collections.abc import Callable, Mapping
from textwrap import wrap
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from innervate.analysis.summary import known_latencies_us
from innervate.network import networks
from innervate.plot import charts, paint, style
from innervate.plot.svg import Drawing


def draw(run: Any, figure: str = "", **options: Any) -> Figure:
    """A figure of a run by its name, or the first, in the house's style; save it with `.savefig`.

    Raises:
        ValueError: no figure of that name.
    """
    figures: Mapping[str, Callable[..., Figure]] = networks()[run.result.plan.kind].figures
    figure = figure or next(iter(figures))
    if figure not in figures:
        raise ValueError(f'no figure "{figure}"; there are {", ".join(figures)}')
    with style.house():
        return figures[figure](run, **options)


def chart(one: charts.Steps | charts.Bars | None, lacking: str = "") -> Figure:
    """What a report shows, as a figure; of None one that says what is `lacking`."""
    if one is None:
        return nothing(lacking)
    return paint.figure(captioned(one.drawing, one.text), one.head, style.COLUMN_IN)


def captioned(drawing: Drawing, text: str) -> Drawing:
    """A drawing with words below it, in lines as wide as it is."""
    lines = wrap(text, int(drawing.width / charts.LETTER))
    made = Drawing(drawing.width, drawing.height + charts.LABEL_ROW * len(lines), drawing.label)
    made.place(drawing, (0.0, 0.0))
    for i, line in enumerate(lines):
        made.text((0.0, drawing.height + charts.LABEL_ROW * (i + 0.75)), line)
    return made


def nothing(why: str) -> Figure:
    """A figure of nothing, which says so."""
    made, (ax,) = style.panels(style.COLUMN_IN, 1.0)
    ax.axis("off")
    ax.text(0.5, 0.5, why, ha="center", va="center", transform=ax.transAxes)
    return made


def delivered(run: Any) -> Figure:
    """Messages delivered, and reports of nodes, so far, over time."""
    result = run.result
    made, (ax,) = style.panels(style.COLUMN_IN, 2.2)
    for name, label in (("deliveries", "messages delivered"), ("rows", "reports")):
        if name in result.rows:
            times = np.sort(result.rows[name]["time"]) / 1e6
            ax.step(np.append(times, result.ended_us / 1e6),
                    np.append(np.arange(1, len(times) + 1), len(times)), where="post",
                    lw=1, label=label)  # fmt: skip
    ax.set(xlim=(0, result.ended_us / 1e6), xlabel="time (s)", ylabel="so far")
    ax.legend()
    return made


def latency(run: Any) -> Figure:
    """Share of the messages that were delivered within a time."""
    known = np.sort(known_latencies_us(run.result.rows.get("deliveries"))) / 1e3
    if not len(known):
        return nothing("no message whose latency is known")
    made, (ax,) = style.panels(style.COLUMN_IN, 2.2)
    ax.step(known, np.arange(1, len(known) + 1) / len(known), where="post", lw=1)
    ax.set(xlabel="latency (ms)", ylabel="share delivered", ylim=(0, 1.02))
    return made


FIGURES: dict[str, Callable[..., Figure]] = {"delivered": delivered, "latency": latency}
