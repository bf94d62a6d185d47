"""What is said and drawn of a radio team, from rows that are written here."""

from types import SimpleNamespace as Of

import numpy as np
import pytest

from innervate.dialect.access import REPORT_DELIVERED
from innervate.networks.radio.plot import charts, scene, words
from innervate.networks.radio.protocol.constants import (
    NO_PROOF,
    REPORT_COLLISION,
    REPORT_FAILED,
    REPORT_ROLE,
)
from innervate.scenario.actions.channel import FADE, GARBLE, JOIN, KILL, LEAVE


@pytest.mark.parametrize(("slots", "said"), [
    (0, "0 slots"), (1, "1 slot"), (0.999, "0.999 slots"), (0.9999, "1 slot"), (99.96, "100 slots"),
    (100, "100 slots"), (100.4, "100 slots"), (99_999.6, "100,000 slots"),
])  # fmt: skip
def test_slots_in_words(slots, said):
    assert words.slots_words(slots) == said


def test_a_time_in_both_units():
    assert words.time_words(131, 208) == "131 slots (27.2 ms)"


@pytest.mark.parametrize(("code", "b", "said"), [
    (REPORT_DELIVERED, 1, "packet delivered"), (REPORT_DELIVERED, 2, "2 packets delivered"),
    (REPORT_FAILED, NO_PROOF, "packet not delivered, stays in the queue: nobody confirmed it"),
    (REPORT_FAILED, 99, "packet not delivered, stays in the queue: reason 99"),
    (REPORT_ROLE, 0, "role after a collision: 4"),
    (REPORT_COLLISION, 9, "own transmission taken for collided"),
])  # fmt: skip
def test_a_report_in_words(code, b, said):
    assert words.report_words("csma-cd-r/practical", code, 4, b) == said


@pytest.mark.parametrize(("action", "said"), [
    (JOIN, "switched on"), (KILL, "switched off without warning"), (LEAVE, "told to leave"),
    (GARBLE, "next 3 CR-Rs garbled"), (FADE, "next 3 CR-Rs not heard by anybody"),
])  # fmt: skip
def test_an_event_in_words(action, said):
    assert words.fault_words(Of(action=action, node=2, value=3)) == f"station 2: {said}"
    one = said.replace("3 CR-Rs", "CR-R")
    assert words.fault_words(Of(action=action, node=2, value=1)) == f"station 2: {one}"


def test_what_became_of_packets_of_robots_that_were_off():
    assert words.off_words({}) == []
    assert words.off_words({"abandoned": 1, "waited_off": 1}) == [
        "Not counted: 1 packet of robots that were off or had left at the end.",
        "1 packet waited while its robot was off; delays leave them out.",
    ]
    assert "while its robot" in words.off_words({"abandoned": 2, "waited_off": 1})[1]
    assert words.off_words({"abandoned": 0, "waited_off": 2}) == [
        "2 packets waited while their robots were off; delays leave them out."
    ]


def packets(*rows):
    return np.array(list(rows), [(name, int) for name in ("node", "offered", "end", "time")])


def result_of(stations=3, rows=(), faults=(), saturated=False):
    kinds = [(name, int) for name in ("time", "node", "code", "a", "b")]
    plan = Of(stations=stations, faults=list(faults), protocol="csma-cd-r/practical",
              saturated=saturated,
              params={"slot_us": 100, "packet_slots": 5, "ta_us": 0})  # fmt: skip
    return Of(plan=plan, rows=np.array(list(rows), kinds), ended_us=9_000_000)


def test_a_bar_for_every_station_and_the_even_share(monkeypatch):
    monkeypatch.setattr(charts.packets, "settled", lambda _: packets((0, 0, 1, 1), (2, 0, 1, 1),
                                                                   (2, 0, 1, 1)))  # fmt: skip
    made = charts.shares(result_of(), {"jain": 0.6, "jain_round": None})
    assert [(bar.name, bar.value) for bar in made.bars] == [
        ("station 0", 1), ("station 1", 0), ("station 2", 2)]  # fmt: skip
    assert (made.even, made.text) == (1.0, "Jain's index 0.6000; 1 is even.")
    both = charts.shares(result_of(), {"jain": 0.6, "jain_round": 0.5})
    assert both.text.endswith("Over one round of 3 turns: 0.500.")
    full = charts.shares(result_of(saturated=True), {"jain": None, "jain_round": None})
    assert full.text == "Without the first tenth of all packets."
    monkeypatch.setattr(charts.packets, "settled", lambda _: packets((0, 0, 1, 1)))
    assert charts.shares(result_of(1), {"jain": None, "jain_round": None}).even is None


def test_who_was_never_served_is_said(monkeypatch):
    monkeypatch.setattr(charts.packets, "timed", lambda _: packets((2, 0, 1, 1)))
    monkeypatch.setattr(charts.radio, "delays", lambda _: np.array([7.0]))
    found = [(bar.value, bar.words) for bar in charts.waits(result_of()).bars]
    assert found == [(0.0, "never"), (0.0, "never"), (7.0, "7 slots")]


@pytest.mark.parametrize(("quantiles", "names"), [
    ((1.0, 5.0, 9.0), ["half", "95 %", "99 %"]), ((5.0, 5.0, 5.0), ["half"]),
    ((1.0, 5.0, 5.004), ["half", "95 %"]), ((1.0, 5.0, 5.006), ["half", "95 %", "99 %"]),
    ((5.0, 5.0, 9.0), ["half", "99 %"]),
])  # fmt: skip
def test_quantiles_that_coincide_have_one_mark(monkeypatch, quantiles, names):
    monkeypatch.setattr(charts.radio, "delays", lambda _: np.array([9.0, 1.0]))
    delay = dict(zip(("p50", "p95", "p99"), quantiles, strict=True))
    made = charts.delays(result_of(), {"delay_slots": delay})
    assert [mark.label for mark in made.marks] == names
    assert charts.delays(result_of(), {"delay_slots": {"p50": None}}) is None


def test_faults_are_marked_where_the_drawing_is(monkeypatch):
    faults = [Of(at_us=at * 1_000_000, action=KILL, node=1, value=0) for at in (0, 2, 3, 6, 7)]
    steps = Of(time_us=np.array([2e6, 4e6]), values=np.array([0.5, 1.0]))
    monkeypatch.setattr(charts.airtime, "airtime_steps", lambda *_: steps)
    made = charts.filled(result_of(faults=faults), 2)
    assert (made.x.low, made.x.high) == (2.0, 6.0)
    assert [mark.at for mark in made.marks] == [2.0, 3.0, 6.0]
    assert made.values.tolist() == [50.0, 100.0]


WHOLE = scene.Window(1_000, 9_000, 2_000)


@pytest.mark.parametrize(("given", "window"), [
    ((None, None, None), WHOLE), ((2_000, None, None), (2_000, 9_000, 2_000)),
    ((2_001, None, None), (2_001, 9_000, 2_001)), ((None, 2_000, None), (1_000, 2_000, 1_000)),
    ((None, 2_001, None), (1_000, 2_001, 2_000)), ((3_000, 4_000, 5), (3_000, 4_000, 5)),
])  # fmt: skip
def test_slots_are_counted_from_the_first_collision_where_it_is_shown(monkeypatch, given, window):
    monkeypatch.setattr(scene, "resolution", lambda _: WHOLE)
    assert scene._window(None, *given) == window
    for high in (1_000, 999):
        with pytest.raises(ValueError, match="must end after it begins"):
            scene._window(None, 1_000, high, None)


def test_of_too_many_stations_those_that_send_first_have_lanes():
    on_air = Of(node=np.array([7, 200, 3, 7, 9]))
    most = scene.LANES_MAX
    assert scene._lanes(result_of(most), on_air, [0]) == tuple(range(most))
    assert scene._lanes(result_of(most + 1), on_air, np.array([1, 2, 3, 0])) == (3, 7, 200)


def test_of_too_many_that_send_the_first_have_lanes(monkeypatch):
    monkeypatch.setattr(scene, "LANES_MAX", 2)
    on_air = Of(node=np.array([7, 200, 3, 7, 9]))
    assert scene._lanes(result_of(300), on_air, np.arange(5)) == (7, 200)


@pytest.mark.parametrize(("served", "last"), [
    ([(0, 900, 1_900, 1_850), (0, 900, 3_000, 2_950), (1, 1_500, 2_500, 2_450)], 2_450),
    ([(0, 900, 1_900, 1_850), (1, 1_501, 2_500, 2_450)], 1_850),  # offered after it
    ([(0, 900, 1_000, 950), (1, 900, 1_001, 990)], 1_500),
    ([(0, 900, 60_000, 59_000)], 1_000 + 40 * 500), ([], 1_000 + 40 * 500),
])  # fmt: skip
def test_a_resolution_ends_as_all_who_waited_are_served(monkeypatch, served, last):
    """The first of three groups that collides is on the air from 1000 to 1500 us."""
    monkeypatch.setattr(scene, "PACKETS_MAX", 40)
    monkeypatch.setattr(scene, "air", lambda _: Of(start=np.array([1])))
    struck = Of(collision=np.array([False, True, True]), start=np.array([0, 1_000, 7_000]),
                end=np.array([500, 1_500, 8_000]))  # fmt: skip
    monkeypatch.setattr(scene, "groups", lambda *_: struck)
    monkeypatch.setattr(scene, "successes", lambda _: packets(*served))
    edge = max(round(scene.MARGIN * (last - 1_000)), 100)
    assert scene.resolution(result_of()) == (1_000 - edge, last + edge, 1_000)


def test_what_is_noted_of_a_stretch():
    rows = [(at, node, code, 1, NO_PROOF) for at, node, code in (
        (99, 0, REPORT_DELIVERED), (100, 0, REPORT_DELIVERED), (150, 1, REPORT_COLLISION),
        (150, 1, REPORT_FAILED), (150, 2, REPORT_FAILED), (199, 1, REPORT_FAILED),
        (160, 1, REPORT_ROLE), (200, 0, REPORT_DELIVERED),
    )]  # fmt: skip
    notes = scene._notes(result_of(rows=rows), scene.Window(100, 200, 100))
    assert [(note.at_us, note.station, note.kind) for note in notes] == [
        (100, 0, scene.DONE), (150, 1, scene.NOTICED), (150, 2, scene.FAILED),
        (199, 1, scene.FAILED),
    ]  # fmt: skip


@pytest.mark.parametrize(("length", "ends", "part"), [
    (7_999, [], None), (8_000, [], (0, 2_400)), (10_000, [1_500], (28, 1_545)),
    (10_000, [2_900], (0, 2_987)), (10_000, [2_950], (0, 3_000)),
    (10_000, [1_500, 9_000], (28, 1_545)), (10_000, [50, 1_500], (28, 1_545)),
])  # fmt: skip
def test_a_beginning_goes_to_the_first_success_or_a_third(monkeypatch, length, ends, part):
    """Of 100 us a slot; the first collision is at 100, near the left."""
    found = packets(*((0, 0, end, end) for end in ends)) if ends else packets()
    monkeypatch.setattr(scene, "successes", lambda _: found)
    begin = scene.beginning(result_of(), scene.Window(0, length, 100))
    assert (begin and tuple(begin)) == (part and (*part, 100))
