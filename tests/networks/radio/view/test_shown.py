"""What pages are shown of a radio team, by tables that are written here; nothing is run."""

from collections import namedtuple
from types import SimpleNamespace as Of

import numpy as np
import pytest

from innervate.networks.radio.protocol.constants import CRR, DATA, OPEN, REPORT
from innervate.networks.radio.view import live
from innervate.networks.radio.view.view import RadioView
from innervate.scenario.actions.channel import JOIN, KILL, LEAVE
from innervate.sim.channel import world as w
from innervate.sim.heap import AIRS
from innervate.sim.tables import ROW
from innervate.web.engine import engine_of
from innervate.web.errors import Refused
from innervate.web.history import LOG, TIMELINE, History
from innervate.web.messages import Cut, Kill, Revive
from tests.networks.radio.view.test_radio_view import packet, table
from tests.web.runs import plan_of

TEAM = {"kind": "radio", "stations": 5, "duration_s": 1.0}


def viewed(**tables):
    return RadioView(engine_of(plan_of({**TEAM, **tables})), History())


@pytest.fixture
def view():
    return viewed()


def note(view, now_us=0, **rows):
    fields = {"sent": w.SENT, "rows": ROW, "packets": w.PACKET}
    view.engine.now_us = now_us
    view.note({name: table(columns, *rows.get(name, ())) for name, columns in fields.items()})


def items(view, what):
    return [one.what for one in view.history.after(what, 0, view.history.newest, 99)]


def test_what_every_station_does_now(view):
    world = view.engine.world
    radios, stations = world.radios, world.stations
    radios["alive"][:5] = (1, 1, 1, 1, 0)
    view.engine.now_us = 1
    stations["queued"][:] = (0, 4, 4, 4, 4)
    radios["present"][:5] = (0, 0, 1, 2, 1)
    assert view.arrays(False)["radio"]["now"] == [0, 4, 2, 3, 0]
    radios["deaf"][2] = 1
    sent = world.air.reshape(-1, AIRS)[2]
    sent["start"][1], sent["end"][1] = 1_000, 2_000
    doing = []
    for view.engine.now_us in (999, 1_000, 2_000, 2_001):
        doing.append(view.arrays(False)["radio"]["now"][2])
    assert doing == [5, 1, 1, 5]  # it hears nothing while its radio turns round, and sends nothing
    view.engine.now_us = 1_500
    shown = view.arrays(False)
    assert shown["radio"]["now"] == [0, 4, 1, 3, 0]
    assert shown["node_up"].tolist() == [1, 1, 1, 1, 0]
    assert (shown["unconnected"], shown["load"].tolist()) == (1, [0, 0.25, 0.25, 0.25, 0.25])


def test_who_left_the_team_is_told_from_who_was_switched_off(view):
    radios = view.engine.world.radios
    radios["alive"][:5] = (1, 1, 0, 0, 0)
    radios["leaving"][:5] = (0, 1, 0, 1, 2)
    view.engine.now_us = 1
    shown = view.arrays(False)
    assert (shown["unconnected"], shown["away"]) == (1, 2)
    assert shown["node_up"].tolist() == [1, 1, 0, 0, 0]
    assert shown["absent"].tolist() == [0, 0, 0, 1, 1]


def test_before_all_the_stations_of_a_team_are_on_and_can_be_switched_off():
    view = viewed(event=[{"at_s": 0.5, "action": "join", "station": 3}])
    assert view.engine.now_us == 0
    shown = view.arrays(False)
    assert shown["node_up"].tolist() == [1, 1, 1, 0, 1]
    assert (shown["unconnected"], shown["away"]) == (0, 1)
    assert view.kill(0, False)["node"] == 0
    with pytest.raises(Refused, match="is on"):
        view.kill(0, True)


@pytest.mark.parametrize(("mode", "name"), [("practical", "pos"), ("paper", "place")])
def test_whose_turn_is_when(mode, name):
    view = viewed(protocol={"mode": mode})
    view.engine.world.stations[name][:] = (3, 0, 2, 0, 1)
    assert view.arrays(False)["radio"]["turn"] == [3, 0, 2, 0, 1]


def test_where_nobody_has_a_place_none_is_shown():
    assert viewed(protocol={"mac": "dcf"}).arrays(False)["radio"]["turn"] == [-1] * 5


def test_points_are_of_the_time_since_the_last(view):
    slot_us = int(view.plan.params["slot_us"])
    packets = [packet(900, offered=100), packet(1_000, offered=400), packet(1_000, 0, offered=0)]
    note(view, 40 * slot_us, packets=packets)
    view.memory.collisions = 3
    point = view.points()
    # Of 50 slots of packets that came, 40 have passed; the rest counts next time.
    assert point["throughput"] == 100.0
    assert point["collisions"] == round(3e6 / (40 * slot_us), 2)
    assert point["delay"] == 0.7  # ms, of what was received
    view.engine.now_us = 80 * slot_us
    assert view.points() == {"throughput": 25.0, "collisions": 0.0, "delay": None}
    view.engine.now_us = 120 * slot_us
    assert view.points() == {"throughput": 0.0, "collisions": 0.0, "delay": None}


def sent(start, end, node, kind=DATA):
    return {"time": start, "end": end, "node": node, "kind": kind}


@pytest.mark.parametrize(
    ("frames", "kinds", "collisions", "said"),
    [
        ([sent(10, 90, 0), sent(90, 120, 1, REPORT)], ["frame", "ack"], 0, []),
        ([sent(10, 90, 0), sent(89, 120, 1)], ["collision"] * 2, 1,
         ["collision of stations 0, 1"]),
        ([sent(10, 90, 0, OPEN), sent(20, 40, 1, CRR)], ["collision", "cr"], 1,
         ["collision of stations 0, 1"]),
        ([sent(10, 90, 0, CRR), sent(20, 40, 1, CRR)], ["cr", "cr"], 0, []),
        # The first outlasts the second and meets the third.
        ([sent(10, 90, 0), sent(20, 40, 1), sent(60, 99, 2)], ["collision"] * 3, 1,
         ["collision of stations 0, 1, 2"]),
        ([sent(60, 99, 2), sent(10, 50, 0)], ["frame"] * 2, 0, []),
        ([sent(10, 90, k % 5) for k in range(6)], ["collision"] * 6, 1,
         ["collision of stations 0, 0, 1, 2, 3, 4"]),
        ([sent(10, 90, k % 5) for k in range(7)], ["collision"] * 7, 1,
         ["collision of stations 0, 0, 1, 1, 2, 3, ..."]),
    ],
)  # fmt: skip
def test_frames_that_overlap_have_collided(view, frames, kinds, collisions, said):
    note(view, 500, sent=frames)
    shown = items(view, TIMELINE)
    assert [one["kind"] for one in shown] == kinds
    assert [one["from_s"] for one in shown] == sorted(one["time"] / 1e6 for one in frames)
    assert view.memory.collisions == collisions
    assert [one["text"] for one in items(view, LOG)] == said
    note(view, 900)
    assert (len(items(view, TIMELINE)), view.memory.air) == (len(frames), [])


@pytest.mark.parametrize(("at", "end"), [(4_000, 4_000), (500, 1_000), (9_000, 9_000), (0, 1_000)])
def test_a_death_ends_what_is_sent_and_what_is_decided(view, at, end):
    """What begins within a turnaround was decided; what is over or begins later is left alone."""
    ta_us = view.plan.params["ta_us"] = 600
    view.memory.air = [[1_000, 9_000, 1, DATA], [1_000, 9_000, 2, DATA], [9_700, 9_900, 1, DATA]]
    view._stop(1, at)
    own = end if at < 9_000 and at + ta_us >= 1_000 else 9_000
    assert [one[1] for one in view.memory.air] == [own, 9_000, 9_900]


def test_those_who_are_switched_off_break_off_and_others_do_not(view):
    for action in (JOIN, LEAVE, KILL):
        view.memory.air = [[1_000, 9_000, 1, DATA]]
        view.memory.told_us = view.engine.now_us = 4_000
        view.engine.given = [view.make(4_000, 0, {"action": action, "node": 1})]
        note(view, 4_001)
        assert view.memory.air == ([] if action == KILL else [[1_000, 9_000, 1, DATA]])
        assert [one["to_s"] for one in items(view, TIMELINE)] == [0.004] * (action == KILL)
        assert view.memory.recovery is None  # a team has nothing to recover


def test_switches_and_what_is_refused(view):
    alive = view.engine.world.radios["alive"]
    alive[:5] = (1, 0, 1, 1, 1)
    view.engine.now_us = 1
    made = view.fault(Kill(0))
    assert (made.action, made.node, view.takes(made), view.event(made)) == (
        KILL, 0, True, {"station": 0})  # fmt: skip
    made = view.fault(Revive(1))
    assert (made.action, made.node, view.takes(made)) == (JOIN, 1, False)
    for command, words in ((Kill(1), "is off already"), (Revive(0), "this station is on"),
                           (Kill(5), "no station 5"), (Cut(0), "no links to cut")):  # fmt: skip
        with pytest.raises(Refused, match=words):
            view.fault(command)


@pytest.mark.parametrize(("now_us", "complete", "ended"), [(999_999, False, False),
                                                           (1_000_000, False, True),
                                                           (5, True, True)])  # fmt: skip
def test_a_headline_is_of_what_is_known_now(view, monkeypatch, now_us, complete, ended):
    seen = []
    monkeypatch.setattr("innervate.networks.radio.view.view.headline", seen.append)
    view.engine.now_us, view.engine.running.is_complete = now_us, lambda: complete
    view.headline()
    view.memory.wrong = {3, 1}
    view.headline()
    assert [one.ended for one in seen] == [ended] * 2
    assert [one.stations_wrong for one in seen] == [(), (1, 3)]


FACTS = namedtuple("Facts", "wrong bounds stations_wrong")((), {}, ())


class Said(live.RadioState):
    """Stations that say these words; those without are off."""

    def __init__(self, *words):
        self.words = words
        self.node_up = np.array([int(one is not None) for one in words])
        self.map = type("Map", (), {"places": range(len(words))})

    def word(self, place, name, default):
        return (self.words[place] or {}).get(name, default)


def test_what_running_stations_do():
    state = Said({"queued": 0, "place": 0, "radio": "idle"}, {"queued": 8, "radio": "sending"},
                 {"queued": 4, "place": 3}, None)  # fmt: skip
    assert state.look() == (1, 0, 3)
    shown = state.more()
    assert shown["radio"] == {"now": [0, 1, 4, 0], "turn": [0, -1, 3, -1]}
    assert shown["load"].tolist() == [0, 0.5, 0.25, 0]


def test_for_how_long_nothing_was_delivered_is_noted():
    view, state = live.RadioLiveView(), Said({"queued": 1})
    told = {0: {"queued": 1, "counters": {}}}
    view._still.note = lambda now_us, words: (now_us, list(words))
    view.note(state, 77, told)
    assert state.still_ms == (77, [told[0]])


def test_running_stations_are_judged_by_what_those_that_are_on_say(monkeypatch):
    seen = []
    monkeypatch.setattr(live, "of_stations", lambda *given: given)
    monkeypatch.setattr(
        live, "headline", lambda facts, label, absent: seen.append((*facts, label(2), absent))
    )
    state = Said({"timing": "exact"}, None, {"timing": "exact"})
    state.map.places = [Of(node=node) for node in (4, 5, 6)]
    state.map.names = ["left", "middle", "right"]
    state.told, state.still_ms = {4: state.words[0], 6: state.words[2]}, 7.0
    state.judge()
    told = {0: state.words[0], 2: state.words[2]}
    assert seen == [(told, 3, (1,), 7.0, "exact", "right", "silent")]
    assert live.RadioState.is_off_when_cut  # over the air nobody is half cut off


def test_a_headline_knows_of_faults_that_were_given_by_hand(view, monkeypatch):
    def facts(*_, faults, ended):
        return FACTS._replace(wrong=(faults, ended))

    seen = []
    monkeypatch.setattr("innervate.networks.radio.view.view.headline", seen.append)
    monkeypatch.setattr("innervate.networks.radio.view.view.facts", facts)
    view.engine.given = ["one"]
    view.headline()
    assert seen[0].wrong == (["one"], False)
