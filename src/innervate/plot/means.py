"""Means with their 95 % intervals as drawings of a page: over a number, or a row each."""

import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NamedTuple

from innervate.analysis.intervals import Interval
from innervate.plot import svg
from innervate.plot.charts import BOTTOM, LABEL_ROW, LEFT, LETTER, RIGHT, SMALL_LETTER, WIDTH, ticks
from innervate.plot.words import count_words

STYLE = "\n" + Path(__file__).with_name("means.css").read_text(encoding="utf-8")
ROWS_MAX = 24
HEIGHT = 200.0
TOP = 14.0
WIDE_RANGE = 20  # from the least to the greatest number: drawn by its logarithm
NEAR = 0.2  # of the greatest: values that differ by less are drawn without 0
MARGIN = 0.08  # of what is shown, above and below it
_ROUND = tuple((math.cos(i * math.pi / 6), math.sin(i * math.pi / 6)) for i in range(12))
# A line differs from the next by the shape of its dots, too.
DOTS = (
    _ROUND,
    ((-0.9, -0.9), (0.9, -0.9), (0.9, 0.9), (-0.9, 0.9)),
    ((0.0, -1.2), (1.1, 0.8), (-1.1, 0.8)),
    ((0.0, -1.3), (1.3, 0.0), (0.0, 1.3), (-1.3, 0.0)),
    ((0.0, 1.2), (1.1, -0.8), (-1.1, -0.8)),
    ((-1.3, -0.5), (1.3, -0.5), (1.3, 0.5), (-1.3, 0.5)),
)
LINES_MAX = len(DOTS)  # and as many colours
DOT_PX = 3.6
Scale = Callable[[float], float]


class Mean(NamedTuple):
    """A mean with its interval: of which number, in words, and what is said of it at length."""

    at: float
    found: Interval
    told: str
    tip: str


class Line(NamedTuple):
    """Means that belong together, in ascending order of `at`, and what they are called."""

    name: str
    means: Sequence[Mean]


def over(lines: Sequence[Line], x_name: str, label: str) -> svg.Drawing:
    """Means over a number: a line for each of at most LINES_MAX, its intervals as a band.

    Args:
        lines: at least one of them has a mean; all numbers are finite.
        x_name: what goes to the right, with its unit.
        label: what a screen reader says of the drawing.
    """
    drawing = svg.Drawing(WIDTH, TOP + HEIGHT, label)
    places = sorted({mean.at for line in lines for mean in line.means})
    across = _across(places)
    down = _upwards([mean.found for line in lines for mean in line.means], drawing)
    _name_places(drawing, places, across, x_name)
    for number, line in enumerate(lines):
        kind = f"l{number}"
        lows = [(across(mean.at), down(mean.found.low)) for mean in line.means]
        highs = [(across(mean.at), down(mean.found.high)) for mean in line.means]
        middles = [(across(mean.at), down(mean.found.value)) for mean in line.means]
        if len(line.means) > 1:
            drawing.path(svg.polyline([*lows, *highs[::-1]]) + "z", f"within {kind}")
            drawing.path(svg.polyline(middles), f"mean {kind}")
        elif line.means:  # a band of one place cannot be seen
            drawing.line(lows[0], highs[0], f"whisker {kind}")
        for (x, y), mean in zip(middles, line.means, strict=True):
            drawing.path(dot(x, y, number), f"dot {kind}", mean.tip)
    return drawing


def rows(means: Sequence[tuple[str, Mean]], label: str) -> svg.Drawing:
    """A row for each of 1 to ROWS_MAX means: its name, its interval as a whisker, its number."""
    left = 16 + LETTER * max(len(name) for name, _ in means)
    right = 12 + LETTER * max(len(mean.told) for _, mean in means)
    low, high = _range([mean.found for _, mean in means])
    scale = max(WIDTH - left - right, 80.0) / (high - low)
    drawing = svg.Drawing(max(WIDTH, left + right + 80), 26.0 * len(means) + 8, label)
    for number, (name, mean) in enumerate(means):
        level = 26.0 * number + 17
        ends = [left + (value - low) * scale for value in mean.found]
        drawing.text((left - 10, level + 4), name, "", "end")
        drawing.line((left, level), (left + (high - low) * scale, level), "grid")
        drawing.line((ends[1], level), (ends[2], level), "whisker l0")
        drawing.path(dot(ends[0], level, 0), "dot l0", mean.tip)
        drawing.text((left + (high - low) * scale + 8, level + 4), mean.told)
    return drawing


def dot(x: float, y: float, number: int) -> str:
    """Path data of a dot of the line with this number."""
    return svg.polygon(x, y, [(DOT_PX * a, DOT_PX * b) for a, b in DOTS[number]])


def swatch(number: int) -> svg.Drawing:
    """How a line looks, for a legend."""
    drawing = svg.Drawing(26, 12, "")
    drawing.line((0, 6), (26, 6), f"mean l{number}")
    drawing.path(dot(13, 6, number), f"dot l{number}")
    return drawing


def _range(found: Sequence[Interval]) -> tuple[float, float]:
    """From where to where an axis goes: from 0 on unless all of it is far from there."""
    low, high = min(one.low for one in found), max(one.high for one in found)
    if low >= 0 and (high - low > NEAR * high or high == low):
        return 0.0, high * (1 + MARGIN) or 1.0
    spare = MARGIN * (high - low) or 0.5 * abs(high)
    return low - spare if low < 0 or low > spare else 0.0, high + spare


def _upwards(found: Sequence[Interval], drawing: svg.Drawing) -> Scale:
    """The upward axis: where a number lies on it, px."""
    low, high = _range(found)
    bottom = TOP + HEIGHT - BOTTOM

    def down(value: float) -> float:
        return bottom - (bottom - TOP) * (value - low) / (high - low)

    for value in ticks(low, high, 4):
        drawing.line((LEFT, down(value)), (WIDTH - RIGHT, down(value)), "grid")
        drawing.text((LEFT - 6, down(value) + 4), count_words(value), "small", "end")
    return down


def _across(places: Sequence[float]) -> Scale:
    """Where a number lies, px: by its logarithm where numbers are far apart."""
    apart = places[0] > 0 and places[-1] / places[0] >= WIDE_RANGE
    scaled = [math.log(place) for place in places] if apart else list(places)
    low, wide = scaled[0], scaled[-1] - scaled[0]

    def across(value: float) -> float:
        share = ((math.log(value) if apart else value) - low) / wide if wide else 0.5
        return LEFT + 8 + (WIDTH - LEFT - RIGHT - 16) * share

    return across


def _name_places(drawing: svg.Drawing, places: Sequence[float], across: Scale, x_name: str) -> None:
    """The axis, with the numbers that were tried as far as there is room for their names."""
    base = TOP + HEIGHT - BOTTOM
    drawing.line((LEFT, base), (WIDTH - RIGHT, base), "axis")
    free = -math.inf
    for place in places:
        x, words = across(place), f"{place:g}"
        half = SMALL_LETTER * len(words) / 2
        drawing.line((x, base), (x, base + 4), "axis")
        if x - half > free:
            drawing.text((x, base + 16), words, "small", "middle")
            free = x + half + SMALL_LETTER
    drawing.text((WIDTH - RIGHT, base + 16 + LABEL_ROW), x_name, "small", "end")
