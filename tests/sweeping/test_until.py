"""When a point has been repeated often enough, on both sides of its rule."""

import pytest

from innervate.sweeping.errors import SweepError
from innervate.sweeping.until import Until, parse

# Two values 2 apart: their mean is known to within 12.7062, Student's t of one degree of freedom.
HALF = 12.7062


@pytest.mark.parametrize(("values", "mean"), [([9.0, 11.0], 10), ([-11.0, -9.0], 10)])
@pytest.mark.parametrize(("factor", "met"), [(0.9999, False), (1.0001, True)])
def test_an_interval_is_narrow_enough_in_units_or_as_a_share_of_the_mean(values, mean, factor, met):
    assert Until("x", factor * HALF, relative=False).met(values) == met
    assert Until("x", factor * HALF / mean, relative=True).met(values) == met


def test_of_a_mean_of_nothing_no_share_is_enough_but_nothing():
    assert not Until("x", 0.5, relative=True).met([-1.0, 1.0])
    assert Until("x", 0.5, relative=True).met([0.0, 0.0])
    assert not Until("x", 99.0, relative=False).met([1.0])


@pytest.mark.parametrize(
    ("half", "relative", "values", "needed"),
    [
        (HALF / 2, False, [9.0, 11.0], 8),  # half as wide takes four times as many
        (HALF / 3 * 1.001, False, [9.0, 11.0], 18),
        (HALF / 3 * 0.999, False, [9.0, 11.0], 19),
        (HALF / 20, True, [9.0, 11.0], 8),
        (2 * HALF, False, [9.0, 11.0], 1),
        (1e-9, False, [9.0, 11.0], 2_000_000),  # no more than a million times as many
        (0.5, True, [-1.0, 1.0], 0),  # that cannot be said
        (0.5, False, [1.0], 0),
        (0.5, False, [], 0),
    ],
)
def test_how_many_it_will_take(half, relative, values, needed):
    found = Until("x", half, relative).needed(values)
    assert found == pytest.approx(needed, abs=1 if needed == 8 else 0)


@pytest.mark.parametrize(
    ("text", "rule"),
    [
        ("a.b_c.ci=5%", Until("a.b_c", 0.05, relative=True)),
        (" a-b.ci = 0.5 ", Until("a-b", 0.5, relative=False)),
        ("x.ci=1e-3 %", Until("x", 1e-5, relative=True)),
        ("x.ci.ci=+2", Until("x.ci", 2.0, relative=False)),
    ],
)
def test_a_rule_is_read_as_it_is_written(text, rule):
    assert parse(text) == rule


@pytest.mark.parametrize(
    "text", ["", "x", "x=5%", ".ci", "x.ci=", "x.ci=%", "x.ci=0", "x.ci=-1", "x.ci=1e999",
             "x.ci=5%%", "x.ci=1.2.3", "x y.ci=5", "x.ci=nan"],
)  # fmt: skip
def test_what_is_no_rule_is_told_in_one_line(text):
    with pytest.raises(SweepError, match=r"write it as MEASURE\.ci=5%") as told:
        parse(text)
    assert "\n" not in str(told.value)
