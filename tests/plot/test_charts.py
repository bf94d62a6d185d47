import re

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from innervate.plot import charts
from innervate.plot.charts import Axis, Bar, Mark, Steps

TIMES, VALUES = np.array([0.0, 5.0, 9.0]), np.array([0, 100, 0])


@given(st.floats(-1e6, 1e6), st.floats(1e-3, 1e6), st.integers(2, 8))
def test_ticks_are_inside_and_few(low, span, count):
    found = charts.ticks(low, low + span, count)
    slack = 1e-6 * max(1.0, abs(low), span)
    assert all(low - slack <= tick <= low + span + slack for tick in found)
    assert len(found) <= 2 * count + 2


def test_ticks_of_nothing():
    assert charts.ticks(3.0, 3.0) == [3.0]


@given(st.lists(st.floats(0, 10), min_size=1, max_size=8))
def test_mark_labels_do_not_overlap(at):
    marks = [Mark(x, f"label {x:.2f}") for x in at]
    x = Axis(0, 10)
    rows = charts._rows(marks, x)
    spans = [(row, *charts._span(mark, anchor, x))
             for mark, (row, anchor) in zip(marks, rows, strict=True)]  # fmt: skip
    for i, (row, a, b) in enumerate(spans):
        assert a >= 0
        assert b <= charts.WIDTH
        assert all(row != r or b <= c or d <= a for r, c, d in spans[:i])


def test_step_chart_shows_marks_and_numbers(texts):
    marks = [Mark(5.0, "cut"), Mark(9.0, "all routed 4 ms")]
    shown = Steps(TIMES, VALUES, Axis(0, 10, "ms"), Axis(0, 110), "cells", marks=marks)
    words = texts(shown.drawing)
    assert {"cut", "all routed 4 ms", "ms", "0", "100", "10"} <= set(words)


LONG = "a cable far away from here, between two cells"


@pytest.mark.parametrize("marks", [
    [Mark(5.0, LONG)],  # no room on either side
    [Mark(6.0, "cut"), Mark(9.0, LONG[:39])],  # the first one's line would cross the second's name
])  # fmt: skip
def test_names_without_room_are_numbers_told_below(marks, texts):
    drawing = Steps(TIMES, VALUES, Axis(0, 10), Axis(0, 110), "cells", marks=marks).drawing
    words = texts(drawing)
    assert not {mark.label for mark in marks} & set(words)
    numbers = [str(i) for i in range(1, len(marks) + 1)]
    assert set(numbers) <= set(words)
    told = "; ".join(f"{i}) {mark.label}" for i, mark in enumerate(marks, 1))
    assert " ".join(word for word in words if word).endswith(told)


def test_step_chart_of_nothing(parse):
    empty = np.array([])
    drawing = parse(Steps(empty, empty, Axis(0, 1), Axis(0, 1), "nothing").drawing)
    (line,) = (n for n in drawing.iter() if n.get("class") == "series")
    points = [point.split(",") for point in line.get("d")[1:].split("L")]
    assert len({y for _, y in points}) == 1  # nothing, all the time
    assert float(points[-1][0]) - float(points[0][0]) > 100


def test_step_chart_starts_with_the_value_before_its_window(parse):
    def first_level(low):
        drawing = Steps(TIMES, VALUES, Axis(low, 10), Axis(0, 100), "x").drawing
        line = next(n for n in parse(drawing).iter() if n.get("class") == "series")
        return float(line.get("d")[1:].split("L")[0].split(",")[1])

    assert first_level(6.0) < first_level(1.0)  # 100 lies above 0


def test_dense_steps_are_thinned_but_keep_their_extremes(parse):
    times = np.arange(200_000) / 20_000.0
    values = np.zeros(200_000)
    values[77_777] = 100.0
    drawing = Steps(times, values, Axis(0, 10), Axis(0, 100), "x").drawing
    assert len(drawing.render()) < 60_000
    line = next(n for n in parse(drawing).iter() if n.get("class") == "series")
    levels = {point.split(",")[1] for point in line.get("d")[1:].split("L")}
    assert len(levels) == 2


def test_an_even_level_is_dashed_where_it_is(parse):
    shown = Steps(TIMES, VALUES, Axis(0, 10), Axis(0, 100), "x", even=25.0)
    drawing = parse(shown.drawing)
    (level,) = (float(n.get("y1")) for n in drawing.iter() if n.get("class") == "even")
    grid = sorted(float(n.get("y1")) for n in drawing.iter() if n.get("class") == "grid")
    assert level == pytest.approx(grid[-1] + 0.25 * (grid[0] - grid[-1]), abs=0.2)


def test_bars(texts):
    bars = [Bar("port 0", 67, "67 cells", "p0"), Bar("port 1", 0, "0 cells", "p1")]
    words = texts(charts.Bars(bars, "loads", even=33.5).drawing)
    assert words == ["port 0", "67 cells", "port 1", "0 cells", "even share: 33.5"]


def test_bars_of_zeros_have_no_length(parse):
    drawing = parse(charts.Bars([Bar("a", 0, "0"), Bar("b", 0, "0")], "zeros").drawing)
    bars = [n.get("d") for n in drawing.iter() if n.get("class") == "bar"]
    assert [bar.partition("h")[2] for bar in bars] == ["0v18h0z", "0v18h0z"]


def test_bars_beside_words_that_leave_no_room_are_still_60_wide(parse):
    bars = [Bar("n" * 150, 4, "w" * 150), Bar("n", 1, "w")]
    drawn = [n.get("d") for n in parse(charts.Bars(bars, "long").drawing).iter()
             if n.get("class") == "bar"]  # fmt: skip
    assert [re.search(r"h([0-9.]+)v18", d)[1] for d in drawn] == ["60", "15"]


def test_many_bars_become_a_profile(texts):
    bars = [Bar(f"port {i}", i, f"{i} cells") for i in range(200)]
    words = texts(charts.Bars(bars, "loads", even=99.5).drawing)
    assert "200 of them, the largest first" in words
    assert "port 7" not in words


@pytest.mark.parametrize("values", [[5, 5, 5], [0, 0, 0]])
def test_flat_profiles(parse, values):
    bars = [Bar(str(i), v, str(v)) for i, v in enumerate(values * 10)]
    drawing = parse(charts.Bars(bars, "flat", even=float(values[0])).drawing)
    (line,) = (n for n in drawing.iter() if n.get("class") == "series")
    (level,) = {point.split(",")[1] for point in line.get("d")[1:].split("L")}
    (even,) = (n.get("y1") for n in drawing.iter() if n.get("class") == "even")
    assert level == even
