"""Tables of a sweep, from rows that are written here: columns, kinds, figures of every point."""

import os
import statistics
from types import SimpleNamespace

import numpy as np
import polars
import pytest

from innervate.sweeping import tables

INT, FLOAT, TRUTH, TEXT = polars.Int64, polars.Float64, polars.Boolean, polars.String


@pytest.mark.parametrize(("values", "kind", "kept"), [
    ([1, 2], INT, [1, 2]), ([1, None], INT, [1, None]), ([1, 2.5], FLOAT, [1.0, 2.5]),
    ([True, False], TRUTH, [True, False]), ([True, 1], TEXT, ["true", "1"]),
    ([None, None], TEXT, [None, None]), (["a", None], TEXT, ["a", None]),
    (["a", 1], TEXT, ["a", "1"]), ([[1, "b"], "c"], TEXT, ['[1, "b"]', "c"]),
])  # fmt: skip
def test_a_column_is_of_the_narrowest_kind_that_holds_its_values(values, kind, kept):
    made = tables.frame([{"x": value} for value in values])
    assert made.schema == {"x": kind}
    assert made["x"].to_list() == kept


def test_columns_come_in_the_order_asked_for_and_then_as_rows_bring_them():
    made = tables.frame([{"b": 1, "c": 2}, {"a": 3, "b": 4}], ("z", "b"))
    assert made.columns == ["z", "b", "c", "a"]
    assert made.rows() == [(None, 1, 2, None), (None, 4, None, 3)]
    assert tables.frame([], ("point", "x")).columns == ["point", "x"]


def test_figures_are_numbers_that_are_neither_settings_nor_about_the_run():
    row = {"point": 0, "repeat": 1, "seed": 2, "k": 3, "status": "done", "reason": "",
           "command": "x", "routed": 1, "share": 0.5, "word": "a", "fine": True}  # fmt: skip
    assert tables.measures(tables.frame([row]), ["k"]) == ["routed", "share"]


def test_a_points_figures_are_those_of_its_runs():
    values = {0: [3.0, 1.0, 10.0, 2.0, 8.0], 1: [None, 7.0], 2: [None]}
    rows = [{"point": point, "x": value} for point, some in values.items() for value in some]
    plan = [SimpleNamespace(index=i, columns={"k": 10 + i}) for i in range(4)]
    made = tables.points(tables.frame(rows), plan, ["x"], 0.9)
    assert made.columns == ["point", "k", "measure", "runs", "mean", "low", "high", "min", "p05",
                            "p50", "p95", "max"]  # fmt: skip
    first, second, third, fourth = made.rows(named=True)
    some = values[0]
    half = 2.131847 * statistics.stdev(some) / 5**0.5  # Student's t, 95 %, 4 degrees of freedom
    wanted = {"mean": 4.8, "low": 4.8 - half, "high": 4.8 + half}
    for name, share in (("min", 0), ("p05", 5), ("p50", 50), ("p95", 95), ("max", 100)):
        wanted[name] = np.percentile(some, share)
    assert {name: first[name] for name in wanted} == pytest.approx(wanted, abs=1e-5)
    assert [row["runs"] for row in (first, second, third, fourth)] == [5, 1, 0, 0]
    assert {second[name] for name in wanted} == {7.0}  # one run has no width
    assert {third[name] for name in wanted} == {fourth[name] for name in wanted} == {None}
    assert [row["k"] for row in (first, second, third, fourth)] == [10, 11, 12, 13]


class Runs:
    """A job table."""

    def __init__(self, *figures):
        self._figures = figures or ({"x": 1.5, "seed": 9}, None, {"x": 2.5})

    def each(self, digest, count):
        for repeat, figures in enumerate(self._figures[:count]):
            reason = "" if figures else "no port"
            yield repeat, SimpleNamespace(seed=100 + repeat, figures=figures, reason=reason,
                                          wall_s=0.5, began_s=7.0 + repeat,
                                          place="here")  # fmt: skip

    def places(self):
        return {"here": {"host": "h", "cores": 2}}


PLAN = SimpleNamespace(
    keys=("k",), points=[SimpleNamespace(index=i, digest=f"d{i}", columns={"k": 5 + i}, settings={})
                         for i in range(2)],
    base=SimpleNamespace(command=lambda settings, seed: f"run --seed {seed}"),
)  # fmt: skip


def test_a_row_says_of_a_run_what_it_was_and_what_came_of_it():
    made = tables.results(PLAN, Runs(), (2, 3))
    assert made.columns == ["point", "repeat", "seed", "k", "status", "reason", "command", "x"]
    assert made.rows()[:2] == [
        (0, 0, 100, 5, "done", "", "run --seed 100", 1.5),
        (0, 1, 101, 5, "failed", "no port", "run --seed 101", None),
    ]
    assert made["point"].to_list() == [0, 0, 1, 1, 1]
    timed = tables.timings(PLAN, Runs(), (1, 2))
    assert timed.columns == ["point", "repeat", "wall_s", "began_s", "host", "cores"]
    assert timed.rows() == [(0, 0, 0.5, 7.0, "h", 2), (1, 0, 0.5, 7.0, "h", 2),
                            (1, 1, 0.5, 8.0, "h", 2)]  # fmt: skip


def test_what_a_summary_does_not_name_as_it_never_happened_counts_as_none():
    """Means over those runs alone in which frames collided would be far too high."""
    runs = Runs(
        {"frames.lost": 4, "frames.lost_by.noise": 4, "reports.5": 2, "broken.count": 1},
        {"frames.lost": 0, "broken": "[]", "latency_ms": None},
        None,  # a run that failed says nothing
        {"lost": 0, "latency_ms": 3.0},  # and one of another kind only what it says
    )
    made = tables.results(PLAN, runs, (4, 0))
    for name, wanted in (
        ("frames.lost_by.noise", [4, 0, None, None]), ("reports.5", [2, 0, None, None]),
        ("broken.count", [1, 0, None, None]), ("latency_ms", [None, None, None, 3.0]),
    ):  # fmt: skip
        assert made[name].to_list() == wanted, name


def test_a_figure_that_no_run_has_is_a_column_of_numbers():
    """Tables of sweeps in which something happened, and did not, have columns of the same kind."""
    runs = Runs({"alarms.latency_ms": None, "word": "a"}, {"alarms.latency_ms": None})
    made = tables.results(PLAN, runs, (2, 0))
    assert (made.schema["alarms.latency_ms"], made.schema["word"]) == (FLOAT, TEXT)
    assert made["alarms.latency_ms"].to_list() == [None, None]
    assert tables.measures(made, ["k"]) == ["alarms.latency_ms"]
    (row,) = tables.points(made, PLAN.points[:1], ["alarms.latency_ms"], 0.95).rows(named=True)
    assert (row["runs"], row["mean"]) == (0, None)


def test_a_file_is_replaced_whole_or_not_at_all(tmp_path):
    path = tmp_path / "results.parquet"
    path.write_text("before")
    tables.write(tables.frame([{"x": 1}]), path)
    assert polars.read_parquet(path).rows() == [(1,)]
    before = path.read_bytes()
    (tmp_path / ".results.parquet.part").mkdir()  # nothing can be written there
    with pytest.raises(OSError, match="part"):
        tables.write(tables.frame([{"x": 2}]), path)
    assert path.read_bytes() == before
    os.rmdir(tmp_path / ".results.parquet.part")
