"""What pages are told of a skin's recovery, from rows made by hand."""

from types import SimpleNamespace

import numpy as np
import pytest

from innervate import scenario
from innervate.networks.skin.protocol.constants import REPORT_BROKEN, REPORT_PARENT
from innervate.networks.skin.sim.observer import APART, CUT_OFF, LOOP_OPEN, UNROUTED
from innervate.networks.skin.sim.simulate import simulate
from innervate.networks.skin.view.view import SkinView
from innervate.scenario.actions.cables import CUT as EVENT_CUT
from innervate.sim.tables import ROW, row_dtype
from innervate.web.history import LOG, History
from tests.networks.skin.runs import line

# A line of three: pc.0 - c0 - c1 - c2 - pc.1; end = 4 * cell + port, W 0, E 1.
EVENTS = [
    {"at_s": 0.1, "action": "cut", "interface": 1},
    {"at_s": 0.2, "action": "restore", "interface": 1},
    {"at_s": 0.3, "action": "kill", "cell": {"row": 0, "column": 1}},
    {"at_s": 0.5, "action": "loose", "interface": 0, "loss": 0.5},
]
MS = 1000
CUT, RESTORED, KILLED = (100 * MS, -1, CUT_OFF, 0, 0), (200 * MS, -1, CUT_OFF, 1, 0), (
    300 * MS, 1, CUT_OFF, 2, 1)  # fmt: skip


def unrouted(at_ms, cells):
    return (at_ms * MS, -1, UNROUTED, cells, 0)


def viewed(*rows):
    """A view that has taken in these rows, and what it tells of the recovery."""
    plan = scenario.plan(scenario.from_dict(line(3, event=EVENTS)))
    view = SkinView(SimpleNamespace(plan=plan, given=[], now_us=0), History())
    for row in rows:
        view.note({"rows": np.array([row], row_dtype(ROW)), "deliveries": np.zeros(0)})
    recovery = view.memory.recovery
    return view, None if recovery is None else recovery.shown()


def recovered(*rows):
    return viewed(*rows)[1]["recovered_ms"]


def lines(view):
    return [item.what["text"] for item in view.history.after(LOG, 0, view.history.newest, 99)]


def test_before_anything_is_done_there_is_nothing_to_recover_from():
    view, shown = viewed(unrouted(0, 3), unrouted(30, 0))
    assert shown is None
    assert not view.is_open
    assert viewed(RESTORED)[1] is None  # what is given back takes nothing away


def test_who_loses_no_way_has_recovered_at_once():
    view, shown = viewed(unrouted(30, 0), CUT)
    assert (shown["at_s"], shown["recovered_ms"]) == (0.1, 0.0)
    assert not view.is_open


def test_a_recovery_takes_as_long_as_somebody_has_no_way():
    assert recovered(unrouted(100, 2), CUT) is None
    assert viewed(unrouted(100, 2), CUT)[0].is_open
    assert recovered(unrouted(100, 2), CUT, unrouted(120, 1)) is None
    assert recovered(unrouted(100, 2), CUT, unrouted(130, 0)) == 30.0
    # As long as nothing else is done, it is all of it one recovery.
    again = (unrouted(100, 2), CUT, unrouted(130, 0), unrouted(140, 1))
    assert recovered(*again) is None
    assert recovered(*again, unrouted(165, 0)) == 65.0


def test_what_is_given_back_ends_a_recovery_that_is_over_and_none_that_is_not():
    over = (unrouted(100, 2), CUT, unrouted(130, 0), RESTORED)
    assert recovered(*over, unrouted(210, 2), unrouted(220, 0)) == 30.0
    under_way = (unrouted(100, 2), CUT, RESTORED)
    assert recovered(*under_way) is None
    assert recovered(*under_way, unrouted(250, 0)) == 150.0
    assert recovered(*under_way, unrouted(250, 0), unrouted(260, 1), unrouted(270, 0)) == 150.0


def test_what_is_taken_away_begins_another_recovery():
    _, shown = viewed(unrouted(100, 2), CUT, KILLED, unrouted(320, 0))
    assert (shown["at_s"], shown["recovered_ms"]) == (0.3, 20.0)
    assert "switched off" in shown["cause"]


@pytest.mark.parametrize(
    ("cell", "port", "broken", "detected_ms"),
    [(2, 1, 1, 12.0), (2, 1, 0, None), (2, 0, 1, None), (0, 0, 1, None), (1, 1, 1, None)],
)
def test_a_cut_is_found_where_it_is(cell, port, broken, detected_ms):
    row = (112 * MS, cell, REPORT_BROKEN, port, broken)
    later = (119 * MS, 2, REPORT_BROKEN, 1, 1)
    assert viewed(CUT, row)[1]["detected_ms"] == detected_ms
    assert viewed(CUT, row, later)[1]["detected_ms"] == (detected_ms or 19.0)
    assert viewed(row, CUT)[1]["detected_ms"] is None


@pytest.mark.parametrize(("cell", "port", "hit"), [(0, 1, True), (2, 0, True), (0, 0, False)])
def test_a_dead_cell_is_found_by_its_neighbours(cell, port, hit):
    found = viewed(KILLED, (340 * MS, cell, REPORT_BROKEN, port, 1))[1]["detected_ms"]
    assert found == (40.0 if hit else None)


def test_the_most_that_were_cut_off_stay_known():
    rows = [unrouted(100, 0), CUT, *((at * MS, -1, APART, cells, 0)
                                     for at, cells in ((110, 1), (120, 2), (130, 0)))]  # fmt: skip
    view, shown = viewed(*rows)
    assert (shown["apart"], view.memory.apart, view.memory.apart_most) == (2, 0, 2)


def test_what_happened_is_in_the_log_in_words():
    lost = (110 * MS, 2, REPORT_PARENT, 1, -1)
    view, _ = viewed(unrouted(0, 3), lost, unrouted(30, 0), lost, (*CUT[:4], 2), unrouted(100, 2),
                     (111 * MS, 2, REPORT_BROKEN, 1, 1), (115 * MS, 1, LOOP_OPEN, 2, 0),
                     unrouted(140, 0), (150 * MS, 2, REPORT_BROKEN, 1, 0))  # fmt: skip
    told = lines(view)
    assert told[0] == "all cells have a way after 30.0 ms"
    assert told[1].endswith("lost its parent")
    assert "2 cells lost the way to the PC" in told
    assert "a forwarding loop of 2 cells" in told
    assert "all cells have a way again after 40.0 ms" in told
    assert sum(text.endswith("found broken") for text in told) == 1
    assert sum(text.endswith("works again") for text in told) == 1


def test_while_some_are_cut_off_all_others_have_a_way_and_while_all_are_nobody():
    for apart, words in ((1, "all other cells have a way after 50.0 ms"), (3, None)):
        view, _ = viewed((5 * MS, -1, APART, apart, 0), unrouted(50, 0))
        assert lines(view) == ([words] if words else [])


CELLS = [{"at_s": at_s, "action": action, "cell": {"row": 0, "column": column}}
         for at_s, action, column in ((0.1, "kill", 0), (0.2, "kill", 1), (0.3, "kill", 2),
                                      (0.4, "revive", 2), (0.5, "kill", 2))]  # fmt: skip


def of_cells(*rows):
    """What is told where three cells die one after the other, and the last comes back."""
    plan = scenario.plan(scenario.from_dict(line(3, event=CELLS)))
    view = SkinView(SimpleNamespace(plan=plan, given=[], now_us=0), History())
    for row in rows:
        view.note({"rows": np.array([row], row_dtype(ROW)), "deliveries": np.zeros(0)})
    shown = view.memory.recovery.shown()
    return shown["nobody"], shown["recovered_ms"]


def mark(number):
    at_ms = round(1e3 * CELLS[number]["at_s"])
    return (at_ms * MS, CELLS[number]["cell"]["column"], CUT_OFF, number, 0)


def apart(at_ms, cells):
    return (at_ms * MS, -1, APART, cells, 0)


def test_who_is_dead_or_cut_off_cannot_have_a_way():
    assert of_cells(mark(0), mark(1)) == (False, 0.0)  # one is left
    assert of_cells(mark(0), mark(1), mark(2)) == (True, None)
    assert of_cells(mark(0), mark(1), apart(200, 1)) == (True, None)
    assert of_cells(mark(0), apart(100, 1)) == (False, 0.0)
    assert of_cells(mark(0), apart(100, 2), unrouted(150, 0)) == (True, None)


def test_where_nobody_was_left_it_is_over_when_somebody_is_back_with_a_way():
    none = (mark(0), mark(1), apart(200, 1))
    assert of_cells(*none, apart(260, 0)) == (False, 60.0)
    # Back, but without a way: until it has one.
    assert of_cells(*none, unrouted(250, 1), apart(260, 0)) == (False, None)
    assert of_cells(*none, unrouted(250, 1), apart(260, 0), unrouted(290, 0)) == (False, 90.0)
    assert of_cells(*none, apart(260, 1)) == (True, None)
    revived = (mark(0), mark(1), mark(2), mark(3))
    assert of_cells(*revived, unrouted(420, 0)) == (False, 120.0)
    assert of_cells(*revived, mark(4)) == (True, None)


@pytest.mark.parametrize(("cell", "told"), [
    (2, []), (1, ["1 cell lost the way to the PC"]), (0, ["2 cells lost the way to the PC"]),
])  # fmt: skip
def test_a_cell_that_is_switched_off_is_not_among_those_that_lost_their_way(cell, told):
    """A line of three whose way leads over cell 0 to interface 0."""
    kill = {"at_s": 0.3, "action": "kill", "cell": {"row": 0, "column": cell}}
    keys = line(3, event=[kill]) | {"duration_s": 0.4}
    keys["interface"] = keys["interface"][:1]
    plan = scenario.plan(scenario.from_dict(keys))
    rows = simulate(plan, plain=True).rows
    view = SkinView(SimpleNamespace(plan=plan, given=[], now_us=0), History())
    view.note({"rows": rows[rows["code"] == CUT_OFF], "deliveries": np.zeros(0)})
    assert [text for text in lines(view) if "lost the way" in text] == told


def test_only_a_parent_that_is_lost_is_told():
    found = (110 * MS, 2, REPORT_PARENT, 1, 0)
    view, _ = viewed(unrouted(0, 3), unrouted(30, 0), found)
    assert lines(view) == ["all cells have a way after 30.0 ms"]


def test_faults_by_hand_are_told_behind_those_of_the_scenario():
    plan = scenario.plan(scenario.from_dict(line(3)))
    given = [SimpleNamespace(at_us=5, action=EVENT_CUT, end=12, node=-1, loss_q15=0, frames=0)]
    view = SkinView(SimpleNamespace(plan=plan, given=given, now_us=0), History())
    row = np.array([(5, -1, CUT_OFF, 0, 2)], row_dtype(ROW))
    view.note({"rows": row, "deliveries": np.zeros(0)})
    assert view.memory.fault is given[0]
    assert lines(view) == ["cable to interface 0 cut", "2 cells lost the way to the PC"]
