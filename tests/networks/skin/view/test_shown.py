"""What pages are shown of a skin, by tables that are written here; nothing is run.

A line of three: pc.0 - c0 - c1 - c2 - pc.1; end = 4 * cell + port, W 0, E 1; pc.0 is end 12.
"""

from types import SimpleNamespace as Of

import numpy as np
import pytest

from innervate.networks.skin.scenario.orders import ALL, Order
from innervate.networks.skin.sim.counters import EARLY, LOOPED, NO_ROUTE
from innervate.networks.skin.sim.orders import ORDER_CAME, ORDER_GIVEN
from innervate.networks.skin.view.engine import SkinEngine
from innervate.networks.skin.view.view import SkinView
from innervate.scenario.actions.cables import CUT, KILL, LOOSE, RESTART, RESTORE, REVIVE
from innervate.scenario.cables import Fault
from innervate.sim.cables.wires import LOST_BROKEN, LOST_CUT, OFFERED
from innervate.sim.cables.world import DEAD
from innervate.web.engine import engine_of
from innervate.web.errors import Refused
from innervate.web.history import LOG, History
from innervate.web.messages import Cut, Give, Heal, Kill, Revive, Touch
from tests.networks.skin.runs import free, line
from tests.web.runs import plan_of

STALE_US = 200_000


def viewed(**keys):
    made = line(3, **{"data": {"rate_hz": 100}, "duration_s": 1.0} | keys)
    return SkinView(engine_of(plan_of(made)), History())


@pytest.fixture
def view():
    return viewed()


def note(view, *rows, deliveries=()):
    world = view.engine.world
    told = np.zeros(len(deliveries), world.deliveries.dtype)
    for i, values in enumerate(deliveries):
        for name, value in values.items():
            told[name][i] = value
    view.note({"rows": np.array(list(rows), world.rows.dtype), "deliveries": told})


def texts(view):
    return [item.what["text"] for item in view.history.after(LOG, 0, view.history.newest, 99)]


def test_a_touch_is_the_mean_force_of_the_newest_sample_while_it_is_not_stale(view):
    note(view, deliveries=[
        {"cell": 0, "force": (0, 0, 3000), "time": 1000, "latency": 70},
        {"cell": 2, "force": (9000, 9000, 9000), "time": 2000, "latency": 50},
    ])  # fmt: skip
    for now_us, shown in ((2000, [51, 0, 255, 0, 0]), (STALE_US + 999, [51, 0, 255, 0, 0]),
                          (STALE_US + 1000, [0, 0, 255, 0, 0]),
                          (STALE_US + 2000, [0] * 5)):  # fmt: skip
        view.engine.now_us = now_us
        assert view.arrays(False)["touch"].tolist() == shown
    note(view, deliveries=[{"cell": 2, "force": (50, 50, 50), "time": STALE_US + 1900}])
    assert view.arrays(False)["touch"].tolist() == [0, 0, 2, 0, 0]


def test_loss_and_latency_of_a_point_are_of_the_time_since_the_last(view):
    counters = view.engine.world.counters
    counters[OFFERED] = 200
    counters[LOST_CUT], counters[LOST_BROKEN] = 3, 5
    counters[NO_ROUTE], counters[LOOPED], counters[EARLY] = 7, 1, 4
    note(view, deliveries=[{"latency": 1000}, {"latency": 4000}])
    point = view.points()
    assert (point["loss"], point["latency"]) == (8.0, 2.5)
    point = view.points()
    assert (point["loss"], point["latency"]) == (0.0, None)
    counters[OFFERED], counters[LOOPED] = 208, 2
    assert view.points()["loss"] == 12.5


def test_samples_of_cells_that_never_had_a_way_are_not_counted_as_lost(view, monkeypatch):
    told = []
    monkeypatch.setattr("innervate.networks.skin.view.view.skin_headline",
                        lambda facts, label: told.append(facts))  # fmt: skip
    view.engine.now_us, counters = 1, view.engine.world.counters
    counters[OFFERED], counters[NO_ROUTE], counters[LOST_CUT], counters[EARLY] = 100, 9, 2, 6
    apart = view.engine.world.watch.apart
    for now, most, before in (((-1, -1, -1), 2, 2), ((0, -1, -1), 1, 0), ((0, 0, -1), 1, 0),
                              ((0, -1, -1), 2, 2)):  # fmt: skip
        apart[:] = now
        view.memory.apart_most = most
        view.headline()
        found = told[-1]
        assert (found.sent, found.lost, found.early) == (100, 11, 6)
        assert found.cut_off_before == before
        assert view.arrays(False)["apart"] == sum(one >= 0 for one in now)


def lead(view, *ports):
    """Have the cells these parents."""
    view.engine.world.watch.port[:] = ports


def test_ways_lead_over_cables_that_carry_frames(view):
    world = view.engine.world
    lead(view, 0, 0, 1)
    assert view.points()["balance"] == 0.9  # of two cells and one, (2 + 1)^2 / (2 (2^2 + 1^2))
    shown = view.arrays(False)
    assert (shown["parent"].tolist(), shown["port"].tolist()) == (
        [3, 0, 4, -1, -1], [0, 0, 1, 0, 1])  # fmt: skip
    assert (shown["depth"].tolist(), shown["unconnected"]) == ([1, 2, 1, 0, 0], 0)
    world.epoch[0] = world.epoch[12] = 1  # the cable of pc.0 is down
    shown = view.arrays(False)
    assert (shown["port"].tolist(), shown["unconnected"]) == ([-1, -1, 1, 0, 1], 2)
    assert shown["link_up"].tolist() == [0, 1, 1, 1]
    world.alive[1] = DEAD
    shown = view.arrays(False)
    assert (shown["node_up"].tolist(), shown["unconnected"]) == ([1, 0, 1, 1, 1], 1)


def test_load_is_the_share_of_a_cable_that_samples_fill(view):
    lead(view, 0, 0, -1)
    view.engine.world.cells["own_load"][:] = (50, 500, 50)
    share = 50 * 100 * view.plan.wire_us * 1e-6
    assert view.arrays(False)["load"].tolist() == [pytest.approx(share, abs=1e-3), 1.0, 0, 0, 0]
    silent = viewed(data={"rate_hz": 0})
    assert silent.rate_hz == 250.0
    assert "touch" not in silent.arrays(False)
    assert "loss" not in silent.points()


def test_the_newest_command_that_came_is_shown(view):
    given = (50, -1, ORDER_GIVEN, 7, ALL)
    note(view, given, (60, 1, ORDER_CAME, 7, 0), (70, 0, ORDER_CAME, 9, 0))  # 9: of before
    assert view.arrays(False)["told"].tolist() == [-1, 7, -1, -1, -1]
    assert texts(view) == ["command 7 for all cells"]


def state(view, *dead, cut=()):
    world = view.engine.world
    for cell in dead:
        world.alive[cell] = DEAD
    for end in cut:
        world.ends["impaired"][end] += 4


@pytest.mark.parametrize(
    ("command", "dead", "cut", "words"),
    [
        (Cut(1), (), (1,), "this cable is cut already"), (Cut(1), (1,), (1, 1), "cut already"),
        (Heal(1), (), (), "this cable is not cut"), (Heal(1), (1,), (1,), "its cell is switched"),
        (Kill(3), (), (), "the PC cannot be switched off"), (Kill(1), (1,), (), "is off already"),
        (Revive(1), (), (), "this cell is on"), (Kill(5), (), (), "node"), (Cut(4), (), (), "link"),
    ],
)  # fmt: skip
def test_what_is_so_already_is_refused(view, command, dead, cut, words):
    state(view, *dead, cut=cut)
    with pytest.raises(Refused, match=words):
        view.fault(command)


MADE = [
    (Cut(0), (), (), (CUT, 12, -1), {"interface": 0}),
    (Cut(3), (), (), (CUT, 13, -1), {"interface": 1}),
    (Cut(1), (), (), (CUT, 1, -1), {"cell": {"patch": 0, "row": 0, "column": 0}, "port": 1}),
    (Cut(1), (1,), (1,), (CUT, 1, -1), {"cell": {"patch": 0, "row": 0, "column": 0}, "port": 1}),
    (Heal(2), (), (5,), (RESTORE, 5, -1), {"cell": {"patch": 0, "row": 0, "column": 1}, "port": 1}),
    (Heal(1), (1,), (1, 1), (RESTORE, 1, -1),
     {"cell": {"patch": 0, "row": 0, "column": 0}, "port": 1}),
    (Kill(2), (), (), (KILL, -1, 2), {"cell": {"patch": 0, "row": 0, "column": 2}}),
    (Revive(0), (0,), (), (REVIVE, -1, 0), {"cell": {"patch": 0, "row": 0, "column": 0}}),
]  # fmt: skip


@pytest.mark.parametrize(("command", "dead", "cut", "fields", "event"), MADE)
def test_buttons_make_faults_as_a_scenario_names_them(view, command, dead, cut, fields, event):
    state(view, *dead, cut=cut)
    made = view.fault(command)
    assert (made.action, made.end, made.node) == fields
    assert (made.loss_q15, made.frames) == (0, 0)
    assert view.event(made) == event


def test_cells_of_a_free_graph_and_the_pc_are_named_as_scenarios_have_them():
    tables = free([("pc.0", "n1"), ("n1", "n2")], duration_s=1.0)
    view = SkinView(engine_of(plan_of(tables)), History())
    graph = view.plan.graph
    fault = Fault(at_us=9, action=RESTART, end=-1, node=1, loss_q15=0, frames=0, index=0)
    assert view.event(fault) == {"node": graph.label(1)}
    assert view.event(Of(end=-1, node=graph.sink)) == {"pc": True}
    assert view._target(-1) == {}


@pytest.mark.parametrize(("action", "loss", "takes"), [
    (CUT, 0, True), (KILL, 0, True), (RESTART, 0, True), (RESTORE, 0, False), (REVIVE, 0, False),
    (LOOSE, 9, True), (LOOSE, 0, False),
])  # fmt: skip
def test_what_takes_something_away(view, action, loss, takes):
    assert view.takes(Of(action=action, loss_q15=loss)) == takes


def test_what_a_hand_did_is_written_down(view):
    view.apply(Touch(1, 1))
    view.apply(Touch(1, 0))
    assert texts(view) == ["p0 r0 c1 touched", "let go"]
    view.apply(Give(code=3, value=4, node=None))
    view.apply(Give(code=5, value=6, node=2))
    found = view.extra()
    assert found["touch"] == view.engine.finger.table()
    assert [one.get("cell") for one in found["command"]] == [
        None, {"patch": 0, "row": 0, "column": 2}]  # fmt: skip
    assert [(one["code"], one["value"]) for one in found["command"]] == [(3, 4), (5, 6)]
    assert viewed().extra() == {}
    planned = viewed(command=[{"at_s": 0.5, "code": 1, "value": 2}])
    planned.apply(Give(code=3, value=4, node=None))
    assert [one["code"] for one in planned.extra()["command"]] == [1, 3]


class Kept(SkinEngine):
    """An engine that notes what is scheduled anew."""

    def __init__(self, engine):
        super().__init__(engine.running)
        self.rows = []
        engine.running.schedule_row = self.rows.append


def test_what_was_given_by_hand_happens_again_after_going_back():
    engine = Kept(viewed().engine)
    mark = engine.mark()
    engine.now_us = 500
    engine.give(Order(500, 1, 3, 4))
    engine.touch(2)
    touched = engine.world.carrier.x.tolist()
    engine.back_to(mark)
    assert engine.now_us == 0
    assert len(engine.rows) == 2  # given, and once more
    assert engine.world.carrier.x.tolist() == touched
    later = engine.mark()._replace(now_us=500)
    engine.back_to(later)
    assert len(engine.rows) == 3
    engine.back_to(later._replace(now_us=501))
    assert len(engine.rows) == 3
