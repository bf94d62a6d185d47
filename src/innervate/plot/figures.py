"""Figures of a run of any network, for `Run.plot`: delivered, latency."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from textwrap import wrap
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from innervate.analysis.summary import known_latencies_us
from innervate.plot import charts, style

MARKS_MAX = 12
LETTERS = 62  # in a column


def draw(run: Any, figure: str = "delivered", **options: Any) -> Figure:
    """One of FIGURES of a run; save it with `.savefig`.

    Raises:
        ValueError: no figure of that name.
    """
    return draw_one(FIGURES, run, figure, options)


def draw_one(
    figures: Mapping[str, Callable[..., Figure]], run: Any, figure: str, options: dict[str, Any]
) -> Figure:
    """The figure of that name, in the house's style.

    Raises:
        ValueError: no figure of that name.
    """
    if figure not in figures:
        raise ValueError(f'no figure "{figure}"; there are {", ".join(figures)}')
    with style.house():
        return figures[figure](run, **options)


def chart(one: charts.Steps | charts.Bars | None) -> Figure:
    """What a report shows as a drawing; None if there is nothing to be shown."""
    made, (ax,) = style.panels(style.COLUMN_IN, 2.2)
    if isinstance(one, charts.Bars):
        _bars(ax, one)
    elif one is not None:
        _steps(ax, one)
    ax.set_title("nothing to show" if one is None else one.head)
    return made


def _steps(ax: Axes, shown: charts.Steps) -> None:
    at = np.append(shown.times, shown.x.high)
    values = np.append(shown.values, shown.values[-1:] if len(shown.values) else [0])
    ax.fill_between(at, 0, values, step="post", color=style.BLUE, alpha=0.18, lw=0)
    ax.step(at, values, where="post", color=style.BLUE, lw=1)
    for i, mark in enumerate(shown.marks):
        ax.axvline(mark.at, color=style.INK, lw=0.8, ls="--")
        if len(shown.marks) <= MARKS_MAX:
            right = mark.at > (shown.x.low + shown.x.high) / 2
            ax.text(
                mark.at, 0.99 - 0.08 * (i % 3), f" {mark.label} ", ha="right" if right else "left",
                va="top", transform=ax.get_xaxis_transform(), fontsize=6.5,
            )  # fmt: skip
    ax.set_xlim(shown.x.low, shown.x.high)
    ax.set_ylim(shown.y.low, shown.y.high)
    _caption(ax, shown.x.name, shown.text)


def _bars(ax: Axes, shown: charts.Bars) -> None:
    places = range(len(shown.bars))
    ax.bar(places, [bar.value for bar in shown.bars], 0.7, color=style.BLUE, alpha=0.5)
    if shown.even is not None:
        ax.axhline(shown.even, color=style.INK, lw=0.9, ls="--")
    even = "" if shown.even is None else f"dashed: even share, {shown.even:.4g}"
    _caption(ax, even, shown.text)
    if len(places) <= MARKS_MAX:
        ax.set_xticks(places, [bar.name for bar in shown.bars], rotation=30, ha="right")
    ax.grid(axis="x", visible=False)


def _caption(ax: Axes, name: str, text: str) -> None:
    """What the axis below is called, and the words of a chart."""
    ax.set_xlabel("\n".join(line for line in (name, *wrap(text, LETTERS)) if line))


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
    ax.set_xlim(0, result.ended_us / 1e6)
    ax.set_xlabel("time (s)")
    ax.set_ylabel("so far")
    ax.legend()
    return made


def latency(run: Any) -> Figure:
    """Share of the messages that were delivered within a time."""
    made, (ax,) = style.panels(style.COLUMN_IN, 2.2)
    some = run.result.rows.get("deliveries")
    known = np.sort(known_latencies_us(some)) / 1e3
    ax.step(known, np.arange(1, len(known) + 1) / max(1, len(known)), where="post", lw=1)
    ax.set_xlabel("latency (ms)")
    ax.set_ylabel("share delivered")
    ax.set_ylim(0, 1.02)
    return made


FIGURES: dict[str, Callable[..., Figure]] = {"delivered": delivered, "latency": latency}
