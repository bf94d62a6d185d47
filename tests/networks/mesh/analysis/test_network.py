"""Who led, who got tables and what the air was used for: a run of five nodes, by hand."""

import numpy as np
import pytest

from innervate.networks.mesh.analysis import network
from innervate.networks.mesh.analysis.paths import Ground
from innervate.networks.mesh.protocol.constants import (
    ACK,
    ALARM,
    DATA,
    E2E_ACK,
    POSITION,
    REPORT_GATEWAY,
    REPORT_GRAPH,
    REPORT_ROUND,
    REPORT_SUSPECT,
    REPORT_TABLE,
    REQUEST,
    RESPONSE,
    TABLE,
    TABLE_FREE,
)
from innervate.scenario.actions.field import CUT, KILL, RESTART, REVIVE
from tests.networks.mesh.analysis.test_summary import S, fault, made


def sent(time, end, node, kind, *, receivers=1, origin=None, seq=0, size=10):
    """A transmission, as in `world.SENT`."""
    source = node if origin is None else origin
    return (time, end, node, kind, 0, 0, source, 0, seq, 1, size, receivers)


def test_what_airtime_was_spent_on_and_by_whom():
    frames = [
        sent(0, 1_000, 0, REQUEST, size=11), sent(2_000, 4_000, 1, RESPONSE, seq=1, size=12),
        sent(4_000, 8_000, 1, TABLE, seq=2, size=13), sent(9_000, 9_500, 2, ACK, origin=1, seq=2),
        sent(10_000, 26_000, 2, DATA, seq=3), sent(30_000, 46_000, 3, E2E_ACK, seq=4),
        sent(50_000, 82_000, 3, ALARM, seq=5), sent(90_000, 154_000, 2, POSITION, seq=6),
    ]  # fmt: skip
    result = made(sent=frames, ended_us=S)
    found = network.airtime(result, network.acked_kinds(result.sent))
    assert found == {
        "discovery_s": pytest.approx(0.003), "tables_s": pytest.approx(0.0045),
        "messages_s": pytest.approx(0.032), "alarms_s": pytest.approx(0.032),
        "beacons_s": pytest.approx(0.064), "busiest": 2, "busiest_share": pytest.approx(0.0805),
    }  # fmt: skip
    assert network.control_bytes(result, network.acked_kinds(result.sent)) == 11 + 12 + 13 + 10


def test_an_ack_is_of_the_newest_packet_of_its_name():
    frames = [
        sent(0, 100, 1, DATA, seq=7), sent(200, 300, 1, TABLE, seq=7),
        sent(150, 160, 2, ACK, origin=1, seq=7), sent(300, 310, 2, ACK, origin=1, seq=7),
        sent(299, 305, 2, ACK, origin=1, seq=7), sent(400, 410, 2, ACK, origin=1, seq=8),
        sent(50, 60, 2, ACK, origin=1, seq=7), sent(400, 410, 2, ACK, origin=0, seq=7),
    ]  # fmt: skip
    kinds = network.acked_kinds(made(sent=frames).sent).tolist()
    assert kinds == [DATA, TABLE, DATA, TABLE, DATA, ACK, ACK, ACK]
    alone = made(sent=[sent(0, 1, 1, ACK)])
    assert network.acked_kinds(alone.sent).tolist() == [ACK]
    assert network.acked_kinds(made().sent).tolist() == []


def test_a_round_ends_where_the_next_begins():
    rows = [(S, 0, REPORT_ROUND, 1, 1), (3 * S, 0, REPORT_GRAPH, 4, 1), (5 * S, 0, REPORT_ROUND, 2)]
    frames = [
        sent(S - 1, S, 1, REQUEST), sent(S, S + 1_000, 0, REQUEST),
        sent(2 * S, 2 * S + 500, 1, RESPONSE, seq=1), sent(3 * S - 500, 3 * S, 2, RESPONSE, seq=1),
        sent(3 * S, 3 * S + 1, 3, RESPONSE, seq=1),
        sent(2 * S, 3 * S - 1, 4, RESPONSE, seq=1, receivers=0),
        sent(4 * S, 4 * S + 2_000, 1, TABLE, seq=2), sent(5 * S, 5 * S + 4_000, 1, TABLE, seq=3),
    ]  # fmt: skip
    result = made(rows, frames, rounds=[(3 * S, 0, 1, 3, 0, 3)])
    found = network.discovery(result, network.acked_kinds(result.sent))
    assert found["rounds"] == 2
    assert found["recall"] is None  # of nothing
    assert found["complete_s"] == 2.0
    assert found["responses_s"] == 2.0  # the last that came in time; one was heard by nobody
    assert found["airtime_s"] == pytest.approx(0.001 + 0.0005 + 0.0005 + 1e-6 + 0.999999)
    assert found["tables_airtime_s"] == pytest.approx(0.002)
    assert found["tables_s"] is None
    never = network.discovery(made(), np.zeros(0))
    assert set(never.values()) == {None}


def tabled(*nodes, at=2 * S, epoch=1):
    return [(at + 1_000 * node, node, REPORT_TABLE, 1, epoch) for node in nodes]


def test_who_leads_was_dead_or_comes_late_needs_no_table():
    round_ = [(S, 0, REPORT_ROUND, 1, 1)]
    assert network.tables(made([*round_, *tabled(1, 2, 3, 4)]), S) == (4, 2 * S + 4_000)
    assert network.tables(made([*round_, *tabled(1, 2, 3)]), S) == (3, None)
    late = made([*round_, *tabled(1, 2, 3)], absent=[0, 0, 0, 0, 1])
    assert network.tables(late, S) == (3, 2 * S + 3_000)
    for action in (KILL, RESTART):
        harmed = made([*round_, *tabled(1, 2, 3)], faults=[fault(9 * S, action, 4)])
        assert network.tables(harmed, S) == (3, 2 * S + 3_000)
    spared = made([*round_, *tabled(1, 2, 3)], faults=[fault(9 * S, REVIVE, 4)])
    assert network.tables(spared, S) == (3, None)
    # The first table of a node counts, and none from before.
    twice = made([*round_, *tabled(1, 2, 3, 4), *tabled(1, 2, 3, 4, at=3 * S)])
    assert network.tables(twice, S) == (4, 2 * S + 4_000)
    assert network.tables(twice, 2 * S + 1_001) == (4, 3 * S + 1_000)
    free = made([*round_, *tabled(1, 2)])
    free.plan.params["mode"] = TABLE_FREE
    assert network.tables(free, S) == (None, None)
    assert network.tables(made(round_), S) == (0, None)


def test_gateways_and_how_long_a_takeover_takes():
    rows = [
        (S, 0, REPORT_GATEWAY, 0, 1), (S + 1, 3, REPORT_GATEWAY, 0, 1),  # who follows, not leads
        *tabled(1, 2, 3, 4), (20 * S, 1, REPORT_GATEWAY, 1, 2),
        *tabled(2, 3, 4, at=21 * S, epoch=2),
    ]  # fmt: skip
    dies = [fault(15 * S, KILL, 0)]
    led = network.gateways(made(rows, faults=dies))
    assert [(one["node"], one["at_s"], one["epoch"]) for one in led] == [(0, 1.0, 1), (1, 20.0, 2)]
    assert [one["tables_s"] for one in led] == [pytest.approx(1.004), pytest.approx(1.004)]
    assert network.takeover_s(made(rows, faults=dies), led) == pytest.approx(5 + 1.004)
    # While all are on, the old gateway has no table of the new one.
    assert network.gateways(made(rows))[1]["tables_s"] is None
    for faults in ([], [fault(15 * S, KILL, 2)], [fault(15 * S, RESTART, 0)],
                   [fault(20 * S, KILL, 0)], [fault(S - 1, KILL, 0)]):  # fmt: skip
        assert network.takeover_s(made(rows, faults=faults), led) is None
    at_once = [fault(S, KILL, 0)]
    assert network.takeover_s(made(rows, faults=at_once), led) == pytest.approx(19 + 1.004)


def test_a_suspicion_is_wrong_of_who_was_on_at_that_time():
    raised = ((S, 2), (5 * S - 1, 2), (5 * S, 2), (8 * S - 1, 2), (8 * S, 2), (9 * S, 3))
    rows = [(at, 1, REPORT_SUSPECT, node) for at, node in raised]
    for back in (REVIVE, RESTART):
        faults = [fault(5 * S, KILL, 2), fault(8 * S, back, 2)]
        assert network.suspects(made(rows, faults=faults)) == {"raised": 6, "wrong": 4}
    assert network.suspects(made()) == {"raised": 0, "wrong": 0}


def test_the_ground_changes_at_the_moment_of_a_fault_and_of_a_start():
    plan = made(faults=[fault(5 * S, CUT, 2, 1), fault(6 * S, KILL, 0)],
                starts_us=[0, 0, 0, 0, 3 * S], absent=[0, 0, 0, 1, 0]).plan  # fmt: skip
    ground = Ground(plan)
    assert ground.times == [0, 3 * S, 5 * S, 6 * S]
    assert [ground.on_at(at)[4] for at in (3 * S - 1, 3 * S)] == [False, True]
    assert not any(ground.on_at(at)[3] for at in (0, 9 * S))
    assert ground.near_at(5 * S - 1) == [[1], [0, 2], [1], [], []]
    assert ground.near_at(5 * S) == [[1], [0], [], [], []]
    assert ground.near_at(6 * S) == [[]] * 5
    assert [ground.hops(0, 2, at) for at in (5 * S - 1, 5 * S)] == [2, -1]
    assert ground.hops(2, 2, 5 * S) == 0


def test_the_first_round_is_collected_once_and_by_what_was_heard():
    rows = [(S, 0, REPORT_ROUND, 1, 1), (4 * S, 0, REPORT_GRAPH, 4, 1), (9 * S, 0, REPORT_GRAPH)]
    frames = [
        sent(2 * S, 3 * S, 1, RESPONSE, seq=1),
        sent(3 * S, 4 * S, 2, RESPONSE, seq=1, receivers=0),
        sent(4 * S, 5 * S, 3, RESPONSE, seq=1),
    ]
    result = made(rows, frames, rounds=[(4 * S, 0, 1, 3, 4, 3)])
    found = network.discovery(result, network.acked_kinds(result.sent))
    assert (found["complete_s"], found["responses_s"]) == (3.0, 2.0)
    assert found["recall"] == result.rounds["both"][0] / result.rounds["good"][0] > 0
    never = made(rows[:1], frames)  # then the last that came at all counts
    assert network.discovery(never, network.acked_kinds(never.sent))["responses_s"] == 4.0


def test_tables_that_come_at_the_very_moment_count_and_each_node_once():
    round_ = [(S, 0, REPORT_ROUND, 1, 1)]
    assert network.tables(made([*round_, *tabled(1, 2, 3, 4, at=S - 1_000)]), S)[0] == 4
    assert network.tables(made([*round_, *tabled(1, 2, 3, 4, at=S - 1_001)]), S)[0] == 3
    alone = made(round_, absent=[0, 1, 1, 1, 1])
    assert network.tables(alone, S) == (0, None)
    rows = [(S, 0, REPORT_GATEWAY, 0, 1), *tabled(1, 2, 3, 4, at=S - 1_000),
            *tabled(1, 2, 3, 4, at=9 * S), (20 * S, 1, REPORT_GATEWAY, 1, 2),
            *tabled(0, 2, 3, 4, at=21 * S, epoch=2), (30 * S, 2, REPORT_GATEWAY, 2, 3),
            *tabled(0, 3, 4, at=31 * S, epoch=3)]  # fmt: skip
    dies = [fault(25 * S, KILL, 1)]
    led = network.gateways(made(rows, faults=dies))
    assert [one["tables_s"] for one in led] == [
        pytest.approx(0.003), pytest.approx(1.004), pytest.approx(1.004)
    ]  # fmt: skip
    # The second to lead dies: from there until the third has served all.
    assert network.takeover_s(made(rows, faults=dies), led) == pytest.approx(5 + 1.004)


def test_who_comes_back_after_a_takeover_does_not_make_it_longer():
    rows = [(S, 0, REPORT_GATEWAY, 0, 1), (20 * S, 1, REPORT_GATEWAY, 1, 2),
            *tabled(1, 2, 3, 4, at=21 * S, epoch=2), *tabled(0, at=40 * S, epoch=2)]  # fmt: skip
    faults = [fault(15 * S, KILL, 0), fault(35 * S, REVIVE, 0)]
    led = network.gateways(made(rows, faults=faults))
    assert led[1]["tables_s"] == pytest.approx(1.004)
    assert network.takeover_s(made(rows, faults=faults), led) == pytest.approx(5 + 1.004)
