"""The comparison as a book: a figure, tables and claims for every job that a network sets."""

from functools import partial
from textwrap import fill
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from innervate.analysis.intervals import median_interval
from innervate.papers import drawing
from innervate.papers.experiment import Experiment, Sheet
from innervate.papers.jobs import Case, Compared, doing, entries, jobs, points
from innervate.plot import style

TITLE = "The networks beside protocols of the field"
AUTHORS = "Equal links, faults and seeds"
READINGS: dict[str, str] = {}
COLUMNS = 3  # panels in a row
TITLE_LETTERS = 34  # in a line of a panel's title


def __getattr__(name: str) -> Any:
    """FIGURES: the jobs, which networks set."""
    if name == "FIGURES":
        return tuple(jobs())
    raise AttributeError(name)


def warm_up() -> None:
    """Nothing: every job compiles what its entries run."""


def experiment(name: str) -> Experiment:
    """A job as figure, tables and claims."""
    job = jobs()[name]
    legend = Sheet(
        "Who is compared", ("who", "what it is"), [(one.name, one.what) for one in entries(name)]
    )

    def compiled() -> None:
        for once in dict.fromkeys(entry.warm_up for entry in entries(name)):
            once()

    return Experiment(
        name, job.title, job.caption, partial(points, job),
        draw=lambda got: picture(Compared(job, got)),
        judge=lambda got: job.judge(Compared(job, got)),
        sheets=lambda got: [legend, *Compared(job, got).sheets()],
        warm_up=compiled,
    )  # fmt: skip


def picture(compared: Compared) -> Figure:
    """Every run as a dot, medians and their intervals, a panel a case."""
    name, axis = compared.job.drawn
    cases = [case for case in compared.cases() if name in {one.name for one in case.columns}]
    rows = -(-len(cases) // COLUMNS)
    most = max(len(doing(compared.job, case)) for case in cases)
    height = rows * (0.75 + 0.17 * most) + 0.4
    figure, axes = style.panels(style.WIDE_IN, height, rows, COLUMNS, sharex=True)
    for place, case in enumerate(cases):
        _panel(axes[place], compared, case, name)
        first = cases[place - place % COLUMNS]
        if place % COLUMNS and doing(compared.job, case) == doing(compared.job, first):
            axes[place].set_yticklabels([])
    for ax in axes[len(cases) :]:
        ax.set_axis_off()
    for ax in axes[max(len(cases) - COLUMNS, 0) : len(cases)]:  # the lowest of each column
        ax.set_xlabel(axis)
        ax.tick_params(labelbottom=True)
    return figure


def _panel(ax: Axes, compared: Compared, case: Case, name: str) -> None:
    rng = np.random.default_rng(1)
    who = doing(compared.job, case)
    for place, entry in enumerate(who):
        values = compared.values(case, entry, name)
        colour = style.SERIES[place % len(style.SERIES)]
        finite = np.array([value for value in values if np.isfinite(value)])
        at = place + rng.uniform(-0.22, 0.22, len(finite))
        ax.plot(finite, at, ".", color=colour, ms=2, mew=0, alpha=0.5)
        found = median_interval(values)
        if np.isfinite(found.value):
            ax.plot([found.low, found.high], [place, place], color=style.INK, lw=1.6)
            ax.plot([found.value], [place], "|", color=style.INK, ms=7, mew=1.4)
    ax.set_xscale("symlog", linthresh=1.0)
    drawing.rows(ax, [entry.name for entry in who])
    ax.xaxis.set_major_formatter("{x:g}")
    ax.set_title(fill(case.title, TITLE_LETTERS), fontsize=7)
