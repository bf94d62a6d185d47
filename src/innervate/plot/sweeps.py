"""Figures of a sweep: means over a setting with bands, runs as dots, heat maps."""

import math
from collections.abc import Mapping, Sequence
from textwrap import wrap
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap, to_rgb
from matplotlib.figure import Figure
from matplotlib.legend import Legend

from innervate.analysis.intervals import Interval, mean_interval
from innervate.kernel.words import without_middle
from innervate.plot import style
from innervate.plot.words import averages, label

KINDS = ("band", "heat")
LINES_MAX = 8
LEGEND_INSIDE = 4  # lines; the names of more stand beside the figure, not over its lines
LETTERS = 48  # of a line below a figure with a colour bar beside it
TITLE_LETTERS = 44  # of a line of the title
NAME_LETTERS = 24  # of a value; of longer ones the middle is left out
TICK_LETTERS = 44  # of all names along an axis; more of them stand aslant
TICKS_MAX = 16  # names of squares along an axis
INKS = (style.INK, "#ffffff", "#000000")
READABLE = 4.5  # contrast of small text with its ground, at least
WRITTEN_MAX = 60  # squares of a heat map that have their number written in them
GAP = Interval(math.nan, math.nan, math.nan)
Columns = Mapping[str, Sequence[Any]]


class Shown(NamedTuple):
    """What a figure of a sweep shows."""

    x: str  # what goes to the right: a setting, or a measure
    y: str  # what goes up, or the shade of a heat map
    by: str = ""  # what tells lines apart, or what goes up in a heat map; "" = one line
    kind: str = "band"  # "band" or "heat"
    title: str = ""  # above it


def draw(columns: Columns, shown: Shown, over: Mapping[str, int] | None) -> Figure:
    """A figure of runs.

    Args:
        columns: of the results, one value a run.
        shown: which of them, and how.
        over: `x` is a setting, so that means and intervals are drawn; what else was varied, and
            is averaged over: how many values of each. None = it is a measure.
    """
    x, y, by, kind, title = shown
    with style.house():
        made, (ax,) = style.panels(style.COLUMN_IN, 2.5)
        if kind == "heat":
            _heat(made, ax, columns, x, y, by)
        elif over is not None:
            _bands(ax, columns, x, y, by)
        else:
            _dots(ax, columns, x, y, by)
        if kind != "heat":
            _up_from_0(ax, columns[y])
        ax.set_title("\n".join(wrap(title, TITLE_LETTERS)))
        notes = _notes(columns, shown, over or {})
        ax.set_xlabel("\n".join([ax.get_xlabel(), *(w for n in notes for w in wrap(n, LETTERS))]))
        if kind != "heat":
            _legend(made, ax, by)
        return made


def _up_from_0(ax: Axes, values: Sequence[Any]) -> None:
    """Where nothing but 0 is shown: no scale to both sides of it."""
    if not any(values):
        ax.set_ylim(-0.05, 1)


def _notes(columns: Columns, shown: Shown, over: Mapping[str, int]) -> list[str]:
    """What a figure does not show by itself: over what means are taken, lines that are left out."""
    notes = []
    if over:
        notes.append(averages(over, columns.get("point", ())))
    count = len(_values(columns, shown.by))
    if shown.kind != "heat" and count > LINES_MAX:
        notes.append(f"the first {LINES_MAX} of {count} values of {shown.by}")
    return notes


def _bands(ax: Axes, columns: Columns, x: str, y: str, by: str) -> None:
    """Means, and the 95 % interval of each as a band."""
    places, numbers = _scale(columns[x])
    for number, value in enumerate(_values(columns, by)[:LINES_MAX]):
        groups = _groups(columns, (x, by), y, value)
        there = _from_first_to_last([place for place in places if place in groups], groups)
        found = [mean_interval(groups[place]) if groups[place] else GAP for place in there]
        across = [numbers[place] for place in there]
        look = _look(number, value)
        ax.plot(across, [one.value for one in found], **look)
        low, high = [one.low for one in found], [one.high for one in found]
        ax.fill_between(across, low, high, color=look["color"], alpha=0.18, lw=0)
        if len(across) == 1:  # a band of one place cannot be seen
            ax.vlines(across, low, high, color=look["color"], lw=1.2)
    _name_places(ax, places, numbers)
    ax.set(xlabel=label(x), ylabel=f"{label(y)}\nmean, 95 % interval")


def _from_first_to_last(places: list[Any], groups: Mapping[Any, list[float]]) -> list[Any]:
    """Places from the first to the last with a value: what has none between them breaks a line."""
    with_value = [i for i, place in enumerate(places) if groups[place]]
    return places[with_value[0] : with_value[-1] + 1] if with_value else []


def _dots(ax: Axes, columns: Columns, x: str, y: str, by: str) -> None:
    """A dot for every run."""
    side = columns[by] if by else [None] * len(columns[x])
    for number, value in enumerate(_values(columns, by)[:LINES_MAX]):
        rows = zip(columns[x], columns[y], side, strict=True)
        kept = [(a, b) for a, b, c in rows if c == value and a is not None and b is not None]
        look = _look(number, value)
        ax.plot([a for a, _ in kept], [b for _, b in kept], **(look | {"ls": "", "alpha": 0.6}))
    ax.set(xlabel=label(x), ylabel=label(y))


def _heat(made: Figure, ax: Axes, columns: Columns, x: str, y: str, by: str) -> None:
    """Means as shades over two settings; hatched where there is none."""
    rights, ups = _values(columns, x), _values(columns, by)
    means = np.full((len(ups), len(rights)), np.nan)
    for row, up in enumerate(ups):
        groups = _groups(columns, (x, by), y, up)
        for i, right in enumerate(rights):
            if groups.get(right):
                means[row, i] = sum(groups[right]) / len(groups[right])
    shades = LinearSegmentedColormap.from_list("house", ["#f3f6fa", "#7fb2d9", "#0a3d66"])
    ax.set_facecolor(style.FAINT)
    image = ax.imshow(means, cmap=shades, origin="lower", aspect="auto")
    if means.size <= WRITTEN_MAX:
        for (row, i), value in np.ndenumerate(means):
            there = bool(np.isfinite(value))
            words = f"{value:.3g}" if there else "none"
            ink = ink_on(image.to_rgba(value)[:3] if there else to_rgb(style.FAINT))
            ax.text(i, row, words, ha="center", va="center", fontsize=6.5, color=ink)
    for axis, values in ((ax.xaxis, rights), (ax.yaxis, ups)):
        step = -(-len(values) // TICKS_MAX)
        axis.set_ticks(range(0, len(values), step), [_text(value) for value in values[::step]])
    _slant(ax)
    ax.grid(visible=False)
    ax.set(xlabel=label(x), ylabel=label(by))
    bar = made.colorbar(image, ax=ax)
    bar.set_label(f"{label(y)}, mean")
    bar.outline.set_visible(False)


def ink_on(paper: Any) -> str:
    """The first ink that can be read on a colour (red, green, blue, each 0 to 1).

    By WCAG 2: on any colour white or black has a contrast of 4.58 at least.
    """
    return next(ink for ink in INKS if contrast(to_rgb(ink), paper) >= READABLE)


def contrast(one: Sequence[float], other: Sequence[float]) -> float:
    """How well a colour stands out from another, 1 to 21, by WCAG 2."""
    darker, lighter = sorted((_luminance(one), _luminance(other)))
    return (lighter + 0.05) / (darker + 0.05)


def _luminance(colour: Sequence[float]) -> float:
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in colour]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def _values(columns: Columns, name: str) -> list[Any]:
    """The values of a column, smallest first; texts in the order in which they come."""
    return _in_order(columns[name]) if name else [None]


def _in_order(values: Sequence[Any]) -> list[Any]:
    found = list(dict.fromkeys(value for value in values if value is not None))
    return sorted(found) if all(isinstance(v, int | float) for v in found) else found


def _scale(values: Sequence[Any]) -> tuple[list[Any], dict[Any, float]]:
    """(values in order, where each stands): numbers at themselves, texts one after another."""
    found = _in_order(values)
    if all(isinstance(v, int | float) and not isinstance(v, bool) for v in found):
        return found, {value: float(value) for value in found}
    return found, {value: float(i) for i, value in enumerate(found)}


def _groups(columns: Columns, keys: tuple[str, str], y: str, value: Any) -> dict[Any, list[float]]:
    """The measure's values of the runs with `value` in the second key, by the first."""
    x, by = keys
    side = columns[by] if by else [None] * len(columns[x])
    groups: dict[Any, list[float]] = {}
    for place, number, other in zip(columns[x], columns[y], side, strict=True):
        if other == value and place is not None:
            groups.setdefault(place, []).extend([] if number is None else [number])
    return groups


def _look(number: int, value: Any) -> dict[str, Any]:
    return style.look(number) | {"label": None if value is None else _text(value) or None}


def _name_places(ax: Axes, places: list[Any], numbers: dict[Any, float]) -> None:
    """Ticks at the values there are; a wide range of positive numbers on a logarithmic axis."""
    plain = all(numbers[place] == place for place in places)
    if plain and places and min(places) > 0 and max(places) / min(places) >= 20:
        ax.set_xscale("log")
        ax.minorticks_off()
    if not plain or len(places) <= 10:
        ax.set_xticks([numbers[place] for place in places], [_text(place) for place in places])
        if not plain:
            _slant(ax)


def _slant(ax: Axes) -> None:
    """Put names aslant that would stand over each other."""
    if sum(len(text.get_text()) + 1 for text in ax.get_xticklabels()) > TICK_LETTERS:
        ax.tick_params(axis="x", rotation=35)
        for text in ax.get_xticklabels():
            text.set_horizontalalignment("right")
            text.set_rotation_mode("anchor")


def _legend(made: Figure, ax: Axes, by: str) -> None:
    """The lines' names: inside if they are few and cover nothing, else beside the figure."""
    if not by:
        return
    looks: dict[str, Any] = {"title": label(by), "title_fontsize": 6.8, "alignment": "left"}
    few = len(ax.get_legend_handles_labels()[1]) <= LEGEND_INSIDE
    if not few or _covers(made, ax, ax.legend(loc="best", **looks)):
        ax.legend(loc="upper left", bbox_to_anchor=(1.02, 1.0), **looks)


def _covers(made: Figure, ax: Axes, legend: Legend) -> bool:
    """Whether lines or dots lie under a legend."""
    made.draw_without_rendering()
    box = legend.get_window_extent()
    for line in ax.lines:
        path = line.get_transform().transform_path(line.get_path())
        dots = line.get_linestyle() == "None"
        if box.count_contains(path.vertices) if dots else path.intersects_bbox(box, filled=False):
            return True
    return False


def _text(value: Any) -> str:
    """A value as it stands in a scenario file, short."""
    if isinstance(value, bool):
        return str(value).lower()
    text = f"{value:g}" if isinstance(value, float) else str(value)
    return without_middle(text, NAME_LETTERS)
