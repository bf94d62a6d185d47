"""Line charts with marked moments, and bars: as they are drawn on pages.

Steps and Bars say what is shown; plot/figures.py draws the same with matplotlib.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from innervate.plot import svg
from innervate.plot.words import count_words

WIDTH = 440.0
LEFT, RIGHT, BOTTOM = 46.0, 14.0, 40.0
LETTER = 7.2  # width of a letter at 12 px, on the safe side
LABEL_ROW = 15.0
BARS_MAX = 24
STEPS_MAX = 2000  # of the curve of a distribution


@dataclass(frozen=True, slots=True)
class Mark:
    """A moment on the time axis: where (in the axis's unit) and what to call it."""

    at: float
    label: str


@dataclass(frozen=True, slots=True)
class Axis:
    """From where to where an axis goes, and its unit in words."""

    low: float
    high: float
    name: str = ""


@dataclass(frozen=True, slots=True)
class Panel:
    """A drawing with its caption."""

    drawing: svg.Drawing
    head: str
    text: str = ""


@dataclass(frozen=True, slots=True)
class Steps:
    """A step function (`values[i]` from `times[i]` on) with marked moments, and its caption."""

    times: Any
    values: Any
    x: Axis
    y: Axis
    head: str
    text: str = ""
    marks: Sequence[Mark] = ()
    height: float = 190.0
    label: str = ""  # for a screen reader; else the head

    @property
    def drawing(self) -> svg.Drawing:
        """It as it stands on a page."""
        label = self.label or self.head
        return step_chart(self.times, self.values, self.x, self.y, self.marks, label, self.height)


@dataclass(frozen=True, slots=True)
class Bar:
    """One bar: its name, its length, the words behind it, and its class."""

    name: str
    value: float
    words: str
    kind: str = "bar"


@dataclass(frozen=True, slots=True)
class Bars:
    """Bars with a caption; `even` is marked as the fair share."""

    bars: Sequence[Bar]
    head: str
    text: str = ""
    even: float | None = None
    label: str = ""

    @property
    def drawing(self) -> svg.Drawing:
        """It as it stands on a page."""
        return bar_chart(self.bars, self.label or self.head, self.even)


def distribution(
    values: Any, x: Axis, head: str, text: str = "", marks: Sequence[Mark] = (), top: float = 105.0
) -> Steps:
    """Which share of values, in ascending order and at least one, is at most so large, in %."""
    shares = 100.0 * np.arange(1, len(values) + 1) / len(values)
    every = max(1, len(values) // STEPS_MAX)
    at = np.concatenate([[0.0], values[::every], values[-1:]])
    shares = np.concatenate([[0.0], shares[::every], shares[-1:]])
    return Steps(at, shares, x, Axis(0.0, top), head, text, marks)


def ticks(low: float, high: float, count: int = 5) -> list[float]:
    """Round numbers inside low .. high, about `count` of them."""
    span = high - low
    if not span > 0:
        return [low]
    raw = span / max(count, 1)
    power = 10.0 ** math.floor(math.log10(raw))
    step = next(m * power for m in (1, 2, 5, 10) if m * power >= raw * 0.999)
    first = math.ceil(low / step - 1e-9)
    last = math.floor(high / step + 1e-9)
    return [round(i * step, 10) + 0.0 for i in range(first, last + 1)]


def step_chart(
    times: Any, values: Any, x: Axis, y: Axis, marks: Sequence[Mark], label: str,
    height: float = 190.0,
) -> svg.Drawing:  # fmt: skip
    """A step function (`values[i]` from `times[i]` on) with marked moments above it."""
    inner = WIDTH - LEFT - RIGHT
    rows = _rows(marks, lambda at: LEFT + inner * (at - x.low) / (x.high - x.low))
    top = 10 + LABEL_ROW * (1 + max((row for row, _ in rows), default=-1))
    drawing = svg.Drawing(WIDTH, top + height, label)
    plot = _Plot(drawing, x, y, top, top + height - BOTTOM)
    plot.frame()
    points = _steps(times, values, x, plot)
    base = plot.down(y.low)
    ends = [(points[0][0], base), *points, (points[-1][0], base)]
    drawing.path(svg.polyline(ends) + "z", "area")
    drawing.path(svg.polyline(points), "series")
    for mark, (row, anchor) in zip(marks, rows, strict=True):
        across = plot.across(mark.at)
        level = 12 + LABEL_ROW * row
        drawing.line((across, level - 9), (across, base), "mark")
        gap = 4 if anchor == "start" else -4
        drawing.text((across + gap, level), mark.label, "", anchor)
    return drawing


class _Plot:
    """The plotting area: scales, grid, axes."""

    def __init__(self, drawing: svg.Drawing, x: Axis, y: Axis, top: float, bottom: float) -> None:
        self.drawing, self.x, self.y = drawing, x, y
        self.top, self.bottom = top, bottom

    def across(self, value: float) -> float:
        """Place of a value along x."""
        inner = WIDTH - LEFT - RIGHT
        return LEFT + inner * (value - self.x.low) / (self.x.high - self.x.low)

    def down(self, value: float) -> float:
        """Place of a value along y."""
        share = (value - self.y.low) / (self.y.high - self.y.low)
        return self.bottom - (self.bottom - self.top) * share

    def frame(self) -> None:
        """Grid, axes, numbers and names."""
        drawing = self.drawing
        for value in ticks(self.y.low, self.y.high, 4):
            level = self.down(value)
            drawing.line((LEFT, level), (WIDTH - RIGHT, level), "grid")
            drawing.text((LEFT - 6, level + 4), count_words(value), "small", "end")
        for value in ticks(self.x.low, self.x.high, 6):
            drawing.line((self.across(value), self.bottom), (self.across(value), self.bottom + 4),
                         "axis")  # fmt: skip
            drawing.text((self.across(value), self.bottom + 16), f"{value:g}", "small", "middle")
        drawing.line((LEFT, self.bottom), (WIDTH - RIGHT, self.bottom), "axis")
        drawing.text((WIDTH - RIGHT, self.bottom + 32), self.x.name, "small", "end")


def _steps(times: Any, values: Any, x: Axis, plot: _Plot) -> list[svg.Point]:
    """Corners of the step line inside the axis, no denser than the eye can tell."""
    before = int(np.searchsorted(times, x.low, "right"))
    start = float(values[before - 1]) if before else plot.y.low
    behind = int(np.searchsorted(times, x.high, "right"))
    places = range(before, behind)
    if len(places) > 1500:
        places = _thin(times, values, before, behind, plot)
    points = [(plot.across(x.low), plot.down(start))]
    for i in places:
        across = plot.across(float(times[i]))
        points.append((across, points[-1][1]))
        points.append((across, plot.down(float(values[i]))))
    points.append((plot.across(x.high), points[-1][1]))
    return points


def _thin(times: Any, values: Any, before: int, behind: int, plot: _Plot) -> Any:
    """Of all steps inside one px the lowest, the highest and the last."""
    part = values[before:behind]
    scale = (WIDTH - LEFT - RIGHT) / (plot.x.high - plot.x.low)
    column = ((np.asarray(times[before:behind], np.float64) - plot.x.low) * scale).astype(np.int64)
    order = np.lexsort((part, column))
    edges = np.flatnonzero(np.diff(column[order])) + 1
    first = np.concatenate([[0], edges])
    last = np.concatenate([edges, [len(order)]]) - 1
    final = np.flatnonzero(np.append(np.diff(column), 1))
    return (before + np.unique(np.concatenate([order[first], order[last], final]))).tolist()


def _rows(marks: Sequence[Mark], across: Any) -> list[tuple[int, str]]:
    """A row and an anchor for every mark's label, so that no two labels overlap."""
    taken: list[list[tuple[float, float]]] = []
    found: dict[int, tuple[int, str]] = {}
    # From left to right: a line that starts below a label does not cross it.
    for index in sorted(range(len(marks)), key=lambda i: marks[i].at):
        at, long = across(marks[index].at), LETTER * len(marks[index].label) + 8
        anchor = "start" if at + long <= WIDTH else "end"
        span = (at, at + long) if anchor == "start" else (at - long, at)
        covering = [r for r, spans in enumerate(taken) if any(a <= at < b for a, b in spans)]
        row = max(covering, default=-1) + 1
        while row < len(taken) and any(span[0] < b and a < span[1] for a, b in taken[row]):
            row += 1
        if row == len(taken):
            taken.append([])
        taken[row].append(span)
        found[index] = (row, anchor)
    return [found[i] for i in range(len(marks))]


def bar_chart(bars: Sequence[Bar], label: str, even: float | None = None) -> svg.Drawing:
    """Bars from left to right; `even` is marked as the fair share."""
    if len(bars) > BARS_MAX:
        return _profile(bars, label, even)
    left = 14 + LETTER * max(len(bar.name) for bar in bars)
    right = 14 + LETTER * max(len(bar.words) for bar in bars)
    most = max([bar.value for bar in bars] + [even or 0.0]) or 1.0
    scale = max(WIDTH - left - right, 60.0) / most
    head = LABEL_ROW + 4 if even is not None else 4.0
    drawing = svg.Drawing(WIDTH, head + 26 * len(bars) + 6, label)
    for i, bar in enumerate(bars):
        top = head + 26 * i
        drawing.text((left - 8, top + 15), bar.name, "", "end")
        drawing.rect((left, top + 2), (bar.value * scale, 18), bar.kind)
        drawing.text((left + most * scale + 8, top + 15), bar.words)
    drawing.line((left, head - 2), (left, head + 26 * len(bars) - 2), "axis")
    if even is not None:
        across = left + even * scale
        drawing.line((across, head - 4), (across, head + 26 * len(bars)), "even")
        words = f"even share: {even:.4g}"
        anchor = "middle" if left < across - LETTER * len(words) / 2 else "start"
        drawing.text((min(across, WIDTH - LETTER * len(words) / 2), 13), words, "small", anchor)
    return drawing


def _profile(bars: Sequence[Bar], label: str, even: float | None) -> svg.Drawing:
    """Too many bars to name: their values in order, as one outline."""
    values = np.array(sorted((bar.value for bar in bars), reverse=True))
    x = Axis(0.0, float(len(values)), f"{len(values)} of them, the largest first")
    y = Axis(0.0, float(max(values[0], even or 0.0)) * 1.05 or 1.0)
    drawing = step_chart(np.arange(len(values)), values, x, y, (), label)
    if even is not None:
        plot = _Plot(drawing, x, y, 10, drawing.height - BOTTOM)
        drawing.line((LEFT, plot.down(even)), (WIDTH - RIGHT, plot.down(even)), "even")
    return drawing
