"""A sweep's page: what its headline says, what its pictures show, what it needs."""

import json
import re
from html import unescape

import polars
import pytest

import innervate
from innervate.cli import main
from innervate.plot import means
from innervate.sweeping import make_plan, words
from innervate.sweeping.report import axes, render
from innervate.sweeping.result import Sweep
from tests.plot.self_contained import TAGS, loads_nothing, plain
from tests.sweeping.test_plan import SKIN

K, HZ, RULE = "protocol.k", "protocol.beacon_hz", "protocol.rule"


def swept(vary, figures=lambda columns, repeat: {"x_ms": 1.0}, repeat=2, complete=True):
    """A sweep whose runs were not run: their rows are what `figures` says."""
    plan = make_plan(SKIN, vary=vary, repeat=repeat)
    rows = [
        {"point": point.index, "repeat": i, "seed": 10 * point.index + i, **point.columns,
         "status": "done", "reason": None, "command": f"innervate run x --seed {i}",
         "headline.level": "ok", "headline.text": "Fine."} | figures(point.columns, i)
        for point in plan.points for i in range(repeat)
    ]  # fmt: skip
    return Sweep(plan, polars.DataFrame(rows), polars.DataFrame(), complete)


def of_levels(*levels, **how):
    said = {"failed": {"status": "failed", "reason": "too hot", "headline.level": None,
                       "headline.text": None, "x_ms": None}}  # fmt: skip
    return swept(
        {K: range(2, 2 + len(levels))} if levels else {K: [2]},
        lambda columns, _: {"x_ms": 1.0} | said.get(
            levels[columns[K] - 2],
            {"headline.level": levels[columns[K] - 2], "headline.text": f"It is {columns[K]}."},
        ),
        repeat=1, **how,
    )  # fmt: skip


@pytest.mark.parametrize(
    ("levels", "level", "text"),
    [
        (["ok"], "ok", "The only run is ok."),
        (["ok"] * 2, "ok", "Both runs are ok."),
        (["ok"] * 3, "ok", "All 3 runs are ok."),
        (["ok", "degraded", "ok"], "degraded",
         "1 of 3 runs is degraded; 2 of 3 runs are ok."),
        (["down", "degraded", "ok", "down"], "down",
         "2 of 4 runs are down; 1 of 4 runs is degraded; 1 of 4 runs is ok."),
        (["ok", "failed"], "degraded", "1 of 2 runs failed; 1 of 2 runs is ok."),
        (["no data", "ok"], "no data", "1 of 2 runs has no data; 1 of 2 runs is ok."),
        (["failed"], "no data", "The only run failed."),
    ],
)  # fmt: skip
def test_the_headline_is_the_worst_run_and_counts_all(levels, level, text):
    made = of_levels(*levels)
    assert words.headline(made) == {"level": level, "text": text}
    page = render(made)
    assert f"<h1>{text}</h1>" in page
    assert f">{level}</p>" in page
    worst_first = ("failed", "down", "no data", "degraded")
    listed = [f"Point {i}, {K}={2 + i}: 1 {one}" for worst in worst_first
              for i, one in enumerate(levels) if one == worst]  # fmt: skip
    assert re.findall(r"<h3>(Point [^<]*)</h3>", page) == listed


def test_of_many_points_that_are_not_well_the_first_are_open():
    page = render(of_levels(*["degraded"] * 43, "down"))
    shown, folded = page.split("<summary>39 more</summary>")
    assert re.findall(r"<h3>Point (\d+),", shown) == ["43", "0", "1", "2", "3"]
    assert len(re.findall(r"<h3>Point", folded)) == 35
    assert "And 4 more, in results.parquet." in folded


def test_an_interrupted_sweep_is_not_well_however_its_runs_are():
    made = of_levels("ok", "ok", complete=False)
    assert words.headline(made) == {
        "level": "degraded",
        "text": "Both runs are ok; the sweep was interrupted, and the same command goes on.",
    }
    none = Sweep(made.plan, made.results.clear(), made.timings, complete=False)
    assert words.headline(none) == {"level": "no data", "text": "No run is done."}
    assert "<svg" not in render(none)


@pytest.mark.parametrize(
    ("vary", "x", "by"),
    [
        ({K: [2, 3, 4], HZ: [50, 250]}, K, (HZ,)),
        ({HZ: [50, 250], K: [2, 3, 4]}, K, (HZ,)),
        ({K: [2, 3, 4], HZ: [50, 250], RULE: ["paper", "strict", "feasible"]}, K, (HZ, RULE)),
        ({K: [2, 3, 4], HZ: [50, 100, 250], RULE: ["paper", "strict", "feasible"]}, K, (HZ,)),
        ({K: range(2, 13), HZ: range(50, 60)}, K, (HZ,)),
        ({RULE: ["paper", "strict"], "protocol.balancing": [True, False]}, "", ()),
        ({(K, HZ): [(2, 50), (3, 100)]}, K, ()),
        ({K: [3], RULE: ["paper", "strict"]}, "", ()),
        ({}, "", ()),
    ],
)
def test_what_goes_to_the_right_and_what_makes_lines(vary, x, by):
    assert axes(swept(vary)) == (x, by)


def test_a_picture_has_a_dot_for_each_mean_that_says_what_it_is():
    def figures(columns, repeat):
        value = columns[K] * columns[HZ] + 2.0 * repeat
        return {"x_ms": None if columns[K] == 4 else value}

    page = render(swept({K: [2, 3, 4], HZ: [50, 250]}, figures))
    tips = [unescape(tip) for tip in re.findall(r"<title>([^<]*: [^<]*)</title>", page)]
    assert tips == [
        f"{K} {k}, {HZ} {hz}: {k * hz + 1} ± 13, 2 runs" for hz in (50, 250) for k in (2, 3)
    ]
    assert "8 of 12 runs have a value; 95 % intervals of the means." in page
    assert f"{HZ} 50" in page
    assert "<h3>x (ms)</h3>" in page


def test_means_over_what_makes_no_line_are_told():
    vary = {HZ: [50, 100, 150, 200], K: [2, 3, 4], RULE: ["paper", "strict", "feasible"]}
    page = render(swept(vary))
    assert f"Means over 3 values of {RULE}, all varied alike; 95 % intervals" in page
    vary = {HZ: range(50, 60), K: range(2, 10)}
    assert f"The first 6 of 8 values of {K}." in render(swept(vary))


def test_values_of_several_kinds_make_lines():
    place = [{"row": 0, "column": 0, "port": "W"}]
    page = render(swept({K: [2, 3], "interface": [place, 7]}))
    assert len(re.findall('class="mean l[01]" d=', page)) == 2


def test_of_texts_there_is_a_row_for_each_point():
    vary = {RULE: ["paper", "strict"], "protocol.balancing": [True, False]}
    page = render(swept(vary, lambda columns, repeat: {"x_ms": 4.0 + repeat}))
    assert [one for one in re.findall(r">(rule [^<]*)<", page)] == [
        "rule paper, balancing true", "rule paper, balancing false",
        "rule strict, balancing true", "rule strict, balancing false",
    ]  # fmt: skip
    assert len(re.findall("<text[^>]*>4.5 ± 6.4<", page)) == 4
    many = {"protocol.updates": ["wave", "periodic"], "name": [f"n{i}" for i in range(20)]}
    page = render(swept(many))
    assert len(re.findall(r'class="dot l0"', page)) == means.ROWS_MAX
    assert f"The first {means.ROWS_MAX} of 40 points" in page


def test_of_one_point_it_is_shown_how_its_runs_are_spread():
    page = render(swept({}, lambda _, repeat: {"x_ms": float(repeat)}, repeat=4))
    assert "Share of the runs in % with at most so much; of 4 runs." in page


def test_in_a_notebook_a_sweep_shows_what_it_came_to():
    made = of_levels("ok", "down")
    shown = made._repr_html_()
    assert "<h1>1 of 2 runs is down; 1 of 2 runs is ok.</h1>" in shown
    assert "<h3>x (ms)</h3>" in shown
    assert len(re.findall('class="dot l0"', shown)) == 2
    assert loads_nothing(shown).loads == []
    assert ":root" not in shown  # the notebook's own colours stay


def test_a_page_is_one_file_and_names_do_no_harm():
    vary = {"name": ['<b onload="x">', "a & b"], K: [2, 3]}
    page = render(swept(vary))
    found = loads_nothing(page)
    assert found.loads == []
    assert not TAGS & set(found.tags)
    assert "<b onload" not in page
    assert '<b onload="x">' in plain(page)


def test_where_no_run_has_a_figure_there_is_no_picture():
    page = render(swept({K: [2, 3]}, lambda *_: {"x_ms": None}))
    assert "<svg" not in page
    assert "All 4 runs are ok." in page


@pytest.mark.parametrize(
    ("values", "low", "high"),
    [((0.0, 0.0), 0.0, 1.0), ((1.0, 1.0), 0.0, 1.08), ((4.0, 10.0), 0.0, 10.8),
     ((0.98, 1.0), 0.9784, 1.0016), ((-1.0, 1.0), -1.16, 1.16), ((-2.0, -2.0), -3.0, -1.0)],
)  # fmt: skip
def test_an_axis_begins_at_0_unless_all_is_far_from_it(values, low, high):
    found = means._range([means.Interval(value, value, value) for value in values])
    assert found == pytest.approx((low, high))


def test_numbers_that_are_far_apart_are_drawn_by_their_logarithms():
    near, far = means._across([1.0, 10.0, 19.0]), means._across([1.0, 10.0, 100.0])
    assert near(10.0) == pytest.approx((near(1.0) + near(19.0)) / 2)
    assert far(10.0) == pytest.approx((far(1.0) + far(100.0)) / 2)


def test_a_sweep_leaves_its_page_and_says_so(four, capsys):
    vary = [
        "--vary",
        f"{K}=2,3",
        "--workers",
        "1",
        "--out",
        "out",
        "--show",
        "recoveries.routed_ms",
    ]
    assert main(["sweep", str(four), *vary]) == 0
    assert "out/report.html" in capsys.readouterr().out
    page = (four.parent / "out" / "report.html").read_text(encoding="utf-8")
    assert page == innervate.load_sweep("out").report(["recoveries.routed_ms"])
    assert "<h3>recoveries routed (ms)</h3>" in page
    assert "cut off most" not in page
    assert main(["sweep", str(four), *vary, "--json"]) == 0
    counted = json.loads(capsys.readouterr().out)["headlines"]
    assert counted == words.levels(innervate.load_sweep("out"))
