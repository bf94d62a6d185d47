"""Line charts with marked moments, and bars: what is shown, and as what drawing."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import islice
from textwrap import wrap
from typing import Any, NamedTuple

import numpy as np

from innervate.plot import svg
from innervate.plot.words import count_words

WIDTH = 440.0
LEFT, RIGHT, BOTTOM = 46.0, 14.0, 40.0
LETTER = 7.2  # width of a letter at 12 px, on the safe side
SMALL_LETTER = 6.4  # at 11 px
LABEL_ROW = 15.0
BARS_MAX = 24
STEPS_MAX = 2000  # of the curve of a distribution


class Mark(NamedTuple):
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
    """A step function (`values[i]` from `times[i]` on) with marked moments, and its caption.

    `even` is marked as a level, dashed.
    """

    times: Any
    values: Any
    x: Axis
    y: Axis
    head: str
    text: str = ""
    marks: Sequence[Mark] = ()
    height: float = 190.0
    label: str = ""  # for a screen reader; else the head
    even: float | None = None

    @property
    def drawing(self) -> svg.Drawing:
        """It as it stands on a page, the names of its marked moments in rows above it.

        Names for which there is no room are numbers there, and told below.
        """
        marks, below = _fitting(self.marks, self.x)
        rows = _rows(marks, self.x)
        top = 10 + LABEL_ROW * (1 + max((row for row, _ in rows), default=-1))
        high = top + self.height
        drawing = svg.Drawing(WIDTH, high + LABEL_ROW * len(below), self.label or self.head)
        plot = _Plot(drawing, self.x, self.y, top, high - BOTTOM)
        plot.frame()
        points = _steps(self.times, self.values, self.x, plot)
        base = plot.down(self.y.low)
        ends = [(points[0][0], base), *points, (points[-1][0], base)]
        drawing.path(svg.polyline(ends) + "z", "area")
        drawing.path(svg.polyline(points), "series")
        if self.even is not None:
            level = plot.down(self.even)
            drawing.line((LEFT, level), (WIDTH - RIGHT, level), "even")
        for mark, (row, anchor) in zip(marks, rows, strict=True):
            across = plot.across(mark.at)
            level = 12 + LABEL_ROW * row
            drawing.line((across, level - 9), (across, base), "mark")
            gap = 4 if anchor == "start" else -4
            drawing.text((across + gap, level), mark.label, "", anchor)
        for i, line in enumerate(below):
            drawing.text((0.0, high + LABEL_ROW * (i + 0.75)), line, "small")
        return drawing


class Bar(NamedTuple):
    """One bar: its name, its length, the words behind it, and its class."""

    name: str
    value: float
    words: str
    kind: str = "bar"


class Bars(NamedTuple):
    """Bars with a caption; `even` is marked as the fair share."""

    bars: Sequence[Bar]
    head: str
    text: str = ""
    even: float | None = None
    label: str = ""

    @property
    def drawing(self) -> svg.Drawing:
        """It as it stands on a page, from left to right."""
        if len(self.bars) > BARS_MAX:
            return self._profile()
        left = 14 + LETTER * max(len(bar.name) for bar in self.bars)
        right = 14 + LETTER * max(len(bar.words) for bar in self.bars)
        most = max([bar.value for bar in self.bars] + [self.even or 0.0]) or 1.0
        scale = max(WIDTH - left - right, 60.0) / most
        head = LABEL_ROW + 4 if self.even is not None else 4.0
        drawing = svg.Drawing(WIDTH, head + 26 * len(self.bars) + 6, self.label or self.head)
        for i, bar in enumerate(self.bars):
            top = head + 26 * i
            drawing.text((left - 8, top + 15), bar.name, "", "end")
            drawing.rect((left, top + 2), (bar.value * scale, 18), bar.kind)
            drawing.text((left + most * scale + 8, top + 15), bar.words)
        drawing.line((left, head - 2), (left, head + 26 * len(self.bars) - 2), "axis")
        if self.even is not None:
            across = left + self.even * scale
            drawing.line((across, head - 4), (across, head + 26 * len(self.bars)), "even")
            words = f"even share: {self.even:.4g}"
            anchor = "middle" if left < across - LETTER * len(words) / 2 else "start"
            drawing.text((min(across, WIDTH - LETTER * len(words) / 2), 13), words, "small", anchor)
        return drawing

    def _profile(self) -> svg.Drawing:
        """Too many bars to name: their values in order, as one outline."""
        values = np.array(sorted((bar.value for bar in self.bars), reverse=True))
        x = Axis(0.0, float(len(values)), f"{len(values)} of them, the largest first")
        y = Axis(0.0, float(max(values[0], self.even or 0.0)) * 1.05 or 1.0)
        head = self.label or self.head
        return Steps(np.arange(len(values)), values, x, y, head, even=self.even).drawing


def marked(events: Iterable[tuple[int, str]], most: int) -> list[Mark]:
    """Marks, in seconds, of the first moments of events (us, words); of several how many."""
    seen: dict[int, list[str]] = {}
    for at_us, what in events:
        seen.setdefault(at_us, []).append(what)
    return [
        Mark(at_us / 1e6, what[0] if len(what) == 1 else f"{len(what)} events")
        for at_us, what in islice(seen.items(), most)
    ]


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


def _fitting(marks: Sequence[Mark], x: Axis) -> tuple[Sequence[Mark], list[str]]:
    """Marks as they can be named above a chart, and lines that tell what numbers stand for."""
    placed = _rows(marks, x)
    rows = [row for row, _ in placed]
    spans = [_span(mark, anchor, x) for mark, (_, anchor) in zip(marks, placed, strict=True)]
    crossed = any(
        low < _across(other.at, x) < high and other_row < row
        for (low, high), row in zip(spans, rows, strict=True)
        for other, other_row in zip(marks, rows, strict=True)
    )
    if not crossed and all(low >= 0 for low, _ in spans):
        return marks, []
    numbered = [Mark(mark.at, str(i)) for i, mark in enumerate(marks, 1)]
    told = "; ".join(f"{i}) {mark.label}" for i, mark in enumerate(marks, 1))
    return numbered, wrap(told, int(WIDTH / SMALL_LETTER))


class _Plot:
    """The plotting area: scales, grid, axes."""

    def __init__(self, drawing: svg.Drawing, x: Axis, y: Axis, top: float, bottom: float) -> None:
        self.drawing, self.x, self.y = drawing, x, y
        self.top, self.bottom = top, bottom

    def across(self, value: float) -> float:
        """Place of a value along x."""
        return _across(value, self.x)

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


def _across(at: float, x: Axis) -> float:
    """Where a moment of the axis lies, px."""
    return LEFT + (WIDTH - LEFT - RIGHT) * (at - x.low) / (x.high - x.low)


def _span(mark: Mark, anchor: str, x: Axis) -> tuple[float, float]:
    """From where to where the name of a mark reaches, px."""
    at = _across(mark.at, x)
    long = LETTER * len(mark.label) + 8 if mark.label else 0.0
    return (at, at + long) if anchor == "start" else (at - long, at)


def _rows(marks: Sequence[Mark], x: Axis) -> list[tuple[int, str]]:
    """A row and an anchor for every mark's label, so that no two labels overlap."""
    taken: list[list[tuple[float, float]]] = []
    found: dict[int, tuple[int, str]] = {}
    # From left to right: a line that starts below a label does not cross it.
    for index in sorted(range(len(marks)), key=lambda i: marks[i].at):
        mark, at = marks[index], _across(marks[index].at, x)
        anchor = "start" if _span(mark, "start", x)[1] <= WIDTH else "end"
        span = _span(mark, anchor, x)
        covering = [r for r, spans in enumerate(taken) if any(a <= at < b for a, b in spans)]
        row = max(covering, default=-1) + 1
        while row < len(taken) and any(span[0] < b and a < span[1] for a, b in taken[row]):
            row += 1
        if row == len(taken):
            taken.append([])
        taken[row].append(span)
        found[index] = (row, anchor)
    return [found[i] for i in range(len(marks))]
