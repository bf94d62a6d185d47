"""Charts and tables on both sides of what they have room for."""

import re

import pytest

from innervate.plot import charts, page
from innervate.plot.charts import STEPS_MAX, Axis, Bar


@pytest.mark.parametrize(("count", "steps"), [
    (1, 1), (STEPS_MAX, STEPS_MAX), (2 * STEPS_MAX - 1, 2 * STEPS_MAX - 1),
    (2 * STEPS_MAX, STEPS_MAX),
])  # fmt: skip
def test_a_distribution_has_as_many_steps_as_one_can_see(count, steps):
    shown = charts.distribution(list(range(1, count + 1)), Axis(0, count), "head")
    assert len(shown.times) == len(shown.values) == steps + 2
    assert (shown.times[0], shown.values[0]) == (0, 0)
    assert (shown.times[-1], shown.values[-1]) == (count, 100)


def test_ticks_are_where_they_were_asked_for_but_for_a_last_digit():
    assert charts.ticks(0.5, 1.1, 6) == [0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.1]
    assert charts.ticks(0.07, 0.12) == [0.07, 0.08, 0.09, 0.1, 0.11, 0.12]  # 0.07 / 0.01 is above 7
    assert charts.ticks(0.1, 0.3, 2) == [0.1, 0.2, 0.3]  # 0.3 / 0.1 is below 3


def test_many_bars_are_an_outline_from_the_largest_on(parse):
    bars = [Bar(str(i), value, "") for i, value in enumerate([3.0, 9.0, 1.0] * 9)]
    drawing = charts.Bars(bars, "many").drawing
    (line,) = [node.get("d") for node in parse(drawing).iter() if node.get("class") == "series"]
    heights = [float(y) for y in re.findall(r",([\d.]+)", line)]
    assert heights == sorted(heights)
    assert len(set(heights)) >= 3


@pytest.mark.parametrize(("count", "more"), [(200, ""), (201, "And 1 more"), (1_300, "And 1,100")])
def test_a_long_table_has_its_beginning_and_says_how_much_more_there_is(count, more):
    shown = page.beginning(("a",), [(str(i),) for i in range(count)], " there")
    assert shown.count("<td>") == min(count, 200)
    assert ("more there." in shown) == bool(more)
    assert more in shown


@pytest.mark.parametrize(("wall_s", "said"), [
    (0.0099, "< 0.01 s"), (0.01, "0.01 s"), (0.05, "0.05 s"), (12.34, "12 s"),
])  # fmt: skip
def test_how_long_a_simulation_took(wall_s, said):
    summary = {"wall_s": wall_s, "events": 1_200_000}
    assert page.took(summary, 2.5) == (said, "to simulate 2.5 s, 1.2 M events")
