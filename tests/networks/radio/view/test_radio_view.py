"""What pages are told of a radio team, from rows made by hand."""

from types import SimpleNamespace

import numpy as np
import pytest

from innervate import scenario
from innervate.dialect.access import REPORT_LEFT
from innervate.networks.radio.protocol.constants import DATA, REPORT_BOUNDS, REPORT_STOPPED
from innervate.networks.radio.view.view import RadioView
from innervate.sim.channel import world as w
from innervate.sim.tables import ROW, row_dtype
from innervate.web.history import LOG, History

TEAM = {"kind": "radio", "stations": 3, "duration_s": 1.0,
        "event": [{"at_s": 0.3, "action": "kill", "station": 2}]}  # fmt: skip


def table(fields, *rows):
    made = np.zeros(len(rows), row_dtype(fields, w.WIDE))
    for place, row in enumerate(rows):
        for name, value in row.items():
            made[name][place] = value
    return made


@pytest.fixture
def view():
    plan = scenario.plan(scenario.from_dict(TEAM))
    return RadioView(SimpleNamespace(plan=plan, given=[], now_us=0), History())


def note(view, sent=(), rows=(), packets=(), now_us=0):
    view.engine.now_us = now_us
    made = {"sent": table(w.SENT, *sent), "rows": table(ROW, *rows)}
    view.note({**made, "packets": table(w.PACKET, *packets)})


def packet(time, receivers=1, **more):
    return {"time": time, "end": time, "receivers": receivers, "slots": 25} | more


def texts(view):
    return [item.what["text"] for item in view.history.after(LOG, 0, view.history.newest, 99)]


def test_the_newest_delivery_is_known_whatever_comes_after_it(view):
    note(view, packets=[packet(500, offered=100), packet(900, offered=300), packet(950, 0)])
    assert view.memory.delivered_us == 900
    assert view.memory.delays_us == [400, 600]
    assert view.memory.carried_us == 2 * 25 * view.plan.params["slot_us"]
    note(view)
    note(view, packets=[packet(1_200, 0)])
    assert view.memory.delivered_us == 900
    note(view, packets=[packet(1_300, 2)])
    assert view.memory.delivered_us == 1_300


def test_a_packet_that_nobody_received_is_told(view):
    note(view, packets=[packet(950, 0, node=1)])
    (said,) = texts(view)
    assert said.startswith("station 1: a packet that nobody received counts as delivered")


def test_who_left_is_told_and_who_measures_wrong_delays_is_known(view):
    rows = [{"time": 10, "node": 2, "code": REPORT_LEFT}, {"node": 1, "code": REPORT_BOUNDS}]
    note(view, rows=rows)
    assert texts(view) == ["station 2 left"]
    assert view.memory.wrong == {1}


def test_a_transmission_that_is_broken_off_ends_there(view):
    ta_us = view.plan.params["ta_us"]
    sent = [{"time": 1_000, "end": 9_000, "node": node, "kind": DATA} for node in (0, 1)]
    note(view, sent, [{"time": 4_000 - ta_us, "node": 1, "code": REPORT_STOPPED}])
    ends = {one[2]: one[1] for one in view.memory.air}
    assert ends == {0: 9_000, 1: 4_000 - ta_us}


@pytest.mark.parametrize(("now_us", "left"), [(8_999, 2), (9_000, 1), (9_500, 1), (30_000, 0)])
def test_transmissions_are_shown_when_nothing_can_overlap_them_any_more(view, now_us, left):
    sent = [{"time": 1_000, "end": 9_000, "node": 0, "kind": DATA},
            {"time": 9_000, "end": 20_000, "node": 1, "kind": DATA}]  # fmt: skip
    note(view, sent, now_us=now_us)
    assert len(view.memory.air) == left
    assert view.memory.collisions == 0


def test_two_that_overlap_are_a_collision(view):
    sent = [{"time": 1_000, "end": 9_000, "node": 0, "kind": DATA},
            {"time": 8_999, "end": 20_000, "node": 1, "kind": DATA}]  # fmt: skip
    note(view, sent, now_us=30_000)
    assert view.memory.collisions == 1
