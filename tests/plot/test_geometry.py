"""Where charts put things, to the hundredth of a pixel, worked out by hand."""

import numpy as np
import pytest

from innervate.plot import charts, svg
from innervate.plot.charts import STEPS_MAX, Axis, Bar, Mark


@pytest.mark.parametrize(("span", "found"), [
    ((0, 10, 5), [0, 2, 4, 6, 8, 10]), ((0, 1, 4), [0, 0.5, 1]), ((3, 17, 4), [5, 10, 15]),
    ((0, 100, 4), [0, 50, 100]), ((-1, 1, 4), [-1, -0.5, 0, 0.5, 1]),
    ((0, 40, 4), range(0, 41, 10)),
    ((0.2, 0.9, 7), [0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9]), ((5, 5, 3), [5]), ((5, 4, 3), [5]),
])  # fmt: skip
def test_ticks_are_the_round_numbers_of_an_axis(span, found):
    assert charts.ticks(*span) == list(found)


def test_a_distribution_says_which_share_is_at_most_so_large():
    made = charts.distribution(np.array([1.0, 2.0, 5.0, 9.0]), Axis(0, 10, "ms"), "head")
    assert list(made.times) == [0, 1, 2, 5, 9, 9]
    assert list(made.values) == [0, 25, 50, 75, 100, 100]
    assert (made.y.low, made.y.high) == (0, 105)


@pytest.mark.parametrize(("count", "kept"), [
    (1, 1), (STEPS_MAX, STEPS_MAX), (2 * STEPS_MAX - 1, 2 * STEPS_MAX - 1),
    (2 * STEPS_MAX, STEPS_MAX), (3 * STEPS_MAX, STEPS_MAX),
])  # fmt: skip
def test_a_long_distribution_is_thinned_and_keeps_its_end(count, kept):
    made = charts.distribution(np.arange(count), Axis(0, 10), "head")
    assert len(made.times) == len(made.values) == kept + 2
    assert (made.times[-1], made.values[-1]) == (count - 1, 100)


def shapes(drawing, parse, kind, *names):
    """Numbers of all elements of a class."""
    found = (node for node in parse(drawing).iter() if node.get("class") == kind)
    return [tuple(float(node.get(name)) for name in names) for node in found]


def rectangles(drawing, parse):
    return [node.get("d") for node in parse(drawing).iter() if node.get("class") == "bar"]


def test_bars_stand_where_their_values_say(parse):
    drawing = charts.Bars([Bar("ab", 10, "x"), Bar("c", 5, "yy")], "loads").drawing
    assert (drawing.width, drawing.height) == (440, 62)
    assert rectangles(drawing, parse) == [
        "M28.4,6h383.2v18h-383.2z", "M28.4,32h191.6v18h-191.6z",
    ]  # fmt: skip
    (axis,) = shapes(drawing, parse, "axis", "x1", "y1", "x2", "y2")
    assert axis == (28.4, 2, 28.4, 54)
    said = [node for node in parse(drawing).iter() if node.tag.endswith("text")]
    assert [(float(n.get("x")), float(n.get("y")), n.text) for n in said] == [
        (20.4, 19, "ab"), (419.6, 19, "x"), (20.4, 45, "c"), (419.6, 45, "yy"),
    ]  # fmt: skip


def test_the_fair_share_is_a_line_across_all_bars(parse):
    drawing = charts.Bars([Bar("ab", 10, "x"), Bar("c", 5, "yy")], "loads", even=7.5).drawing
    assert drawing.height == 62 + 15
    (even,) = shapes(drawing, parse, "even", "x1", "y1", "x2", "y2")
    assert even == (315.8, 15, 315.8, 71)
    assert [one[:8] for one in rectangles(drawing, parse)] == ["M28.4,21", "M28.4,47"]
    # It may be more than every bar.
    (over,) = shapes(charts.Bars([Bar("ab", 5, "xx")], "x", even=10).drawing, parse, "even", "x1")
    assert over == (411.6,)


@pytest.mark.parametrize(("count", "is_profile"), [(24, False), (25, True)])
def test_so_many_bars_have_names(count, is_profile, texts):
    words = texts(charts.Bars([Bar("a", 1, "b")] * count, "x").drawing)
    assert ("25 of them, the largest first" in words) == is_profile
    assert ("a" in words) != is_profile


def test_a_step_chart_has_its_axes_and_steps_in_place(parse):
    made = charts.Steps(np.array([0.0, 5.0]), np.array([0, 50]), Axis(0, 10), Axis(0, 100), "x")
    drawing = made.drawing
    assert (drawing.width, drawing.height) == (440, 200)
    (line,) = (n for n in parse(drawing).iter() if n.get("class") == "series")
    assert line.get("d") == "M46,160L236,160L236,85L426,85"
    (area,) = (n for n in parse(drawing).iter() if n.get("class") == "area")
    assert area.get("d") == "M46,160L46,160L236,160L236,85L426,85L426,160z"
    assert shapes(drawing, parse, "grid", "y1") == [(160,), (85,), (10,)]
    axis = shapes(drawing, parse, "axis", "x1", "y1", "y2")
    assert axis == [(46 + 76 * i, 160, 164) for i in range(6)] + [(46, 160, 160)]


def test_names_of_moments_stand_in_rows_above(parse):
    marks = [Mark(5.0, "cut"), Mark(5.2, "next")]
    made = charts.Steps(np.array([0.0]), np.array([0]), Axis(0, 10), Axis(0, 1), "x", marks=marks)
    assert made.drawing.height == 190 + 10 + 2 * 15
    lines = shapes(made.drawing, parse, "mark", "x1", "y1", "y2")
    assert lines == [(236, 3, 190), (243.6, 18, 190)]
    texts = [n for n in parse(made.drawing).iter() if n.text in ("cut", "next")]
    assert [(float(n.get("x")), float(n.get("y"))) for n in texts] == [(240, 12), (247.6, 27)]


@pytest.mark.parametrize(("start", "end", "gap", "path"), [
    ((0, 0), (100, 0), 10, "M10,0L90,0M83,4.2L90,0L83,-4.2"),
    ((0, 0), (10, 0), 10, "M3,0L7,0M3,2.4L7,0L3,-2.4"),
    ((0, 0), (0, 100), 10, "M0,10L0,90M-4.2,83L0,90L4.2,83"),
    ((100, 0), (0, 0), 0, "M100,0L0,0M7,-4.2L0,0L7,4.2"),
])  # fmt: skip
def test_arrows_keep_their_distance_from_both_ends(start, end, gap, path):
    assert svg.arrow(start, end, gap) == path


def test_small_shapes():
    assert svg.cross(10, 20, 3) == "M7,17l6,6M7,23l6,-6"
    assert svg.polygon(10, 20, [(0, 0), (5, 0), (5, 5.5)]) == "M10,20l5,0l0,5.5z"
    assert svg.polyline([(1, 2), (3.456, -0.001)]) == "M1,2L3.46,0"
