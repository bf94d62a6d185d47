import json
import math

import polars
import pytest

from innervate import run
from innervate.network import networks
from innervate.networks.mesh import tables as declared
from innervate.networks.mesh.analysis.alarms import all_crossings
from innervate.networks.mesh.show import summary_lines
from innervate.running import compare
from tests.networks.mesh.tables_runs import mesh_tables, without_fence

NAMES = ["nodes", "links", "discovery", "delivery_ratio", "latency_ms", "alarms", "duplicates",
         "looped", "control_bytes"]  # fmt: skip


@pytest.fixture(scope="module")
def field(tmp_path_factory):
    return run(mesh_tables(), out=tmp_path_factory.mktemp("mesh") / "run")


def test_the_summary_has_its_names(field):
    summary = field.summary
    assert [name for name in NAMES if name not in summary] == []
    assert {"recall", "complete_s", "tables_s", "airtime_s"} <= set(summary["discovery"])
    assert {"sent", "delivered", "latency_ms", "overrun_m"} <= set(summary["alarms"])
    assert summary["nodes"] == 32
    assert summary["links"] == len(field.plan.good)
    assert summary["alarms"]["sent"] == 2
    assert summary["duplicates"] == 0
    assert json.loads(json.dumps(summary, allow_nan=False)) == summary


def test_the_summary_agrees_with_the_tables(field):
    messages = field.tables["messages"].collect()
    counts = field.summary["messages"]
    assert len(messages) == counts["offered"]
    assert messages["delivered_us"].count() == counts["delivered"] > 100
    waits = messages.select(polars.col("delivered_us") - polars.col("offered_us")).to_series()
    assert waits.min() > 0
    assert 1e-3 * waits.max() == pytest.approx(field.summary["latency_ms"]["max"])
    crossings = field.tables["crossings"].collect()
    assert crossings["accepted_us"].count() == field.summary["alarms"]["delivered"]
    sent = field.tables["transmissions"].collect()
    control = sent.filter(polars.col("kind").is_in([1, 2, 3, 4, 5, 12]))["bytes"].sum()
    assert control < field.summary["control_bytes"] < 2 * control  # and their acks of 9 bytes


def test_what_never_happened_is_null_in_the_tables():
    """Nobody leads any more: an alarm is raised, and never comes."""
    tables = mesh_tables(standby=[], monitor="gateway", flow=[], duration_s=20.0)
    tables["event"] = [{"at_s": 5, "action": "kill", "node": "gateway"}]
    done = run(tables)
    crossings = done.tables["crossings"].collect()
    assert len(crossings) == done.summary["alarms"]["sent"] > 0
    assert done.summary["alarms"]["delivered"] == 0
    for column in ("accepted_us", "hops", "warned_us"):
        assert crossings[column].null_count() == len(crossings)
    assert crossings["crossed_us"].null_count() == 0


def test_the_folder_has_every_table(field):
    names = {path.name for path in field.written.iterdir()}
    assert {f"{table.name}.parquet" for table in declared.TABLES} < names
    for table in declared.TABLES:
        frame = polars.read_parquet(field.written / f"{table.name}.parquet")
        assert frame.columns == [column.name for column in table.columns]
        assert len(frame) > 0


def test_the_terminal_is_told_the_same(field):
    first, *lines = summary_lines(field)
    assert first.startswith("<field> & more: 32 nodes, 1")
    assert lines[0] == f"{field.summary['headline']['level']}: {field.summary['headline']['text']}"
    assert lines[1].startswith("2 crossings of the fence, and the monitor learned of all")
    assert any(line.startswith("The first round found") for line in lines)
    assert lines[-1].startswith("No message came twice")


def test_two_runs_are_compared_event_by_event(tmp_path):
    short = without_fence() | {"duration_s": 3.0}
    one = run(short, out=tmp_path / "one", seed=1).written
    same = run(short, out=tmp_path / "same", seed=1).written
    assert compare(one, same).same
    other = run(short | {"radio": {"mean_degree": 6}}, out=tmp_path / "other", seed=1).written
    found = compare(one, other)
    assert not found.same
    assert found.divergence is not None
    assert "node n" in found.divergence.a


def test_calls_in_words(field):
    row = {"node": 3, "port": 10, "handler": 1}
    assert networks()["mesh"].run.call_words(field.plan, row) == "node n3: received an alarm"


SLANTED = {
    "kind": "mesh", "duration_s": 45, "nodes": 10,
    "placement": {"side_m": 40}, "radio": {"mean_degree": 5},
    "fence": {"polygon": [[3, 2], [37, 6], [34, 38], [5, 33]]},
}  # fmt: skip


@pytest.mark.parametrize("seed", [1, 3, 8])
def test_a_slow_robot_that_sees_itself_outside_too_soon_is_told_of(seed):
    """At 0.2 m/s, over a slanted fence: the rounded place is outside before the robot is."""
    angle = 2 * math.pi * seed / 37
    way = [[20 + far * math.cos(angle), 20 + far * math.sin(angle)] for far in (12, 22)]
    robot = {"node": 9, "waypoints": way, "speed_mps": 0.2, "start_s": 5}
    done = run(SLANTED | {"seed": seed, "robot": [robot]})
    (crossing,) = all_crossings(done.result)
    assert crossing.raised_us < crossing.crossed_us
    assert (done.summary["alarms"]["sent"], done.summary["alarms"]["delivered"]) == (1, 1)
    assert "learned of the only crossing" in done.summary["headline"]["text"]
