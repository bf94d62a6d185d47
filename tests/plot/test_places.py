"""Where the parts of a drawing lie, and what a summary's lines say, by hand."""

import re

import numpy as np
import pytest
from matplotlib import colors

from innervate.plot import charts, paint, svg
from innervate.plot.charts import Axis, Bar, Mark
from innervate.plot.lines import traffic_lines
from innervate.plot.svg import Drawing
from innervate.sim.counts import Counts

PLOT = charts._Plot(Drawing(charts.WIDTH, 100, ""), Axis(2.0, 8.0), Axis(0.0, 10.0), 0.0, 80.0)
NONE = {"p50": None, "p99": None, "max": None}


def corners(times, values):
    """Corners of a step line, as (time, value)."""
    wide = charts.WIDTH - charts.LEFT - charts.RIGHT
    return [
        (round(2 + 6 * (x - charts.LEFT) / wide, 6), round(10 * (80 - y) / 80, 6))
        for x, y in charts._steps(np.array(times), np.array(values), PLOT.x, PLOT)
    ]


def test_a_step_line_begins_at_what_was_before_the_axis():
    assert corners([1.0, 2.0, 5.0, 8.0, 9.0], [1, 2, 4, 6, 8]) == [
        (2, 2), (5, 2), (5, 4), (8, 4), (8, 6), (8, 6),
    ]  # fmt: skip
    assert corners([5.0], [4]) == [(2, 0), (5, 0), (5, 4), (8, 4)]


def test_of_steps_inside_a_pixel_the_lowest_the_highest_and_the_last_are_drawn():
    times = 2.0 + np.array([0.0, 0.001, 0.002, 0.003, 0.004, 3.0])
    values = np.array([5, 9, 1, 7, 6, 2])
    assert charts._thin(times, values, 0, 6, PLOT) == [1, 2, 4, 5]


@pytest.mark.parametrize("many", [1, 3, 2 * charts.STEPS_MAX, 3 * charts.STEPS_MAX + 7])
def test_a_distribution_ends_at_all_of_the_greatest(many):
    values = np.arange(1.0, many + 1)
    shown = charts.distribution(values, Axis(0, many), "head")
    assert (shown.times[0], shown.values[0]) == (0.0, 0.0)
    assert (shown.times[-1], shown.values[-1]) == (many, 100.0)
    assert shown.values == pytest.approx(100.0 * shown.times / many)


def test_an_outline_of_bars_is_in_order_of_length(monkeypatch):
    drawn = []
    drawing = property(lambda steps: drawn.append(steps) or "drawn")
    monkeypatch.setattr(charts.Steps, "drawing", drawing)
    bars = [Bar("", float(k % 7), "") for k in range(25)]
    assert charts.Bars(bars, "bars", even=9.0).drawing == "drawn"
    (steps,) = drawn
    assert steps.values.tolist() == sorted((bar.value for bar in bars), reverse=True)
    assert (steps.x.high, steps.y.high, steps.even) == (25.0, 9.0 * 1.05, 9.0)


def test_labels_go_down_a_row_only_where_they_would_overlap():
    rows = charts._rows([Mark(9.9, "right"), Mark(0.0, "left"), Mark(0.1, "hit")], Axis(0, 10))
    assert rows == [(0, "end"), (0, "start"), (1, "start")]


def test_an_arrow_keeps_its_distance_but_never_turns():
    assert svg.arrow((0, 0), (100, 0), 10).startswith("M10,0L90,0M")
    assert svg.arrow((0, 0), (10, 0), 10).startswith("M3,0L7,0M")


def test_a_rectangle_is_closed_and_never_negative():
    whole = Drawing(20, 20, "")
    whole.rect((1, 2), (3, 4), "bar")
    whole.rect((1, 2), (-3, 4), "bar")
    assert re.findall(r' d="([^"]*)"', whole.render()) == ["M1,2h3v4h-3z", "M1,2h0v4h0z"]


def test_only_areas_are_filled():
    whole = Drawing(20, 20, "")
    whole.line((0, 0), (9, 9), "bar")
    whole.rect((1, 2), (3, 4), "bar")
    line, area = paint.figure(whole).axes[0].patches
    assert colors.to_rgba(line.get_facecolor())[3] == 0.0
    assert colors.to_rgba(area.get_facecolor())[3] > 0.0


def test_after_a_closed_path_steps_go_on_from_its_beginning():
    assert [place for place, _ in paint._corners("M5,5h4zl1,2", (10.0, 0.0))] == [
        (15, 5), (19, 5), (15, 5), (16, 7),
    ]  # fmt: skip


@pytest.mark.parametrize(("sent", "came", "words"), [
    (0, 0, None),
    (5, 4, "Messages: 5 sent, 4 delivered, 1 full queue"),
    (5, 5, "Messages: 5 sent, 5 delivered, 1 full queue"),
    (5, 6, "Messages: 5 sent, delivered 6 times, 1 full queue"),
    (0, 6, "Messages: 6 delivered, 1 full queue"),
    (5, 0, "Messages: 5 sent, 0 delivered, 1 full queue"),
])  # fmt: skip
def test_messages_in_words(sent, came, words):
    messages = {"sent": sent, "delivered": came, "dropped_by": {"full_queue": 1},
                "latency_ms": NONE}  # fmt: skip
    frames = {"sent": 1234, "arrived": 1200, "lost": 34,
              "lost_by": {"cut": 3, "noise": 31, "off": 0}}  # fmt: skip
    counts = Counts(offered=sent, delivered=came)
    lines = traffic_lines({"frames": frames, "messages": messages}, counts)
    assert lines[0] == "Frames: 1,234 sent, 1,200 arrived, 34 lost: 31 noise, 3 cut"
    assert lines[1:] == ([words] if words else [])
    shared = traffic_lines({"frames": frames, "messages": messages},
                           counts._replace(is_shared=True))  # fmt: skip
    assert shared[0] == "Receptions: 1,234 due, 1,200 arrived, 34 lost: 31 noise, 3 cut"
    assert shared[1:] == lines[1:]
