"""What figures of the mesh count, of nodes and runs that are written here."""

from types import SimpleNamespace as Of

import numpy as np
import pytest

from innervate.networks.mesh.papers import (
    alarms,
    comparison,
    gateway,
    lossy,
    stretch,
    testbed,
    uplinks,
)
from innervate.networks.mesh.protocol.constants import DATA, END_TO_END, PRIORITY, REPORT_TABLE
from innervate.networks.mesh.protocol.neighbours import FREE, UNHEARD
from innervate.papers.in_field import MONITOR
from innervate.scenario.actions.field import KILL, REVIVE
from innervate.scenario.robots import Walk
from innervate.topology import placement


def node(depth, first, *heard):
    """A node and whom it heard: (who, depth, RSSI)."""
    near, depths, loud = ([one[i] for one in heard] for i in range(3))
    return Of(depth=depth, parent=first, neighbour=near, round_depth=depths, round_rssi=loud)


GATEWAY = node(0, FREE)


def counted(*nodes, good=()):
    plan = Of(nodes=1 + len(nodes), good=good, params={"min_rssi": -90})
    run = Of(plan=plan, world=Of(nodes=[GATEWAY, *nodes]))
    return uplinks.measure(Of(run=lambda seed: run), 1)


@pytest.mark.parametrize(("heard", "best"), [
    ([(5, 1, -80), (6, 0, -85)], 6), ([(5, 0, -80), (6, 0, -79)], 6),  # nearest, loudest
    ([(5, 0, -91), (6, 1, -90)], 6), ([(5, 0, -91)], 5),  # faint ones if there is no other
    ([(5, 0, -80), (6, 0, -80)], 5), ([(5, 2, -50), (6, 1, -89)], 6),  # not as far as itself
    ([(FREE, 0, -50), (6, 1, -89)], 6), ([(5, UNHEARD, -50), (6, 1, -89)], 6),
    ([(5, 2, -50)], None), ([], None),
])  # fmt: skip
def test_the_best_of_those_nearer_to_the_gateway(heard, best):
    nodes = [node(2, 9, *heard)]
    assert uplinks._best([GATEWAY, *nodes], 1, -90) == best
    assert uplinks._best([GATEWAY, node(UNHEARD, 9, *heard)], 1, -90) is None


def test_whom_a_node_heard_first_is_counted_against_the_best():
    both, other, neither, deaf = (
        node(1, 0, (0, 0, -60)), node(2, 1, (1, 1, -80), (5, 1, -70)), node(2, 1, (1, 1, -80)),
        node(UNHEARD, FREE),
    )  # fmt: skip
    assert counted(both, other, neither, deaf, good=[(0, 1), (2, 5), (4, 0)]) == {
        "nodes": 3, "other": 1, "first": 1, "best": 2,
    }  # fmt: skip
    assert counted(both, other, neither, good=[(1, 2)])["first"] == 1
    assert counted(both, other, neither, good=[(2, 1), (3, 1)])["first"] == 2


@pytest.fixture(scope="module")
def small():
    """A case of ten nodes of whom three die."""
    return comparison.world({"nodes": 10, "rounds": 2, "dead": 3}, 1)


def test_a_world_has_the_plans_radio(small):
    radio = comparison.plan_of({"nodes": 10, "rounds": 2, "dead": 3}, 1).radio
    assert {name: 100 * small.air[name] for name in ("capture_db", "sense_db")} == pytest.approx(
        {"capture_db": radio.capture_cdb, "sense_db": radio.rssi50_cdb - radio.sense_cdb}
    )
    assert {name: small.air[name] for name in ("byte_ns", "phy_bytes", "turnaround_us")} == {
        "byte_ns": radio.byte_ns, "phy_bytes": radio.phy_bytes,
        "turnaround_us": radio.turnaround_us,
    }  # fmt: skip
    assert (small.nodes, small.gateway, small.since_us) == (10, 0, 20_000_000)
    assert small.duration_us == 20_000_000 + 20 * 100_000 + 3_000_000


@pytest.mark.parametrize(("reliable", "flags"), [(True, END_TO_END), (False, 0)])
def test_a_mesh_is_given_what_a_world_sends_and_who_dies_in_it(small, reliable, flags):
    given = {"nodes": 10, "rounds": 2, "dead": 3}
    _, plan = comparison.planned((("reliable", reliable),), (), given, 1)
    assert [(one.at_us, one.node, one.dest) for one in plan.offers] == [
        (one.at_us, one.source, one.dest) for one in small.sent
    ]
    assert {(one.flags, one.length, one.flow) for one in plan.offers} == {(flags, 16, 0)}
    assert [(one.at_us, one.action, one.node) for one in plan.faults] == small.faults
    _, plan = comparison.planned((("reliable", reliable),), (), given | {"alarms": 1}, 1)
    assert {(one.dest, one.flags) for one in plan.offers} == {(254, flags | PRIORITY)}


def test_in_each_round_all_who_live_write_to_another_one(small):
    gone = {node for _, _, node in small.faults}
    assert {(at, action) for at, action, _ in small.faults} == {(20_000_000, KILL)}
    assert (len(gone), 0 in gone, len(small.sent)) == (3, False, 14)
    first, second = small.sent[:7], small.sent[7:]
    assert [(one.source, one.dest) for one in first] == [(one.source, one.dest) for one in second]
    assert {one.source for one in first} == set(range(10)) - gone
    assert all(one.dest != one.source and one.dest not in gone for one in first)
    assert [one.at_us - 20_000_001 for one in small.sent] == [
        *(100_000 * i for i in range(7)), *(1_000_000 + 100_000 * i for i in range(7))]  # fmt: skip
    assert [one.part for one in (first[0], second[0])] == ["first", "later"]


def test_through_an_outage_messages_and_alarms_go_by_turns():
    made = comparison.world({"nodes": 10, "rounds": 2, "root": 1}, 1)
    assert made.faults == [(20_000_000, KILL, 0), (60_000_000, REVIVE, 0)]
    assert made.again == {"peers": (20_000_000, 60_000_000), "alarms": (20_000_000, 60_000_000),
                          "after": (60_000_000, made.duration_us)}  # fmt: skip
    assert [one.at_us for one in made.sent] == list(range(20_000_001, 100_000_001, 100_000))
    messages, alarms = made.sent[::2], made.sent[1::2]
    assert {one.dest for one in alarms} == {MONITOR}
    assert {one.source for one in made.sent} == set(range(2, 10))  # neither root nor standby
    assert all(one.dest != one.source for one in messages)
    assert {one.dest for one in messages} == set(range(1, 10))
    for some, before, after in ((messages, "peers", "peers after"), (alarms, "alarms", "after")):
        assert [one.part for one in some] == [before] * 200 + [after] * 200


@pytest.mark.parametrize(("there", "back", "gone", "good", "is_joined"), [
    (0, 0, [], [(0, 1)], True), (0, -1, [], [(0, 1)], False), (-1, 0, [], [(0, 1)], False),
    (0, 0, [1], [(0, 1)], False), (0, 0, [], [], False), (0, 0, [], [(0, 2), (1, 2)], True),
    (0, 0, [2], [(0, 2), (1, 2)], False),
    (0, 0, [2], [(0, 1)], True),
])  # fmt: skip
def test_a_robot_is_joined_by_a_node_that_it_hears_and_that_hears_it(
    there, back, gone, good, is_joined
):
    """Robot 3 crosses 10 m from node 1, and far from all others; 20 dB are lost on 10 m."""
    base = [-100_000] * 16
    least = -9_000 + 300 + 2 * 1000
    base[3 * 4 + 1], base[1 * 4 + 3] = least + there, least + back
    radio = Of(base_cdb=base, exponent_c=200, rssi50_cdb=-9_000)
    plan = Of(radio=radio, nodes=4, walks=[Walk(3, ((0, 0, 0), (10, 10_000, 0)))], good=good,
              positions_cm=[(90_000, 0), (5_000, 1_000), (90_000, 9), (0, 0)])  # fmt: skip
    assert alarms._joined(plan, gone, 5) == is_joined


def test_ways_by_tables_are_counted_against_the_shortest(monkeypatch):
    """A line 0-1-2-3 and a node apart; 1 sends what is for 3 back to 0, 3 has no table."""
    loud = [-16_000] * 25
    for a, b in ((0, 1), (1, 2), (2, 3)):
        loud[5 * a + b] = loud[5 * b + a] = -9_050
    loud[5 * 0 + 2], loud[5 * 2 + 0] = -9_000, -9_051  # too faint one way
    none = stretch.NONE
    tables = {
        "next": [[none, 1, 1, 1, none], [0, none, 2, 0, none], [1, 1, none, 3, none], [none] * 5,
                 [none] * 5],
        "alt": [[none, 2, 2, none, none], [none] * 5, [none, 3, none, 1, none], [none] * 5,
                [none] * 5],
    }  # fmt: skip
    plan = Of(nodes=5, radio=Of(rssi_cdb=loud), params={"min_rssi": -90})
    run = Of(plan=plan)
    monkeypatch.setattr(stretch, "row_of", lambda result, node, name: tables[name][node])
    found = stretch.measure(Of(run=lambda seed: run), 1)
    assert found == {"stretch": 1.0, "p99": 1.0, "pairs": 12, "broken": 5, "bare": 5,
                     "kinds": [1, 1, 2, 5]}  # fmt: skip


def test_a_message_that_two_gateways_were_given_is_counted():
    rows = [(DATA, 5, 1, 0), (DATA, 5, 1, 1), (DATA, 5, 2, 1), (DATA, 6, 1, 0), (DATA, 6, 1, 0),
            (DATA + 1, 7, 1, 0), (DATA + 1, 7, 1, 1)]  # fmt: skip
    kinds = [(name, np.int64) for name in ("kind", "origin", "seq", "node")]
    assert gateway._at_both(Of(delivered=np.array(rows, kinds))) == 1
    assert gateway._at_both(Of(delivered=np.array(rows[1:], kinds))) == 0


@pytest.mark.parametrize(("dead", "every_s", "senders"), [((0,), 10, 4), ((0, 1), 10, 3)])
def test_all_who_live_write_to_the_gateway_and_to_one_another(dead, every_s, senders):
    plan = Of(seed=3, nodes=5, offers=[])
    dies_us = 25_000_000
    gateway._send(plan, gateway.Setting("", (1,), dead, every_s), dies_us)
    spans = (10 + 60) // every_s
    assert len(plan.offers) == 2 * senders * spans
    assert plan.offers == sorted(plan.offers, key=lambda offer: offer.at_us)
    live = set(range(5)) - set(dead)
    for flow in (0, 1):
        mine = [offer for offer in plan.offers if offer.flow == flow]
        assert {offer.node for offer in mine} == live
        assert {(offer.at_us - 15_000_000) // 10_000_000 for offer in mine} == set(range(spans))
        wanted = {gateway.MONITOR} if flow == 0 else live
        assert {offer.dest for offer in mine} == wanted
        assert all(offer.dest != offer.node for offer in mine)
    silent = Of(seed=3, nodes=5, offers=[])
    gateway._send(silent, gateway.SILENT, dies_us)
    assert silent.offers == []


def test_good_links_lose_so_many_frames_and_others_are_none():
    radio = Of(prob_q15=[7] * 9, rssi_cdb=[-5_000] * 9)
    lossy._soften(Of(radio=radio, nodes=3, good=[(0, 2)]), 5)
    some, none = 32_768 - 32_768 * 5 // 100, placement.UNHEARD
    assert radio.prob_q15 == [0, 0, some, 0, 0, 0, some, 0, 0]
    assert radio.rssi_cdb == [none, none, -5_000, none, none, none, -5_000, none, none]


def test_wrong_entries_lead_away_or_nowhere(monkeypatch):
    """On a line 0-1-2 two of six: 2's to 0, and 0's to 2."""
    none = lossy.NONE
    tables = [[none, 1, none], [0, none, 2], [2, 1, none]]
    near = Of(near_at=lambda at_us: [[1], [0, 2], [1]])
    monkeypatch.setattr(lossy, "Ground", lambda plan: near)
    monkeypatch.setattr(lossy, "row_of", lambda result, node, name: tables[node])
    assert lossy._wrong(Of(plan=Of(nodes=3), ended_us=9)) == pytest.approx(2 / 6)


def test_tables_that_come_again_are_those_after_the_first():
    codes = [REPORT_TABLE, REPORT_TABLE, REPORT_TABLE + 1, REPORT_TABLE]
    rows = np.array([*zip(codes, [7_999_999, 8_000_000, 9_000_000, 9_000_000], strict=True)],
                    [("code", np.int64), ("time", np.int64)])  # fmt: skip
    assert lossy._again(Of(rows=rows)) == 2


@pytest.mark.parametrize(("reliable", "flags"), [(1, END_TO_END), (0, 0)])
def test_everyone_sends_anywhere_in_each_span(reliable, flags):
    plan = Of(seed=2, nodes=4, offers=[], params={"reliable": reliable})
    testbed.send_anywhere(plan, 8, 68, 2)
    assert len(plan.offers) == 4 * 30
    spans = {(offer.node, (offer.at_us - 8_000_000) // 2_000_000) for offer in plan.offers}
    assert spans == {(node, span) for node in range(4) for span in range(30)}
    assert plan.offers == sorted(plan.offers, key=lambda offer: offer.at_us)
    ways = {(offer.node, offer.dest) for offer in plan.offers}
    assert ways == {(a, b) for a in range(4) for b in range(4) if a != b}
    assert {(offer.flags, offer.flow) for offer in plan.offers} == {(flags, 0)}
