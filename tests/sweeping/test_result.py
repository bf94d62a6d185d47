"""Frames, means, quantiles, pairs, figures; plan files and the command."""

import subprocess
import sys
import tomllib
from pathlib import Path

import polars
import pytest

import innervate
from innervate.analysis.intervals import mean_interval, quantile
from innervate.cli import main
from innervate.scenario import ScenarioError
from innervate.sweeping import SweepError, load_sweep, make_plan
from innervate.sweeping.result import Sweep
from tests.sweeping.conftest import TIMEOUT_S, environment

PLAN = """\
scenario = "four.toml"
name = "both"
repeat = 4
paired = ["protocol.rule", "protocol.updates"]

[set]
data.rate_hz = 10

[vary]
protocol.k = "2..3"
event.0.interface = [0, { name = "last", value = 1 }]

[[zip]]
protocol.rule = ["paper", "feasible"]
protocol.updates = ["periodic", "wave"]

[derive]
duration_s = "protocol.k / 5"

[[plot]]
x = "protocol.k"
y = "recoveries.routed_ms"
by = "protocol.rule"
name = "ways-back"

[[plot]]
x = "protocol.k"
y = "recoveries.routed_ms"
by = "protocol.rule"
kind = "heat"
"""


PLOT = '[[plot]]\nx = "a"\ny = "b"\nname = "p"\n'


@pytest.fixture
def both(four):
    Path("both.toml").write_text(PLAN)
    return innervate.sweep("both.toml", workers=1, out="out")


def test_a_plan_file_says_everything(both):
    assert both.plan.name == "both"
    assert both.results.height == 2 * 2 * 2 * 4
    assert both.results["event.0.interface"].unique().sort().to_list() == ["0", "last"]
    assert set(both.results["duration_s"]) == {0.4, 0.6}
    assert both.results["data.sent"].min() > 0
    pairs = set(both.results.select("protocol.rule", "protocol.updates").rows())
    assert pairs == {("paper", "periodic"), ("feasible", "wave")}


def test_the_folder_holds_a_plan_that_gives_the_same_table(both):
    again = innervate.sweep("out/sweep.toml", workers=1, out="again")
    assert Path("again/results.parquet").read_bytes() == Path("out/results.parquet").read_bytes()
    assert again.results.equals(polars.read_parquet("out/results.parquet"))
    assert load_sweep("out").results.equals(again.results)


def test_points_are_means_with_students_interval(both):
    table = both.points("recoveries.routed_ms")
    for row in table.iter_rows(named=True):
        mine = both.results.filter(both.results["point"] == row["point"])
        values = mine["recoveries.routed_ms"].to_list()
        assert (row["mean"], row["low"], row["high"]) == tuple(mean_interval(values))
        assert row["runs"] == 4
        assert row["p50"] == quantile(values, 0.5)
    wide = both.points("recoveries.routed_ms", level=0.99)
    assert all(a > b for a, b in zip(wide["high"], table["high"], strict=True))
    found = both.quantiles("recoveries.routed_ms", [0, 1])
    assert found["q0"].to_list() == table["min"].to_list()
    assert found["q1"].to_list() == table["max"].to_list()


def test_pairs_are_compared_run_by_run(both):
    table = both.compare("protocol.rule", "paper", "feasible", "recoveries.routed_ms")
    assert table.height == 4
    for row in table.iter_rows(named=True):
        mine = both.results.filter(
            (polars.col("protocol.k") == row["protocol.k"])
            & (polars.col("event.0.interface") == row["event.0.interface"])
        )
        one, other = (
            mine.filter(polars.col("protocol.rule") == rule) for rule in ("paper", "feasible")
        )
        assert one["seed"].to_list() == other["seed"].to_list()
        times = zip(one["recoveries.routed_ms"], other["recoveries.routed_ms"], strict=True)
        assert (row["difference"], row["low"], row["high"]) == tuple(
            mean_interval([b - a for a, b in times])
        )


@pytest.mark.parametrize(("arguments", "message"), [
    (("protocol.m", 1, 2, "recoveries.routed_ms"), "not varied"),
    (("protocol.k", 2, 9, "recoveries.routed_ms"), "no point has protocol.k=9"),
    (("protocol.k", 2, 3, "recoveries.routed_ms"), "not paired"),
    (("protocol.rule", "paper", "feasible", "routed_ms"), "no column"),
])  # fmt: skip
def test_comparisons_that_cannot_be_made(both, arguments, message):
    with pytest.raises(SweepError, match=message):
        both.compare(*arguments)


@pytest.mark.parametrize(("options", "marks"), [
    ({"x": "protocol.k", "y": "recoveries.routed_ms"}, 1),
    ({"x": "protocol.k", "y": "recoveries.routed_ms", "by": "protocol.rule"}, 2),
    ({"x": "protocol.rule", "y": "data.loss_ratio"}, 1),
    ({"x": "recoveries.detected_ms", "y": "recoveries.routed_ms", "by": "protocol.k"}, 2),
])  # fmt: skip
def test_figures_show_the_points(both, options, marks):
    (ax,) = both.plot(**options).axes
    assert len(ax.lines) == marks
    if options["x"] in both.plan.keys:
        means = both.results.filter(polars.col(options["y"]).is_not_null())
        keys = [options["x"]] + ([options["by"]] if "by" in options else [])
        expected = sorted(means.group_by(keys).agg(polars.col(options["y"]).mean())[options["y"]])
        drawn = sorted(float(v) for line in ax.lines for v in line.get_ydata())
        assert drawn == pytest.approx(expected)
        assert len(ax.collections) == marks  # a band each


def test_a_heat_map_shows_every_mean(both):
    ax, bar = both.plot("protocol.k", "recoveries.routed_ms", "protocol.rule", "heat").axes
    shown = ax.images[0].get_array()
    means = both.results.group_by("protocol.rule", "protocol.k").agg(
        polars.col("recoveries.routed_ms").mean()
    )
    assert sorted(shown.flatten().tolist()) == pytest.approx(
        sorted(means["recoveries.routed_ms"].to_list())
    )
    assert "mean" in bar.get_ylabel()


def test_the_command_runs_a_plan_and_draws_its_figures(four, capsys):
    Path("both.toml").write_text(PLAN)
    assert main(["sweep", "both.toml", "--repeat", "2", "--workers", "1"]) == 0
    out = capsys.readouterr().out
    head, *rows = out.splitlines()
    measures = ["recoveries.routed_ms", "cut_off.most", "data.loss_ratio"]
    assert head.split()[-3:] == measures
    said = rows[8:]  # below the table
    assert len(said) == 3 + 1
    assert [line for line in said if "runs: degraded" in line]
    folder = Path("sweeps/both")
    assert (folder / "ways-back.png").stat().st_size > 5_000
    assert (folder / "plot-1.svg").exists()
    plan = tomllib.loads((folder / "sweep.toml").read_text())
    assert plan["repeat"] == 2


def test_a_figure_of_what_no_run_has_is_said_and_all_else_is_there(four, capsys):
    plot = '[[plot]]\nx = "protocol.k"\ny = "recoveries.routed_ms"\n'
    Path("plan.toml").write_text(f'scenario = "four.toml"\n[set]\nevent = []\n[vary]\n'
                                 f'protocol.k = [2, 3]\n{plot}')  # fmt: skip
    assert main(["sweep", "plan.toml", "--workers", "1", "--out", "out"]) == 1
    out, err = capsys.readouterr()
    assert out.endswith("Written: out/report.html\n")
    assert 'plot-0 is not drawn: there is no column "recoveries.routed_ms"' in err


@pytest.mark.parametrize(("text", "error", "message"), [
    ('scenario = "four.toml"\nrepaet = 3', ScenarioError, 'plan.toml:2: .*did you mean "repeat"'),
    ('scenario = "four.toml"\nrepeat = 0', ScenarioError, "plan.toml:2: repeat must be"),
    ('scenario = "nowhere.toml"', ScenarioError, "no such file"),
    ('scenario = "four.toml"\n[vary]\na = 3', SweepError, "a must be a list of values"),
    ('scenario = "four.toml"\n[[zip]]\na = [1]\nb = [1, 2]', SweepError, "equally long"),
    ('scenario = "four.toml"\n[derive]\na = "1 +"', SweepError, "no arithmetic"),
    ('scenario = "four.toml"\n[vary]\na = "3..1"', SweepError, "leads nowhere"),
    ('scenario = "four.toml"\n[[plot]]\nx = "a"\ny = "b"\nkind = "heat"', SweepError,
     r"plan.toml: \[\[plot\]\] 0: a heat map has two axes, x and by"),
    (f'scenario = "four.toml"\n{2 * PLOT}', SweepError, 'plot.. 1: another is called "p", too'),
    ('scenario = "four.toml"\n[[plot]]\nx = "a"\ny = "b"\nname = "a/b"', ScenarioError,
     r"plot\.0\.name must be a file's name without its ending"),
    ('scenario = "four.toml"\n[[plot]]\nx = "a"\ny = "b"\nname = "a\\n"', ScenarioError,
     r"plan.toml:5: plot\.0\.name holds U\+000A"),
])  # fmt: skip
def test_mistakes_in_plan_files(four, text, error, message):
    Path("plan.toml").write_text(text)
    with pytest.raises(error, match=message):
        assert make_plan("plan.toml").points


@pytest.mark.parametrize(("name", "folder"), [
    ("../evil", "evil"), ("/tmp/evil", "tmp-evil"), ("a/b:", "a-b"), ("..", "sweep"),
])  # fmt: skip
def test_a_plans_name_leads_to_no_other_folder(four, name, folder, capsys):
    Path("plan.toml").write_text(f'scenario = "four.toml"\nname = "{name}"\n')
    assert main(["sweep", "plan.toml", "--workers", "1"]) == 0
    assert capsys.readouterr().out.endswith(f"Written: sweeps/{folder}/report.html\n")


def test_the_command_tells_mistakes_in_one_line(four, capsys):
    for tokens in (
        ("four.toml", "--vary", "protocol.k"),
        ("four.toml", "--until", "x"),
        ("nowhere.toml",),
        ("four.toml", "--workers", "0"),
        ("four.toml", "--engine", "steam"),
        ("four.toml", "--paired", "protocol.k"),
    ):
        assert main(["sweep", *tokens]) == 2, tokens
        out, err = capsys.readouterr()
        assert out == ""
        assert err.count("\n") == 1


def test_folders_that_are_no_sweeps(four):
    with pytest.raises(SweepError, match="not a finished sweep's folder"):
        load_sweep("nowhere")
    innervate.sweep("four.toml", workers=1, out="out")
    Path("out/results.parquet").write_bytes(b"PAR1 not")
    with pytest.raises(SweepError, match="damaged"):
        load_sweep("out")


def test_tables_of_another_plan_are_not_taken_for_those_of_the_plan_beside_them(four):
    """Killed with more values than before: the tables are still those of fewer points."""
    innervate.sweep("four.toml", vary={"protocol.k": [2, 4]}, workers=1, out="out")
    before = load_sweep("out").results
    code = (
        "import os, innervate\n"
        "innervate.sweep('four.toml', vary={'protocol.k': [3, 2, 4]}, workers=1, out='out',\n"
        "                progress=lambda scheduler: scheduler.ran and os._exit(9))"
    )
    killed = subprocess.run([sys.executable, "-c", code], env=environment(), check=False,
                            timeout=TIMEOUT_S)  # fmt: skip
    assert killed.returncode == 9
    with pytest.raises(SweepError, match=r"tables in out are of another plan than its sweep\.toml"):
        load_sweep("out")
    innervate.sweep("four.toml", vary={"protocol.k": [2, 4]}, workers=1, out="out")
    assert load_sweep("out").results.equals(before)
    Path("out/four.toml").unlink()  # one of that name in the working folder is not it
    Path("four.toml").write_text(Path("four.toml").read_text() + "# another")
    with pytest.raises(SweepError, match=r"out/four\.toml is missing or was changed"):
        load_sweep("out")


def test_a_column_that_is_not_there_is_told_with_those_of_its_name_or_some():
    plan = make_plan({"kind": "radio"}, vary={"stations": [2, 3]}, repeat=1)
    row = {"status": "done", "a.ms": 1.0, "b.ms": 2.0, "share": 0.5}
    rows = [{"point": i, "repeat": 0, "stations": 2 + i, **row} for i in range(2)]
    made = Sweep(plan, polars.DataFrame(rows), polars.DataFrame())
    with pytest.raises(SweepError, match=r'no column "c.ms"; there are a.ms, b.ms, ...'):
        made.points("c.ms")
    with pytest.raises(SweepError, match=r'no column "rate"; there are .*share, ...'):
        made.points("rate")
    assert made.points("share")["mean"].to_list() == [0.5, 0.5]
    for shares in ([-0.1], [1.1], [0.5, 2]):
        with pytest.raises(SweepError, match="shares of quantiles lie between 0 and 1"):
            made.quantiles("share", shares)
    assert made.quantiles("a.ms", [0, 1])["q1"].to_list() == [1.0, 1.0]
