"""What a page says first is what summary and report say first, of every kind of network."""

import pytest

from innervate import run
from tests.web.runs import MESH, RADIO, SKIN, few_points, go_to, simulated

__all__ = ["few_points"]
pytestmark = pytest.mark.usefixtures("few_points")


@pytest.mark.parametrize(
    ("level", "events"),
    [
        ("ok", ()),
        ("down", [(4.0, "kill", "node", 5), (5.0, "kill", "node", 0)]),
        ("degraded", [(4.0, "cut", "link", [0, 3]), (6.0, "kill", "node", 7)]),
    ],
)  # fmt: skip
def test_page_summary_and_report_of_a_mesh_have_one_headline(level, events):
    event = [{"at_s": at_s, "action": action, of: what} for at_s, action, of, what in events]
    tables = {**MESH, "event": event}
    done = run(tables)
    made = simulated(tables)
    go_to(made, 4.5)
    early = made.fields()["headline"]
    made.run_to_end()
    shown = made.fields()["headline"]
    assert {"level": shown["level"], "text": shown["text"]} == done.summary["headline"]
    assert shown["text"] in done.report()
    assert shown["level"] == level
    made.back_to(0)
    go_to(made, 4.5)
    assert made.fields()["headline"] == early


@pytest.mark.parametrize(
    ("level", "events"),
    [
        ("ok", ()),
        ("degraded", [{"at_s": 0.3, "action": "kill", "cell": {"row": 1, "column": 2}}]),
        ("down", [{"at_s": 0.3, "action": "cut", "interface": i} for i in range(2)]),
        ("degraded", [{"at_s": 0.3, "action": "cut", "interface": i} for i in range(2)]
         + [{"at_s": 0.5, "action": "restore", "interface": 1}]),
    ],
)  # fmt: skip
def test_page_summary_and_report_of_a_skin_have_one_headline(level, events):
    tables = {**SKIN, "event": list(events)}
    done = run(tables)
    made = simulated(tables)
    made.run_to_end()
    shown = made.fields()["headline"]
    assert {"level": shown["level"], "text": shown["text"]} == done.summary["headline"]
    assert shown["level"] == level
    if level == "down":
        assert shown["nodes"] == list(range(30))


@pytest.mark.parametrize("killed", [(), (2,)])
def test_page_and_summary_of_a_radio_team_have_one_headline(killed):
    event = [{"at_s": 0.2, "action": "kill", "station": station} for station in killed]
    tables = {**RADIO, "event": event}
    done = run(tables)
    made = simulated(tables)
    made.run_to_end()
    shown = made.fields()["headline"]
    assert {"level": shown["level"], "text": shown["text"]} == done.summary["headline"]
    assert shown["level"] == ("degraded" if killed else "ok")


def test_a_mesh_that_has_just_begun_is_neither_well_nor_lost():
    made = simulated(MESH)
    assert made.fields()["headline"]["level"] == "no data"
    go_to(made, 4.0)
    assert made.fields()["headline"]["level"] == "ok"


def test_a_skin_before_all_says_nothing_of_cells_that_have_a_way():
    made = simulated(SKIN)
    shown = made.fields()
    assert shown["unconnected"] == 30
    assert shown["headline"] == {
        "level": "no data", "text": "Nothing has happened yet.", "nodes": []
    }  # fmt: skip


def test_a_plain_run_of_a_mesh_has_the_headline_of_the_compiled_one():
    event = [{"at_s": 1.5, "action": "kill", "node": 3}]
    few = {**MESH, "nodes": 6, "radio": {"mean_degree": 4}, "duration_s": 2.0, "event": event}
    compiled, plain = run(few), run(few, plain=True)
    assert compiled.summary["headline"] == plain.summary["headline"]
    assert "1 of 6 nodes is off" in plain.summary["headline"]["text"]
