"""What a sweep's rows come to: pairs, measures that are shown, over what figures take means."""

import polars
import pytest

from innervate.sweeping import SweepError, make_plan, words
from innervate.sweeping.result import SHOWN, SHOWN_MAX, Sweep
from tests.sweeping.test_plan import SKIN


def table(*rows):
    plan = make_plan(SKIN, vary={"protocol.k": [2, 3]}, paired="protocol.k", repeat=3)
    found = [{"point": point, "repeat": repeat, "seed": 1, "protocol.k": 2 + point,
              "status": "done", "x": x, **{name: 1.0 for name in SHOWN}}
             for point, repeat, x in rows]  # fmt: skip
    return Sweep(plan, polars.DataFrame(found), polars.DataFrame())


def test_pairs_are_runs_that_both_have_and_their_interval_is_of_the_level_asked_for():
    made = table((0, 0, 1.0), (0, 1, 2.0), (0, 2, 9.0), (1, 0, 3.0), (1, 1, 6.0), (1, 2, None))
    (wide,) = made.compare("protocol.k", 2, 3, "x", level=0.99).rows(named=True)
    (row,) = made.compare("protocol.k", 2, 3, "x").rows(named=True)
    assert (row["pairs"], row["mean_one"], row["mean_other"]) == (2, 1.5, 4.5)
    assert row["difference"] == wide["difference"] == 3.0
    assert row["high"] - row["low"] == pytest.approx(2 * 12.7062, abs=1e-3)
    assert wide["high"] - wide["low"] == pytest.approx(2 * 63.6567, abs=1e-3)
    (back,) = made.compare("protocol.k", 3, 2, "x").rows(named=True)
    assert back["difference"] == -3.0
    (none,) = table((0, 0, 1.0), (1, 1, 2.0)).compare("protocol.k", 2, 3, "x").rows(named=True)
    assert (none["pairs"], none["difference"]) == (0, None)


@pytest.mark.parametrize(
    "paired", ["all", ("protocol.k", "data.queue", "protocol.rule", "protocol.m")]
)
def test_pairs_differ_in_the_key_and_what_goes_with_it_and_in_nothing_else(paired):
    """Points of other settings have the same seeds, and are not compared with each other."""
    vary = {"protocol.k": [2, 3], ("protocol.rule", "protocol.m"): [("paper", 2), ("strict", 3)],
            "data.queue": [4, 8]}  # fmt: skip
    plan = make_plan(SKIN, vary=vary, paired=paired, derive={"touch.x": "protocol.m * 2"})
    rows = [{"point": p.index, "repeat": 0, **p.columns, "x": 10.0**p.index} for p in plan.points]
    made = Sweep(plan, polars.DataFrame(rows), polars.DataFrame())
    keys, pairs = ["protocol.k", "data.queue"], {}
    for key, one, other in (("protocol.rule", "paper", "strict"), ("touch.x", 4, 6)):
        found = made.compare(key, one, other, "x")
        pairs[key] = set(found.select(*keys, "mean_one", "mean_other").rows())
    wanted = {(k, q, 10.0**i, 10.0 ** (i + 2))
              for k, q, i in ((2, 4, 0), (2, 8, 1), (3, 4, 4), (3, 8, 5))}  # fmt: skip
    assert pairs["protocol.rule"] == pairs["touch.x"] == wanted


def test_figures_of_what_never_happened_are_numbers_all_the_same():
    """So that one's own arithmetic on a column does not end where nothing came."""
    made = table((0, 0, None), (1, 0, None))
    compared = made.compare("protocol.k", 2, 3, "x")
    for found, name in ((made.points("x"), "mean"), (made.quantiles("x", [0.5]), "q0.5"),
                        (compared, "difference"), (compared, "low")):  # fmt: skip
        assert found.schema[name] == polars.Float64
        assert (found[name] * 2).null_count() == found.height


def test_points_without_a_value_of_what_until_names_are_said():
    made = table((0, 0, None), (0, 1, None), (1, 0, None), (1, 1, 2.0))
    assert made.without_value() == {}
    plan = make_plan(SKIN, vary={"protocol.k": [2, 3]}, until=("x.ci=5%", "list.y.ci=1"))
    made = Sweep(plan, made.results, made.timings)
    assert made.without_value() == {"x": [0], "list.y": [0, 1]}
    assert words.never_lines(made) == [
        "--until x: no run of point 0 has a value of it, so that there is no interval",
        "--until list.y: no run of points 0, 1 has a value of it, so that there is no interval",
    ]
    failed = made.results.with_columns(status=polars.lit("failed"))
    assert Sweep(plan, failed, made.timings).without_value() == {}


def test_of_measures_a_few_are_shown_or_all_that_somebody_asked_for():
    made = table((0, 0, 1.0))
    assert made.to_show() == list(SHOWN[:SHOWN_MAX])
    assert made.to_show(["x", "never.happened"]) == ["x", "never.happened"]
    assert made.to_show(["protocol.k"]) == list(SHOWN[:SHOWN_MAX])  # a column of its own
    assert made.to_show([*SHOWN]) == list(SHOWN)
    none = polars.lit(None, polars.Float64).alias(SHOWN[0])
    made.results = made.results.with_columns(none)  # which is not among the few
    assert made.to_show() == [one for one in SHOWN if one in made.measures][1 : SHOWN_MAX + 1]


def test_over_what_a_figure_takes_means():
    plan = make_plan(SKIN, vary={"protocol.k": [2, 3, 4], "protocol.m": [2], "seedless": [1, 2]},
                     derive={"data.queue": "protocol.k + 1"})  # fmt: skip
    made = Sweep(plan, polars.DataFrame(), polars.DataFrame())
    assert made.averaged("protocol.k") == {"seedless": 2}
    assert made.averaged("seedless") == {"protocol.k": 3, "data.queue": 3}
    assert made.averaged("protocol.k", "seedless") == {}
    assert made.averaged("protocol.k", "data.loss_ratio") == {"seedless": 2}  # a measure, by which


def test_a_figure_by_a_measure_is_drawn_and_one_of_what_no_run_has_is_told():
    made = table((0, 0, 1.0), (0, 1, 2.0), (1, 0, 3.0))
    (ax,) = made.plot("protocol.k", "data.loss_ratio", by="x").axes
    assert len(ax.lines) == 3
    made.results = made.results.with_columns(polars.lit(None, polars.String).alias("never"))
    with pytest.raises(SweepError, match='no run has a value of "never"'):
        made.plot("protocol.k", "never")
