"""Networks of one's own over a field: places, who hears whom how well, events, what is refused.

What is heard is worked out here from the keys: 10 * exponent * log10 of the distance, the level at
`reach_m` from that at which half of the frames are received, 95 % of them 3 dB above it.
"""

import math

import pytest

from innervate import scenario as scenarios
from innervate.scenario.actions.field import ACTIONS
from innervate.scenario.declared.field import describe, event, fault_words
from innervate.scenario.errors import ScenarioError

LINE = {"kind": "flooding", "nodes": 3, "layout": "line", "duration_s": 2.0}
HALF_DBM, GOOD_DB = -95, 3


def planned(**changes):
    return scenarios.plan(scenarios.from_dict(LINE | changes))


def heard(made, a, b):
    place = a * made.nodes + b
    return made.heard.rssi_cdb[place], made.heard.prob_q15[place]


@pytest.mark.parametrize(
    ("layout", "places"),
    [
        ({"layout": "line", "spacing_m": 1.5}, [(150 * k, 0) for k in range(5)]),
        ({"layout": "grid", "spacing_m": 2}, [(0, 0), (200, 0), (400, 0), (0, 200), (200, 200)]),
        ({"positions_m": [[0.014, 3], [1, 1], [2, 2], [3, 3], [4, -4.006]]},
         [(1, 300), (100, 100), (200, 200), (300, 300), (400, -401)]),
    ],
)  # fmt: skip
def test_where_nodes_lie(layout, places):
    assert planned(nodes=5, **layout).positions_cm == places


@pytest.mark.parametrize(("nodes", "columns"), [(2, 2), (4, 2), (5, 3), (9, 3), (10, 4)])
def test_a_grid_is_as_near_a_square_as_can_be(nodes, columns):
    places = planned(nodes=nodes, layout="grid", spacing_m=1).positions_cm
    assert places == [(100 * (k % columns), 100 * (k // columns)) for k in range(nodes)]


def test_drawn_places_are_in_the_square_and_of_the_seed():
    made = planned(nodes=200, layout="random", side_m=7)
    places = made.positions_cm
    assert all(0 <= one <= 700 for place in places for one in place)
    assert max(x for x, _ in places) > 650 > 50 > min(y for _, y in places)
    assert planned(nodes=200, layout="random", side_m=7).positions_cm == places
    assert planned(nodes=200, layout="random", side_m=7, seed=2).positions_cm != places


@pytest.mark.parametrize("exponent", [2.0, 3.0, 4.5])
def test_at_the_reach_95_of_100_frames_are_received(exponent):
    air = {"reach_m": 40, "exponent": exponent}
    made = planned(positions_m=[[0, 0], [40, 0], [0, 80]], air=air)
    rssi, chance = heard(made, 0, 1)
    assert rssi == 100 * (HALF_DBM + GOOD_DB)
    assert chance / 32_768 == pytest.approx(0.953, abs=0.001)
    far = 100 * (HALF_DBM + GOOD_DB - 10 * exponent * math.log10(2))
    rssi, chance = heard(made, 0, 2)
    assert rssi == pytest.approx(far, abs=6)
    over_db = math.floor((rssi / 100 - HALF_DBM) * 10 + 0.5) / 10
    received = 1 / (1 + math.exp(-over_db))
    assert chance == (round(32_768 * received) if received >= 0.01 else 0)
    assert heard(made, 2, 0) == (rssi, chance)
    assert made.good == [(0, 1)] + [(0, 2)] * (rssi >= 100 * HALF_DBM)
    for node in range(3):
        assert heard(made, node, node)[1] == 0


def test_who_receives_less_than_one_in_a_hundred_is_out_of_reach():
    # A tenth of a dB is 1.6 % of the distance at exponent 3; 1 % are received at -4.6 dB.
    chances = []
    for k in range(40):
        metres = 30 * 10 ** ((GOOD_DB + 3 + k / 10) / 30)
        chances.append(heard(planned(nodes=2, positions_m=[[0, 0], [metres, 0]]), 0, 1)[1])
    there = [chance for chance in chances if chance]
    assert chances == there + [0] * (40 - len(there))
    assert len(there) in (15, 16, 17)
    assert 328 <= min(there) < 370
    assert there == sorted(there, reverse=True)


def test_shadowing_is_drawn_once_for_a_pair_about_its_loss():
    spots = [[3 * k, 0] for k in range(30)]
    plain, drawn = (planned(nodes=30, positions_m=spots, air={"shadowing_db": db})
                    for db in (0, 4))  # fmt: skip
    pairs = [(a, b) for a in range(30) for b in range(a)]
    off = [(heard(drawn, *pair)[0] - heard(plain, *pair)[0]) / 100 for pair in pairs]
    assert all(heard(drawn, a, b) == heard(drawn, b, a) for a, b in pairs)
    assert abs(sum(off) / len(off)) < 0.6
    assert math.sqrt(sum(one * one for one in off) / len(off)) == pytest.approx(4, abs=0.5)


@pytest.mark.parametrize(
    ("quality", "rssi_db", "chance", "is_good"),
    [(1.0, 9.21, 32_768, True), (0.5, 0, 16_384, True), (0.25, -1.10, 8192, False),
     (0.0, -9.21, 0, False)],
)  # fmt: skip
def test_links_are_heard_both_ways_as_they_say(quality, rssi_db, chance, is_good):
    made = planned(link=[{"nodes": [0, 2], "quality": quality}])
    assert made.positions_cm == []
    assert heard(made, 0, 2) == heard(made, 2, 0)
    assert heard(made, 0, 2) == (round(100 * (HALF_DBM + rssi_db)), chance)
    assert heard(made, 0, 1)[1] == heard(made, 1, 2)[1] == 0
    assert made.good == [(0, 2)] * is_good


def test_when_nodes_are_switched_on_and_who_is_absent():
    made = planned(nodes=200, start_us=10, absent=[3, 199])
    assert set(made.starts_us) == set(range(10))
    assert [node for node in range(200) if made.absent[node]] == [3, 199]
    assert set(planned(nodes=9, start_us=1).starts_us) == {0}
    assert made.duration_us == 2_000_000


HAPPENING = [
    ({"action": "kill", "node": 2}, (2, -1, 0), "at 1 s kill node 2"),
    ({"action": "cut", "node": 0, "other": 1}, (0, 1, 0), "at 1 s cut node 0 - node 1"),
    ({"action": "restore", "node": 1, "other": 0}, (1, 0, 0), "at 1 s restore node 1 - node 0"),
    ({"action": "jam", "node": 1, "noise_dbm": -60.5}, (1, -1, -6050),
     "at 1 s jam node 1 with -60.5 dBm"),
    ({"action": "quiet", "node": 1}, (1, -1, 0), "at 1 s quiet node 1"),
]  # fmt: skip


@pytest.mark.parametrize(("table", "is_to", "words"), HAPPENING, ids=lambda one: str(one)[:30])
def test_an_event_is_planned_told_and_written_again(table, is_to, words):
    made = planned(event=[{"at_s": 1.5, "action": "kill", "node": 0}, {"at_s": 1.0, **table}])
    first, last = made.faults
    assert (first.at_us, first.index, last.at_us, last.index) == (1_000_000, 1, 1_500_000, 0)
    assert ACTIONS[first.action] == table["action"]
    assert (first.node, first.other, first.value) == is_to
    assert fault_words(made, first) == words
    assert event(made, first) == table
    assert words in " ".join(describe(made).split())


def test_a_plan_in_words():
    head, nodes, protocol, *_ = describe(planned(nodes=4, spacing_m=30)).splitlines()
    assert "flooding" in head
    assert nodes == "  nodes      4 in a field, 3 pairs hear each other"
    assert protocol.startswith("  protocol   ")
    _, two, *_ = describe(planned(nodes=2, spacing_m=30)).splitlines()
    assert two == "  nodes      2 in a field, 1 pair hears each other"


@pytest.mark.parametrize(
    ("wrong", "says"),
    [
        ({"positions_m": [[0, 0]]}, "positions_m has 1 places for 3 nodes"),
        ({"air": {"exponent_min": 7, "exponent_max": 6}}, "exponent_min is above exponent_max"),
        ({"link": [{"nodes": [0, 3]}]}, "there is no node 3; they are 0 to 2"),
        ({"link": [{"nodes": [-1, 0]}]}, "there is no node -1"),
        ({"link": [{"nodes": [1, 1]}]}, "node 1 is named twice"),
        ({"absent": [0, 3]}, "there is no node 3"),
        ({"event": [{"at_s": 0, "action": "kill", "node": 3}]}, "there is no node 3"),
        ({"event": [{"at_s": 0, "action": "cut", "node": 1}]}, "cut needs the other node"),
        ({"event": [{"at_s": 0, "action": "kill", "node": 1, "other": 2}]}, "kill has no other"),
        ({"event": [{"at_s": 0, "action": "cut", "node": 1, "other": 1}]}, "named twice"),
        ({"event": [{"at_s": 2, "action": "kill", "node": 1}]}, "is the end of the run"),
        ({"event": [{"at_s": 0, "action": "melt", "node": 1}]}, 'not "melt"'),
    ],
)
def test_what_cannot_be_is_refused(wrong, says):
    with pytest.raises(ScenarioError, match=says):
        planned(**wrong)


def test_what_just_can_be_is_taken():
    planned(air={"exponent_min": 6, "exponent_max": 6})
    planned(link=[{"nodes": [0, 2]}, {"nodes": [2, 0]}], absent=[2])
    planned(event=[{"at_s": 1.999999, "action": "kill", "node": 2}])
