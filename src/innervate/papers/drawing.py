"""What figures are drawn with: logarithmic axes, rows, shares, legends outside, names of curves."""

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

HOLLOW: dict[str, Any] = {"ls": "", "mfc": "white"}  # markers of what is less than it should be


def legend(
    figure: Figure, of: Axes | Iterable[Axes], place: str = "lower left", **how: Any
) -> None:
    """The legend of all series of some axes, outside of them; each name stands once."""
    found: dict[str, Any] = {}
    for ax in [of] if isinstance(of, Axes) else of:
        handles, names = ax.get_legend_handles_labels()
        found.update(zip(names, handles, strict=True))
    how["loc"] = f"outside {place}"
    figure.legend(list(found.values()), list(found), **how)


def logarithmic(ax: Axes, x: Sequence[float] = (), y: Sequence[float] = ()) -> None:
    """Logarithmic axes with these numbers at their ticks; an axis without numbers stays."""
    for ticks, scale, place in (
        (x, ax.set_xscale, ax.set_xticks),
        (y, ax.set_yscale, ax.set_yticks),
    ):
        if ticks:
            scale("log")
            place(ticks, [f"{n:g}" for n in ticks])
    ax.minorticks_off()


def rows(ax: Axes, names: Sequence[str]) -> None:
    """Names of rows, the first one above."""
    ax.set_yticks(range(len(names)), names)
    ax.set_ylim(len(names) - 0.4, -0.6)


def tail(ax: Axes, values: Any, **how: Any) -> None:
    """The share of values above x, in percent."""
    ax.step(values, 100 * (1 - np.arange(len(values)) / len(values)), where="pre", **how)


def cumulated(ax: Axes, values: Any, **how: Any) -> None:
    """The share of sorted values up to x, in percent."""
    ax.step(values, 100 * np.arange(1, len(values) + 1) / len(values), where="post", **how)


def each_mode(ax: Axes, names: Sequence[str]) -> None:
    """Names below groups of dots or bars, without a grid between them."""
    ax.set_xticks(range(len(names)), names)
    ax.grid(axis="x", visible=False)


LEADER = (0.012, 0.05)  # from the axes' edge to the text, as shares of the axes' width


def end_labels(ax: Axes, ends: Sequence[tuple[float, str, str]], gap: float = 0.062) -> None:
    """Name curves at their `ends` (last value, text, colour), when the limits of the axes are set.

    `gap` is the least distance of two names, as a share of the axes' height.
    """
    to_axes = ax.transData + ax.transAxes.inverted()
    x = ax.get_xlim()[1]
    placed = sorted((float(to_axes.transform((x, y))[1]), text, colour) for y, text, colour in ends)
    wanted = [height for height, _, _ in placed]
    # Groups of names that touch move as one about the middle of where they belong.
    groups: list[list[int]] = []
    for i in range(len(wanted)):
        groups.append([i])
        while len(groups) > 1 and _low(groups[-1], wanted, gap) < _top(groups[-2], wanted, gap):
            groups[-2:] = [groups[-2] + groups[-1]]
    for group in groups:
        low = _low(group, wanted, gap) + gap / 2
        for place, i in enumerate(group):
            height, text, colour = placed[i]
            y = low + place * gap
            edge, start = LEADER
            ax.plot([1.0, 1 + edge, 1 + start], [height, y, y], color=colour, lw=0.5,
                    transform=ax.transAxes, clip_on=False)  # fmt: skip
            ax.text(1.01 + start, y, text, color=colour, va="center", fontsize=6.5,
                    transform=ax.transAxes)  # fmt: skip


def _low(group: list[int], wanted: list[float], gap: float) -> float:
    middle = sum(wanted[i] for i in group) / len(group)
    high = 1 + gap / 2 - gap * len(group)
    return max(-gap / 2, min(middle - gap * len(group) / 2, high))


def _top(group: list[int], wanted: list[float], gap: float) -> float:
    return _low(group, wanted, gap) + gap * len(group)
