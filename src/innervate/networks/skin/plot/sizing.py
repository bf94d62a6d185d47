"""The picture of `innervate size`: loss and recovery over ports, and where the ports go."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from innervate.kernel.words import number_of
from innervate.plot import style

if TYPE_CHECKING:
    from innervate.networks.skin.sizing import Answer

Columns = Mapping[str, Sequence[Any]]
AXES = "xyz"
SLANT = 0.3
MEANS = "mean, 95 % interval"


def write(answer: Answer, folder: Path) -> Path:
    """The picture in a folder, with the ports that the hardest rate needs; the file comes back."""
    asked = answer.question
    ports = max(n or max(answer.graphs) for n in answer.needed.values())
    graph = answer.graphs[ports]
    columns = answer.table.to_dict(as_series=False)
    limits = (asked.loss_max, asked.recovery_ms_max)
    with style.house():
        title = f"{graph.cells} cells, {number_of(ports, 'port')}"
        what = "one run" if answer.is_single else MEANS
        return style.save(draw(columns, graph, limits, title, what), folder, "size")[0]


def draw(
    columns: Columns, graph: Any, limits: tuple[float, float], title: str, what: str = MEANS
) -> Figure:
    """Loss and recovery of the answer's table, and a map of the graph of one number of ports.

    `limits` are the share lost and the ms that are allowed; `what` the curves are.
    """
    with style.house():
        made, (loss, back, cells) = style.panels(style.WIDE_IN, 2.6, 1, 3)
        _curves(loss, columns, "loss_cell", 100.0, limits[0])
        loss.set_ylabel(f"lost on the way (%)\n{what}")
        _curves(back, columns, "recovery_ms_cell", 1.0, limits[1])
        back.set_ylabel(f"recovery from a cut cable (ms)\n{what}")
        _map(cells, graph)
        cells.set_title(title)
        return made


def _curves(ax: Axes, columns: Columns, name: str, scale: float, limit: float) -> None:
    """A line over ports for every rate, the limit dashed."""
    rates = list(dict.fromkeys(columns["rate_hz"]))
    parts = [columns[f"{name}_{part}"] for part in ("mean", "low", "high")]
    for i, rate in enumerate(rates):
        some = zip(columns["ports"], columns["rate_hz"], *parts, strict=True)
        rows = [(ports, *(scale * value for value in values))
                for ports, of, *values in some if of == rate and None not in values]  # fmt: skip
        if not rows:
            continue
        ports, mean, low, high = zip(*rows, strict=True)
        color = style.SERIES[i % len(style.SERIES)]
        marker = style.MARKERS[i % len(style.MARKERS)]
        ax.plot(ports, mean, color=color, marker=marker, label=f"{rate:g} Hz")
        ax.fill_between(ports, low, high, color=color, alpha=0.18, lw=0)
    ax.axhline(scale * limit, color=style.INK, lw=0.9, ls="--")
    ax.set_xticks(sorted(set(columns["ports"])))
    ax.set(ylim=(0, None), xlabel="interface ports (dashed: limit)")
    if len(rates) > 1:
        ax.legend()


def _map(ax: Axes, graph: Any) -> None:
    """Cells and cables from where they differ least, a little from the side; ports numbered."""
    places = np.frombuffer(graph.positions, np.float64).reshape(-1, 3)
    spread = np.ptp(places, axis=0)
    along = int(np.argmin(spread))
    across, up = (i for i in range(3) if i != along)
    if spread[across] < spread[up] and up != 2:
        across, up = up, across
    # Two sheets of cells that lie one behind the other would cover each other.
    flat = places[:, (across, up)] + SLANT * places[:, [along]]
    for cell in range(graph.cells):
        for other in graph.neighbours(cell):
            if cell < other < graph.cells:
                ax.plot(*flat[[cell, other]].T, color=style.FAINT, lw=0.7, zorder=1)
    ax.plot(*flat.T, ls="", marker="o", ms=2.2, color=style.SOFT, zorder=2)
    for port, cell in enumerate(graph.neighbours(graph.sink)):
        ax.plot(*flat[cell], marker="s", ms=7, color=style.VERMILION, zorder=3)
        look: dict[str, Any] = {"ha": "center", "va": "center", "color": "#ffffff", "zorder": 4}
        ax.annotate(str(port), flat[cell], fontsize=5.5, **look)
    ax.set_aspect("equal", adjustable="datalim")
    ax.grid(visible=False)
    ax.set(xlabel=f"{AXES[across]} (mm), slanted by {AXES[along]}", ylabel=f"{AXES[up]} (mm)")
