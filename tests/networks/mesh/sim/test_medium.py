"""The mesh's medium, frame by frame: who receives what, and why not."""

from types import SimpleNamespace

import pytest

from innervate.networks.mesh.protocol import fields as mesh_fields
from innervate.networks.mesh.scenario.plan import ONE
from innervate.networks.mesh.scenario.plan import MeshFault as Fault
from innervate.networks.mesh.sim import build
from innervate.networks.mesh.sim.orders import wipe
from innervate.scenario.actions.field import CUT, JAM, KILL, QUIET, RESTART, RESTORE, REVIVE
from innervate.sim.field import medium as field
from innervate.sim.field.access import MAC
from tests.networks.mesh.pinger import REPORT_HEARD, REPORT_SENT, REPORT_TICK
from tests.networks.mesh.runs import LOUD, TURN_US, both_ways, mesh_plan, radio, run

NOONE = 200  # everybody hears it, nobody answers
AT = 100_000
BYTES = 11 + 1 + 20 + 2
FRAME_US = (6 + BYTES) * 32


def direct(n, medium, offers, **more):
    """A run without medium access: frames go out when they are offered. {sender: row}."""
    plan = mesh_plan(n, medium, [(at, node, dest, 20) for at, node, dest in offers], mac="none")
    for name, value in more.items():
        setattr(plan, name, value)
    return run(plan)


def heard(result, node):
    """Whom a node heard, in order."""
    rows = result.rows[(result.rows["code"] == REPORT_HEARD) & (result.rows["node"] == node)]
    return rows["a"].tolist()


def fault(at, action, node, other=-1, value=0):
    return Fault(at, action, node, other, value, 0)


def test_a_frame_is_on_the_air_after_the_turnaround_and_as_long_as_its_bytes():
    result = direct(2, radio(2), [(AT, 0, 1)])
    data, ack = result.sent
    assert (data["time"], data["end"]) == (AT + TURN_US, AT + TURN_US + FRAME_US)
    assert (data["bytes"], data["receivers"]) == (BYTES, 1)
    assert ack["time"] == data["end"] + TURN_US
    assert ack["end"] - ack["time"] == (6 + 9) * 32
    assert heard(result, 1) == [0]
    assert heard(result, 0) == [1]


def test_rssi_is_given_in_whole_dbm_but_an_acks_is_what_its_sender_wrote():
    result = direct(2, radio(2, {(0, 1): -7_049, (1, 0): -7_051}), [(AT, 0, 1), (2 * AT, 1, 0)])
    rows = result.rows[result.rows["code"] == REPORT_HEARD]
    assert rows[["node", "b"]].tolist() == [(1, -70), (0, -70), (0, -71), (1, -71)]


def two_senders(level, offset=0, third=()):
    """Node 2 hears 0 at -80 dBm and 1 at `level`; 1 begins `offset` us after 0."""
    links = {(0, 2): -8_000, (1, 2): level, (3, 2): LOUD}
    return heard(direct(4, radio(4, links), [(AT, 0, 2), (AT + offset, 1, 2), *third]), 2)


@pytest.mark.parametrize("offset", [0, 500, FRAME_US - 1])
def test_two_equal_signals_that_overlap_are_both_lost(offset):
    assert two_senders(-8_000, offset) == []


def test_signals_that_only_touch_are_both_received():
    assert two_senders(-8_000, FRAME_US + TURN_US + 9 * 32 + 1000) == [0, 1]


@pytest.mark.parametrize("offset", [-500, 0, 500])
def test_capture_the_stronger_by_more_than_6_db_survives(offset):
    assert two_senders(-8_600, offset) == [0]
    assert two_senders(-8_590, offset) == []
    assert two_senders(-7_390, offset) == [1]


def test_interference_adds_up():
    links = {(0, 4): -8_000, (1, 4): -8_900, (2, 4): -8_900, (3, 4): -8_900}
    two = direct(5, radio(5, links), [(AT, i, 4) for i in range(2)])
    four = direct(5, radio(5, links), [(AT, i, 4) for i in range(4)])
    assert heard(two, 4) == [0]
    assert heard(four, 4) == []


def test_only_the_worst_moment_counts_not_the_sum_over_time():
    links = {(0, 3): -8_000, (1, 3): -8_700, (2, 3): -8_700}
    short = (6 + 11 + 1 + 2) * 32
    plan = mesh_plan(4, radio(4, links), [(AT, 0, 3, 90), (AT, 1, 3, 0)], mac="none")
    plan.offers.append(type(plan.offers[0])(AT + short, 2, 3, 0, 0, 0))
    assert heard(run(plan), 3) == [0]  # one after the other, at the same moment is too much
    plan.offers[-1] = type(plan.offers[0])(AT + short - 1, 2, 3, 0, 0, 0)
    assert heard(run(plan), 3) == []


@pytest.mark.parametrize(
    ("offset", "received"),
    [
        (-(TURN_US + FRAME_US), [0]),  # its own frame ends as the other begins ...
        (-(TURN_US + FRAME_US) + TURN_US + 1, []),
        (TURN_US + FRAME_US - 1, []),  # it commits in the other's last microsecond
        (TURN_US + FRAME_US, [0]),
    ],
)
def test_half_duplex_and_the_vulnerable_window(offset, received):
    medium = radio(3, {(0, 1): LOUD})
    result = direct(3, medium, [(AT, 0, NOONE), (AT + offset, 1, NOONE)])
    assert heard(result, 1) == received


def test_chance_of_reception():
    plan = mesh_plan(
        2, radio(2, prob=ONE // 4), [(AT + 5000 * i, 0, NOONE, 1) for i in range(1000)]
    )
    plan.mac, plan.duration_us = "none", 6_000_000
    count = len(heard(run(plan), 1))
    assert 200 < count < 300  # 250, standard deviation 14


def test_without_collisions_only_the_chance_counts():
    links = both_ways({(0, 1): LOUD, (0, 2): LOUD, (1, 2): LOUD})
    result = direct(3, radio(3, links, collisions=False), [(AT, i, NOONE) for i in range(3)])
    assert [sorted(set(heard(result, i))) for i in range(3)] == [[1, 2], [0, 2], [0, 1]]


def carried(level, offers, n=2, **more):
    """A run with CSMA."""
    pairs = {(i, j): level for i in range(n) for j in range(n) if i != j}
    return run(mesh_plan(n, radio(n, pairs, **more), offers, seed=3))


def test_carrier_sense_keeps_frames_apart_and_hidden_terminals_do_not():
    rounds, gap = 60, 30_000
    offers = [(AT + gap * k + i, i, NOONE, 60) for k in range(rounds) for i in range(2)]
    links = both_ways({(0, 2): LOUD, (1, 2): LOUD})
    near = both_ways({(0, 1): LOUD}) | links
    results = []
    for which in (near, links):
        plan = mesh_plan(3, radio(3, which), [(at, i, 200, size) for at, i, _, size in offers])
        results.append(len(heard(run(plan), 2)))
    sensed, hidden = results
    # of the near, only backoffs within a turnaround collide: less than 1 of 8 pairs
    assert sensed > 2 * rounds * 0.8
    assert hidden < 2 * rounds * 0.6


def test_carriers_below_the_threshold_are_not_noticed():
    at, jam = 50_000, -9_000
    for sense, ok in ((-8_900, 1), (-9_100, 0)):
        plan = mesh_plan(2, radio(2, sense_cdb=sense), [(AT, 0, NOONE, 20)])
        plan.faults = [fault(at, JAM, 0, value=jam)]
        result = run(plan)
        told = result.rows[result.rows["code"] == REPORT_SENT]
        assert told["a"].tolist() == [ok]
        assert result.counts["gave_up"] == 1 - ok
        assert len(result.sent) == ok


def test_a_jammer_deafens_until_it_is_quiet():
    offers = [(AT, 0, NOONE), (2 * AT, 0, NOONE), (3 * AT, 0, NOONE)]
    faults = [fault(AT + 500, JAM, 1, value=-6_500), fault(2 * AT + TURN_US + FRAME_US, QUIET, 1)]
    result = direct(3, radio(3), offers, faults=faults)
    assert len(heard(result, 1)) == 1
    assert len(heard(result, 2)) == 3


def test_a_jammer_weaker_than_capture_does_nothing():
    result = direct(2, radio(2), [(AT, 0, NOONE)], faults=[fault(1, JAM, 1, value=-6_700)])
    assert heard(result, 1) == [0]


def test_a_cut_pair_hears_nothing_of_each_other_until_it_is_restored():
    offers = [(AT, 0, NOONE), (2 * AT, 1, NOONE), (3 * AT, 0, NOONE), (4 * AT, 1, NOONE)]
    faults = [fault(AT + 500, CUT, 0, 1), fault(2 * AT + 5_000, RESTORE, 0, 1)]
    result = direct(3, radio(3), offers, faults=faults)
    assert (heard(result, 1), heard(result, 0)) == ([0], [1])
    assert heard(result, 2) == [0, 1, 0, 1]


def test_a_cut_in_mid_frame_leaves_no_signal_behind():
    faults = [fault(AT + 500, CUT, 0, 1), fault(AT + 700, RESTORE, 0, 1)]
    result = direct(3, radio(3), [(AT, 0, NOONE)], faults=faults)
    assert [int(total) for total in result.world.sums] == [0, 0, 0]


def test_who_dies_in_mid_frame_is_not_heard_and_disturbs_no_longer():
    links = {(0, 2): LOUD, (1, 2): LOUD}
    offers = [(AT, 0, NOONE), (AT + 1_000, 1, NOONE)]
    result = direct(3, radio(3, links), offers, faults=[fault(AT + 1_100, KILL, 0)])
    assert heard(result, 2) == [1]
    assert result.sent[["node", "end", "receivers"]].tolist() == [
        (0, AT + 1_100, 0),
        (1, AT + 1_000 + TURN_US + FRAME_US, 1),
    ]
    again = direct(3, radio(3, links), offers, faults=[fault(AT + 1_200, KILL, 0)])
    assert heard(again, 2) == []


def test_who_dies_in_the_turnaround_was_never_on_the_air():
    result = direct(2, radio(2), [(AT, 0, NOONE)], faults=[fault(AT + TURN_US - 1, KILL, 0)])
    assert len(result.sent) == 0
    assert result.counts["transmissions"] == 0


def test_the_dead_hear_nothing_and_who_starts_in_mid_frame_has_missed_it():
    offers = [(AT, 0, NOONE), (2 * AT, 0, NOONE), (3 * AT, 0, NOONE)]
    faults = [fault(AT // 2, KILL, 1), fault(2 * AT + 500, REVIVE, 1)]
    result = direct(2, radio(2), offers, faults=faults)
    assert len(heard(result, 1)) == 1
    rows = result.rows[result.rows["code"] == REPORT_TICK]
    assert rows[rows["node"] == 1][["a", "b"]].tolist() == [(0, 0), (1, 0)]


def test_a_restart_loses_the_memory_but_not_the_generator():
    plan = mesh_plan(2, faults=[fault(1_500_000, RESTART, 1)])
    plan.params["tick_us"] = 1_000
    fresh, result = run(mesh_plan(2)), run(plan)
    rows = result.rows[(result.rows["code"] == REPORT_TICK) & (result.rows["node"] == 1)]
    assert rows["b"].tolist() == [0, 0]  # ticks since the start
    own, other = result.world.nodes[1], fresh.world.nodes[1]
    assert (own.number, own.rank) == (1, -1)
    assert own.seq != other.seq


def test_absent_nodes_are_off_until_they_are_revived():
    plan = mesh_plan(2, absent=[0, 1], faults=[fault(AT, REVIVE, 1)])
    rows = run(plan).rows
    assert rows[rows["code"] == REPORT_TICK][["time", "node"]].tolist() == [(0, 0), (AT, 1)]


def test_messages_for_the_dead_are_counted():
    plan = mesh_plan(2, offers=[(AT, 0, 1, 9)], faults=[fault(AT // 2, KILL, 0)])
    assert run(plan).counts["unasked"] == 1


def test_a_message_begins_with_the_number_of_its_offer():
    offers = [(AT * (1 + i), 0, 1, 6) for i in range(3)]
    delivered = run(mesh_plan(2, offers=offers)).delivered
    assert delivered[["body0", "body1", "body2", "body3"]].tolist() == [
        (i, 0, 0, 0) for i in range(3)
    ]


def test_the_medium_access_is_told_of_carriers_before_its_timer_only():
    result = run(mesh_plan(3, offers=[(AT, 0, NOONE, 20)]), trail=True)
    handlers = result.trail["handler"]
    assert (handlers >= MAC).any()
    assert (handlers[handlers >= MAC] - MAC <= 3).all()


@pytest.mark.parametrize(
    ("power", "deaf", "busy"), [(99, 0, 0), (100, 0, 1), (101, 0, 1), (0, 1, 1)]
)
def test_a_channel_is_busy_from_the_threshold_on(power, deaf, busy):
    world = SimpleNamespace(
        radios=[SimpleNamespace(deaf=deaf)], sums=[power], run=[SimpleNamespace(sense=100)]
    )
    assert field.senses(world, 0) == busy


def test_a_lost_memory_is_all_of_it_and_nobody_elses():
    plan = mesh_plan(3, capacity=4, ranks=[0, 1, -1])
    world = build.build(plan, True, observe=False)
    gates = range(3)  # of the gateway, of its standby, and one that stays blank
    words, own = sum(max(field[1], 1) for field in mesh_fields.gate(4)), len(world.low)
    for gate in gates[:2]:
        for i in range(words):
            world.gate_words[gate][i] = 1
    for node in range(3):
        for i in range(own):
            world.words[node][i] = 3
        world.nodes[node].number, world.nodes[node].rng = node, 77
    wipe(world, 1)
    assert [sum(world.gate_words[gate][i] for i in range(words)) for gate in gates] == [words, 0, 0]
    mine = [int(world.words[1][i]) for i in range(own)]
    blank = [int(world.words[3][i]) for i in range(own)]
    assert (world.nodes[1].number, world.nodes[1].rng, world.nodes[1].rank) == (1, 77, 3)
    assert sum(a != b for a, b in zip(mine, blank, strict=True)) <= 4
    assert all(int(world.words[node][own - 1]) == 3 for node in (0, 2))
