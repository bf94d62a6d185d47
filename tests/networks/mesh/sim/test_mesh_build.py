"""A mesh from a plan, and from outside of its loop: numbers, walks, room, what broke, by hand."""

from types import SimpleNamespace as Of

import pytest

from innervate.dialect.rng import GENERATE
from innervate.networks.mesh.protocol import fields as mesh_fields
from innervate.networks.mesh.protocol.constants import MTU
from innervate.networks.mesh.scenario.plan import Offer
from innervate.networks.mesh.sim import build, orders, recorder, simulate
from innervate.networks.mesh.sim.build import DUPLICATES, OUTBOX
from innervate.networks.mesh.sim.over_channel import KEPT
from innervate.scenario.actions.field import CUT, KILL
from innervate.scenario.robots import Walk
from innervate.sim.field import medium, powers, queue
from innervate.sim.field.loop import BOOT
from innervate.sim.field.medium import NONE
from innervate.sim.status import POOL_FULL, ROWS_FULL
from innervate.sim.tables import get, put
from tests.networks.mesh.channel_runs import team
from tests.networks.mesh.runs import mesh_plan, radio

N = 4
RSSI = {(0, 1): -6_000, (1, 0): -6_500, (2, 3): -9_000}


def planned(**more):
    given = {
        "ranks": [1, -1, 0, -1], "robots": [0, 1, 1, 0], "absent": [0, 0, 0, 1],
        "starts_us": [70, 50, 60, 9], "good": [(0, 1), (1, 3)],
        "positions_cm": [(0, 0), (300, 0), (0, 500), (9, 9)], "origin_cm": (20, -30),
        "walks": [Walk(2, ((5, 1, 2), (8, 3, 4)))],
        "faults": [Of(at_us=60, action=KILL, node=2, other=-1, value=7),
                   Of(at_us=40, action=CUT, node=0, other=3, value=0)],
        "mac_params": {"backoff_us": 99},
    }  # fmt: skip
    medium = radio(N, RSSI, sense_cdb=-9_800, capture_cdb=600, turnaround_us=55, phy_bytes=5)
    return mesh_plan(N, medium, params={"told": 1, "unit_cm": 10}, **given | more)


def run_of(world):
    return {name: int(get(world.run, 0, name)) for name in world.run.dtype.names}


@pytest.fixture(scope="module")
def world():
    plan = planned()
    plan.offers = [Offer(90, 1, 2, 3, 4, 0), Offer(80, 0, 3, 1, 2, 0)]
    return build.build(plan, False)


def test_a_plan_becomes_the_numbers_of_its_radios(world):
    run, strengths = run_of(world), powers.strength_table()
    assert {name: run[name] for name in (
        "nodes", "mac", "collisions", "turnaround", "byte_ns", "phy_bytes", "origin_x", "origin_y",
        "unit", "moving", "told", "good", "commands", "offers", "forget")} == {
        "nodes": N, "mac": 1, "collisions": 1, "turnaround": 55, "byte_ns": 32_000, "phy_bytes": 5,
        "origin_x": 20, "origin_y": -30, "unit": 10, "moving": 0, "told": 1, "good": 2,
        "commands": 5, "offers": 2, "forget": 59_000_000}  # fmt: skip
    assert run["sense"] == powers.strength(strengths, -9_800)
    assert run["capture"] == powers.capture_ratio(600)
    assert run["free"] == len(world.air) == 8 * N + 64
    assert run["duplicate_limit"] == DUPLICATES // 2 - (N + 1) * (OUTBOX + 1) // 4
    words = sum(max(int(field[1]), 1) for field in mesh_fields.gate(32))
    assert run["gate_words"] == words
    assert [int(get(world.mac_params, 0, name)) for name in build.CSMA] == [99, 3, 6, 8]


def test_powers_are_those_of_the_levels_and_good_links_go_both_ways(world):
    strengths = powers.strength_table()
    for (i, j), level in RSSI.items():
        assert int(world.power[N * i + j]) == powers.strength(strengths, level)
    assert [int(world.power[5 * i]) for i in range(N)] == [0] * N
    assert {k for k in range(N * N) if world.good[k]} == {1, 4, 7, 13}


def test_gateways_have_a_record_and_all_others_share_one(world):
    assert len(world.gates) == 3
    assert world.radios["gate"].tolist() == [0, 2, 1, 2]
    assert [world.nodes[name].tolist()[:N] for name in ("number", "rank", "robot")] == [
        [0, 1, 2, 3], [1, -1, 0, -1], [0, 1, 1, 0]]  # fmt: skip
    assert world.radios["held"].tolist() == world.radios["tell_at"].tolist() == [NONE] * N
    assert list(zip(world.radios["x"].tolist(), world.radios["y"].tolist(), strict=True)) == [
        (0, 0), (300, 0), (0, 500), (9, 9)]  # fmt: skip
    assert set(world.nodes["choice"].tolist()) == {GENERATE}  # also that which stands for all anew
    assert len(set(world.macs["rng"].tolist())) == len(set(world.nodes["rng"].tolist()[:N])) == N


def test_what_happens_is_in_order_of_time(world):
    assert [tuple(row) for row in world.commands.tolist()] == [
        (40, CUT, 0, 3, 0), (50, BOOT, 1, 0, 0), (60, BOOT, 2, 0, 0), (60, KILL, 2, 0, 7),
        (70, BOOT, 0, 0, 0),
    ]  # fmt: skip
    assert world.offers.tolist() == [(80, 0, 3, 1, 2), (90, 1, 2, 3, 4)]
    keys = sorted(world.heap.keys[: int(world.heap.size[0])].tolist())
    samples = [queue.key_of(int(row["phase"]), queue.SAMPLE, int(row["node"]), i)
               for i, row in enumerate(world.walks)]  # fmt: skip
    assert keys == sorted([queue.key_of(40, queue.COMMAND, 0, 0),
                           queue.key_of(80, queue.OFFER, 0, 0), *samples])  # fmt: skip


def test_robots_that_stand_still_are_told_their_place_as_well(world):
    walks = [(int(row["node"]), int(row["point"]), int(row["last"])) for row in world.walks]
    assert walks == [(2, 0, 1), (1, 2, 2)]
    assert world.points.tolist() == [(5, 1, 2), (8, 3, 4), (0, 300, 0)]
    assert {int(row["placed"]) for row in world.walks} == {0}
    nowhere = build.build(planned(positions_cm=[], walks=[]), False)
    assert int(nowhere.heap.size[0]) == 1


def test_an_ideal_medium_or_a_channel_below_has_no_collisions_of_its_own():
    ideal = build.build(planned(mac="none", radio=radio(N, collisions=False)), False)
    assert (run_of(ideal)["mac"], run_of(ideal)["collisions"]) == (0, 0)
    plain = build.build(planned(mac="none"), False)
    assert (run_of(plain)["mac"], run_of(plain)["collisions"]) == (0, 1)
    over = build.build(team(N), False)
    assert (run_of(over)["mac"], run_of(over)["collisions"], len(over.air)) == (0, 0, N * KEPT)
    assert over.below.radios["leaving"].tolist()[:N] == [1] * N
    assert over.below.above is over.heap
    assert int(get(over.below.run, 0, "loss")) == 0
    lossy = team(N)
    lossy.radio.prob_q15[1], lossy.radio.prob_q15[7], lossy.radio.prob_q15[5] = 31_000, 30_000, 0
    below = build.build(lossy, False).below  # as the worst pair; nobody is a pair with himself
    assert int(get(below.run, 0, "loss")) == 32_768 - 30_000


@pytest.mark.parametrize(("kept", "limits"), [
    ({}, (1, 1, 1, 1, 0, 0)), ({"observe": False}, (0, 0, 0, 0, 0, 0)),
    ({"tap": True}, (1, 1, 1, 1, 0, 1)), ({"trail": True, "observe": False}, (0, 0, 0, 0, 1, 0)),
])  # fmt: skip
def test_what_is_kept_has_room_for_one_event_more(kept, limits):
    made, margin = build.build(planned(), True, **kept), (N + 1) * (OUTBOX + 1)
    run = made.run[0]
    found = (run.row_limit, run.sent_limit, run.delivered_limit, run.round_limit, run.trail_limit,
             run.tap_limit)  # fmt: skip
    assert tuple(int(limit > 0) for limit in found) == limits
    tables = (made.rows, made.sent, made.delivered, made.rounds, made.trail, made.taps)
    for limit, table in zip(found, tables, strict=True):
        assert len(table) == (limit + margin if limit else 1)
    assert len(made.tapped) == len(made.taps)


@pytest.mark.parametrize("plain", [True, False])
def test_a_table_of_deliveries_is_doubled_and_forgets_none(plain):
    made = build.build(planned(), plain)
    keys = [7, 8 + DUPLICATES, 9]
    for at, key in enumerate(keys, 40):
        place = recorder.place_of(made.duplicate_key, key)
        made.duplicate_key[place], made.duplicate_at[place] = key, at
    grown = build.grow_duplicates(made)
    assert len(grown.duplicate_key) == len(grown.duplicate_at) == 2 * DUPLICATES
    for at, key in enumerate(keys, 40):
        place = recorder.place_of(grown.duplicate_key, key)
        assert (int(grown.duplicate_key[place]), int(grown.duplicate_at[place])) == (key, at)
    assert sum(1 for key in grown.duplicate_key if key) == 3
    margin = (N + 1) * (OUTBOX + 1) // 4
    assert int(get(grown.run, 0, "duplicate_limit")) == DUPLICATES - margin


# From outside.


def running_of(plan):
    return simulate.MeshSimulation(plan, build.build(plan, False), None)


def test_a_mesh_grows_what_is_full():
    running = running_of(planned())
    queue_room, deliveries = len(running.world.heap.keys), len(running.world.duplicate_key)
    running.grow(ROWS_FULL)
    assert len(running.world.heap.keys) == queue_room
    running.grow(POOL_FULL)
    assert (len(running.world.heap.keys), len(running.world.duplicate_key)) == (
        2 * queue_room, deliveries)  # fmt: skip
    running.grow(orders.DUPLICATES_FULL)
    assert (len(running.world.heap.keys), len(running.world.duplicate_key)) == (
        2 * queue_room, 2 * deliveries)  # fmt: skip
    over = running_of(team(N))
    below = len(over.world.below.heap.keys)
    over.grow(POOL_FULL)
    assert len(over.world.below.heap.keys) == 2 * below
    assert over.world.below.above is over.world.heap


@pytest.mark.parametrize(("gate", "node"), [(0, 0), (1, 2), (2, None)])
def test_gateways_are_looked_at_between_and_named_by_their_nodes(gate, node):
    """Ranks are 1 and 0: records are in the order of nodes; the last is all others'."""
    running = running_of(planned())
    assert running.broken_between() is None
    jobs = len(get(running.world.gates, gate, "job_count"))
    put(running.world.gates, gate, job_count=[16] * jobs)
    assert running.broken_between() == (None if node is None else (medium.BROKEN_RANGE, node))


@pytest.mark.parametrize("below", [False, True])
def test_what_broke_is_told_with_when_and_by_whom(below):
    running = running_of(team(N) if below else planned())
    if below:
        put(running.world.below.run, 0, broken=1, broken_node=2, broken_at=70)
    put(running.world.run, 0, now=1_500_000, broken_node=3,
        broken=recorder.BROKEN_BELOW if below else recorder.BROKEN_TWICE)  # fmt: skip
    said = running.broken_line()
    if below:
        assert said.startswith("invariant broken at 0.000070 s (seed 1): station 2 sent while")
    else:
        assert said == "invariant broken at 1.500000 s (seed 1): node n3 delivered a packet twice"


@pytest.mark.parametrize(("mac", "mtu", "name"), [
    ("csma", MTU, "mesh-32"), ("none", MTU, "mesh-32"), ("csma", MTU + 1, f"mesh-32-{MTU + 1}"),
    ("csma-cd-r/practical", 64, "mesh-32-practical"),
])  # fmt: skip
def test_a_loop_is_called_by_what_it_is_compiled_for(mac, mtu, name):
    assert simulate.loop_name(Of(mac=mac, capacity=32, params={"mtu": mtu})) == name


def test_a_medium_access_that_there_is_not_is_refused():
    with pytest.raises(ValueError, match=r"mac must be one of none, csma, .*, not 'aloah'"):
        simulate._check_mac("aloah")
    for mac in ("none", "csma", "csma-cd-r/practical"):
        simulate._check_mac(mac)
