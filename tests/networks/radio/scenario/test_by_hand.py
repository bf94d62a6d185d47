"""Stations, their delays and what each medium access is granted: both sides of each edge."""

import re

import pytest

from innervate.networks.radio.scenario.baselines import DRAWS, NUMBERS, baseline
from innervate.networks.radio.scenario.plan import parameters
from innervate.networks.radio.scenario.rules import outside
from innervate.networks.radio.scenario.words import traffic_words
from innervate.scenario import ScenarioError, from_dict, plan

TEAM = {"kind": "radio", "stations": 4, "duration_s": 2.0, "packet_slots": 5}


def loaded(**tables):
    return from_dict(TEAM | tables)


@pytest.mark.parametrize(("tables", "words"), [
    ({"packet_slots": 3}, ""),
    ({"packet_slots": [3, 250]}, ""),
    ({"packet_slots": 250}, ""),
    ({"packet_slots": [2, 250]}, "packet_slots must be 3 to 250 slots, not 2"),
    ({"packet_slots": [3, 251]}, "packet_slots must be 3 to 250 slots, not 251"),
    ({"channel": {"tau_us": [50, 100]}}, ""),
    ({"channel": {"tau_us": [50, 101]}}, "within a factor of two, not 50 to 101 us"),
    ({"channel": {"tau_us": [50, 101]}, "protocol": {"tau_bounds_us": [51, 101]}}, ""),
    ({"channel": {"tau_us": [50, 101]}, "protocol": {"mode": "paper"}}, ""),
    ({"channel": {"tau_us": [50, 101]}, "protocol": {"mac": "dcf"}}, ""),
    ({"channel": {"tau_us": [104, 207]}}, ""),
    ({"channel": {"tau_us": [104, 208]}}, "by less than half a slot (104 us), not 104 to 208 us"),
    ({"protocol": {"tau_bounds_us": [1, 2]}}, ""),
    ({"protocol": {"tau_bounds_us": [0, 2]}}, "tau_bounds_us must be [least, most] from 1, not"),
    ({"protocol": {"tau_bounds_us": [3, 2]}}, "tau_bounds_us must be [least, most] from 1, not"),
    ({"protocol": {"cw_min": 32, "cw_max": 32}}, ""),
    ({"protocol": {"cw_min": 33, "cw_max": 32}}, "protocol.cw_min = 33 is above cw_max = 32"),
    ({"stations": 120}, ""),
    ({"stations": 121}, "has 120 places in a round, too few for 121 stations"),
    ({"stations": 121, "protocol": {"mode": "paper"}}, ""),
    ({"channel": {"hidden": [[0, 3]]}}, ""),
    ({"channel": {"hidden": [[0, 4]]}}, "there is no station 4; they are numbered 0 to 3"),
    ({"channel": {"hidden": [[4, 0]]}}, "there is no station 4; they are numbered 0 to 3"),
    ({"channel": {"hidden": [[1, 1]]}}, "station 1 cannot be hidden from itself; name two"),
    ({"protocol": {"per_turn": 2}}, ""),
    ({"protocol": {"per_turn": 2, "mac": "polling"}}, ""),
    ({"protocol": {"per_turn": 2, "mode": "paper"}}, "protocol.per_turn goes with csma-cd-r in"),
    ({"protocol": {"per_turn": 2, "mac": "dcf"}}, "protocol.per_turn goes with csma-cd-r in"),
    *[({"protocol": {"received_by": "everybody", "mac": mac}}, words) for mac, words in (
        ("dcf", ""), ("csma-cd-d2", ""), ("tdma", ""), ("polling", ""),
        ("csma-cd-r", "whose senders are told who received their packets, not csma-cd-r"),
        ("csma-cd-d1", "whose senders are told who received their packets, not csma-cd-d1"))],
    ({"protocol": {"received_by": "anybody"}}, ""),
    ({"protocol": {"answers": "turnaround", "mac": "dcf"}}, ""),
    ({"protocol": {"answers": "turnaround", "mac": "tdma"}}, "answers goes with dcf, not tdma"),
    ({"protocol": {"answers": "instant", "mac": "tdma"}}, ""),
    ({"traffic": {"start_s": 1.99}}, ""),
    ({"traffic": {"start_s": 2.0}}, "traffic.start_s = 2 is after the end (2 s)"),
    ({"traffic": {"start_s": 2.0, "kind": "saturated"}}, ""),
    ({"traffic": {"spread_us": 1, "kind": "poisson"}}, 'spread_us goes with kind = "disaster"'),
    ({"event": [{"at_s": 1.0, "action": "kill", "station": 3}]}, ""),
    ({"event": [{"at_s": 1.0, "action": "kill", "station": 4}]}, "there is no station 4"),
    ({"event": [{"at_s": 1.0, "action": "kill", "station": -1}]}, "there is no station -1"),
    ({"event": [{"at_s": 1.0, "action": "fade", "station": 1, "frames": 1_000_000}]}, ""),
    ({"event": [{"at_s": 1.0, "action": "fade", "station": 1, "frames": 0}]}, "frames must be 1"),
    ({"event": [{"at_s": 1.0, "action": "fade", "station": 1, "frames": 1_000_001}]}, "frames mu"),
])  # fmt: skip
def test_what_just_can_be_is_taken_and_what_cannot_is_refused(tables, words):
    if not words:
        loaded(**tables)
        return
    with pytest.raises(ScenarioError, match=re.escape(words)):
        loaded(**tables)


@pytest.mark.parametrize(("real", "believed", "wrong"), [
    ([52, 104], None, False), ([52, 104], [52, 104], False), ([52, 104], [53, 104], True),
    ([52, 104], [52, 103], True), (52, [52, 52], False), (53, [52, 52], True),
])  # fmt: skip
def test_delays_that_stations_do_not_believe(real, believed, wrong):
    protocol = {"mode": "paper"} | ({} if believed is None else {"tau_bounds_us": believed})
    assert outside(loaded(channel={"tau_us": real}, protocol=protocol).model) == wrong


def test_who_is_hidden_hears_nothing_either_way():
    delays = plan(loaded(channel={"hidden": [[2, 0]], "tau_us": 60})).delays_us
    assert delays == [[0, 60, -1, 60], [60, 0, 60, 60], [-1, 60, 0, 60], [60, 60, 60, 0]]


@pytest.mark.parametrize(("events", "absent", "wanted"), [
    ([], [0, 0, 0, 0], 4),
    ([("join", 1)], [0, 1, 0, 0], 4),
    ([("leave", 1), ("join", 1)], [0, 0, 0, 0], 0),
    ([("join", 1), ("leave", 1)], [0, 1, 0, 0], 0),
    ([("kill", 1), ("join", 2)], [0, 0, 1, 0], 0),
    ([("fade", 1), ("join", 2), ("garble", 3)], [0, 0, 1, 0], 4),
])  # fmt: skip
def test_who_joins_first_is_away_and_who_goes_may_keep_its_packet(events, absent, wanted):
    event = [{"at_s": 0.1 * (k + 1), "action": action, "station": station}
             for k, (action, station) in enumerate(events)]  # fmt: skip
    made = plan(loaded(event=event))
    assert made.absent == absent
    assert made.wanted == wanted
    assert [fault.value for fault in made.faults] == [
        int(action in ("fade", "garble")) for action, _ in events
    ]


def test_events_are_in_order_of_time_then_of_the_file():
    event = [{"at_s": at_s, "action": "fade", "station": station}
             for at_s, station in ((1.0, 3), (0.5, 2), (1.0, 0), (0.5, 1))]  # fmt: skip
    faults = plan(loaded(event=event)).faults
    assert [(fault.node, fault.index) for fault in faults] == [(2, 1), (1, 3), (3, 0), (0, 2)]


def test_what_is_wanted_of_other_traffic():
    assert plan(loaded(traffic={"kind": "saturated", "packets": 7})).wanted == 28
    assert plan(loaded(traffic={"kind": "poisson", "load": 0.5})).wanted == 0


def test_one_packet_each_is_told_as_one():
    for packets, said in ((1, "1 packet per station"), (1200, "1,200 packets per station")):
        saturated = loaded(traffic={"kind": "saturated", "packets": packets}).model
        assert traffic_words(saturated) == f"saturated, {said}"


def test_all_are_set_to_the_longest_packet():
    assert plan(loaded(packet_slots=[5, 9])).params["packet_slots"] == 9
    lengths = {one for sizes in plan(loaded(packet_slots=[5, 9])).sizes for one in sizes}
    assert lengths == {5, 6, 7, 8, 9}
    assert plan(loaded()).sizes == [[5]] * 4


def test_what_each_medium_access_is_granted():
    """Slots of 208 us, 26 a bit; a turnaround of 30 us and delays of up to 104 us."""
    params = parameters(5, 30, (52, 104))
    periods = {
        "slotted-aloha": 30 + 1040 + 104 + 26, "tree": 30 + 1040 + 104 + 26,
        "tdma": 1040 + 208, "nonpersistent": 208, "p-persistent": 208,
    }  # fmt: skip
    for mac, number in NUMBERS.items():
        made = baseline(mac, 9, params)
        cable = mac == "csma-cd-d1"
        assert (made["mac"], made["stations"]) == (number, 9)
        assert made["ta_us"] == (0 if cable else 30)
        assert (made["oracle"], made["full_duplex"]) == (int(not cable), int(cable))
        assert made["period_us"] == periods.get(mac, 0)
        assert made["gap_us"] == 208 - 104
        assert made["answer_us"] == (416 if mac == "dcf" else 0)
        assert made["backoff_us"] == 208
        assert made["p_q15"] == 3277
    slow = params | {"ta_us": 150, "dmax_us": 200}
    assert baseline("tree", 9, slow)["period_us"] == 150 + 1040 + 200 + 26
    assert baseline("tree", 9, slow | {"ta_us": 250})["period_us"] == 250 + 1040 + 250 + 26
    assert baseline("tdma", 9, slow)["period_us"] == 1040 + 350
    assert baseline("nonpersistent", 9, slow)["period_us"] == 350
    assert baseline("tdma", 9, slow)["gap_us"] == 26
    draws = DRAWS._replace(p=1e-9, cw_min=4, cw_max=8, backoff_slots=3)
    made = baseline("dcf", 9, params, draws)
    assert (made["p_q15"], made["cw_min"], made["cw_max"], made["backoff_us"]) == (1, 4, 8, 624)
