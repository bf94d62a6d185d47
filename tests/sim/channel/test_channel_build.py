"""A plan of stations as tables of a channel, and what a station is told and does: by hand."""

from types import SimpleNamespace as Of

import pytest

from innervate.dialect.access import CLOCK, LEAVE
from innervate.dialect.outbox import SEND, STOP
from innervate.networks.radio.sim import build as radio_build
from innervate.scenario.actions.channel import BEGIN, JOIN, KILL
from innervate.scenario.actions.channel import LEAVE as RETIRE
from innervate.sim import heap
from innervate.sim.channel import build, loop, medium
from innervate.sim.channel.loop import BATCH
from innervate.sim.channel.world import RING
from innervate.sim.heap import COMMAND, OFFER, key_of
from innervate.sim.tables import get
from tests.networks.radio.runs import radio_plan
from tests.sim.channel.test_channel_loop import Do, radio, world_of

N = 3


def planned(**more):
    plan = radio_plan(N)
    plan.arrivals, plan.absent = [[40, 70], [], [50]], [0, 1, 0]
    plan.sizes = [[3, 4, 5], [6], [7, 8]]
    plan.delays_us = [[0, 30, 10], [30, 0, 10], [10, -1, 0]]
    plan.faults = [Of(at_us=60, action=JOIN, node=1, value=4, index=7),
                   Of(at_us=20, action=KILL, node=2, value=0, index=8)]  # fmt: skip
    for name, value in more.items():
        setattr(plan, name, value)
    return plan


def built(plain=False, **kept):
    return radio_build.build(planned(), plain, **kept)


def run_of(world):
    return {name: int(get(world.run, 0, name)) for name in world.run.dtype.names}


def test_who_hears_whom_is_in_order_of_distance_and_then_of_number():
    world = built()
    assert world.degree.tolist() == [2, 2, 1]
    rows = [(world.order[N * i + k], world.delay[N * i + k])
            for i in range(N) for k in range(world.degree[i])]  # fmt: skip
    assert rows == [(2, 10), (1, 30), (2, 10), (0, 30), (0, 10)]
    equal = radio_build.build(planned(delays_us=[[0, 5, 5], [5, 0, 5], [5, 5, 0]]), False)
    assert [equal.order[N * i + k] for i in range(N) for k in range(2)] == [1, 2, 0, 2, 0, 1]


def test_packets_come_station_by_station():
    world = built()
    assert world.arrivals.tolist() == [40, 70, 50, 0]
    assert world.radios["first_offer"].tolist() == [0, 2, 2, 3]
    assert world.radios["next_offer"].tolist()[:N] == [0, 2, 2]
    sizes = world.sizes.reshape(N, RING)
    assert [row[:4].tolist() for row in sizes] == [[3, 4, 5, 3], [6, 6, 6, 6], [7, 8, 7, 8]]
    assert sizes[0][-1] == [3, 4, 5][(RING - 1) % 3]
    assert build._repeated([1, 2, 3], 3).tolist() == [1, 2, 3]


def test_commands_and_first_offers_are_queued_and_who_is_away_stays_away():
    world = built()
    assert [tuple(row) for row in world.commands.tolist()] == [
        (BEGIN, 0, 0, 0), (JOIN, 1, 4, 7), (KILL, 2, 0, 8)]  # fmt: skip
    keys = sorted(world.heap.keys[: int(world.heap.size[0])].tolist())
    assert keys == sorted([
        key_of(0, COMMAND, 0, 0), key_of(60, COMMAND, 0, 1), key_of(20, COMMAND, 0, 2),
        key_of(40, OFFER, 0, 0), key_of(50, OFFER, 2, 0),
    ])  # fmt: skip
    assert world.radios["leaving"].tolist()[:N] == [0, 1, 0]
    for name in ("candidate", "told_at"):
        assert world.radios[name].tolist()[:N] == [-1] * N
    assert world.stations["number"].tolist() == [0, 1, 2]
    assert (
        len(set(world.stations["rng"].tolist()))
        == len(set(world.radios["offset"].tolist()[:N]))
        == N
    )


@pytest.mark.parametrize(("kept", "limits"), [
    ({}, (1, 1, 1, 0, 0)), ({"observe": False}, (0, 0, 0, 0, 0)),
    ({"trail": True, "observe": False}, (0, 0, 0, 1, 0)), ({"tap": True}, (1, 1, 1, 0, 1)),
])  # fmt: skip
def test_what_is_kept_has_room_and_beyond_for_a_batch(kept, limits):
    world = built(True, **kept)
    run = world.run[0]
    found = (run.row_limit, run.sent_limit, run.packet_limit, run.trail_limit, run.tap_limit)
    assert tuple(int(limit > 0) for limit in found) == limits
    assert len(world.rows) == len(world.sent) == len(world.packets) == max(run.row_limit, 1)
    assert len(world.trail) == max(run.trail_limit, 1)
    if run.tap_limit:
        assert run.tap_limit == len(world.taps) - 16 * N * BATCH == 1 << 11
    assert (run.broken_at, run.wanted) == (-1, planned().wanted)


@pytest.mark.parametrize(("saturated", "forced"), [(True, False), (False, True)])
def test_how_packets_are_handed_down_is_the_plans(saturated, forced):
    plan = planned()
    plan = Of(**{name: getattr(plan, name) for name in dir(plan) if name[0] != "_"}
              | {"saturated": saturated, "forced": forced})  # fmt: skip
    run = run_of(radio_build.build(plan, False))
    assert (run["saturated"], run["forced"]) == (int(saturated), int(forced))
    assert (run["slot_us"], run["ta_us"]) == (plan.params["slot_us"], plan.params["ta_us"])
    assert 0 < run["rng"] < 1 << 30


# What a station does.


@pytest.fixture
def do():
    return Do()


@pytest.mark.parametrize("flags", [STOP, STOP | 1, STOP | 3])
def test_whatever_else_is_said_a_stop_ends_the_frame_on_the_air(do, monkeypatch, flags):
    ended = []
    monkeypatch.setattr(medium, "break_off", lambda _world, *what: ended.append(what))
    world = world_of()
    world.out.count[0], world.out.frame = 1, [Of(kind=7, count=0, slots=2)]
    world.out.action = [Of(kind=SEND, a=0, b=0, c=flags)]
    loop.drain(world, do, 0, 80)
    assert (ended, do.said) == ([(0, 80)], [])


@pytest.mark.parametrize(("leaving", "after"), [(0, 1), (1, 1), (2, 2)])
def test_who_is_asked_to_leave_and_has_left_has_left(do, leaving, after):
    world = world_of(radio(leaving=leaving, deaf=1))
    world.commands = [Of(action=RETIRE, node=0, value=0, index=0)]
    loop.obey(world, do, 0, 9)
    assert world.radios[0].leaving == after
    assert do.said == [("on_input", 0, 509, LEAVE)]


def test_who_starts_is_told_the_shared_clock(do):
    world = world_of(radio(alive=0), period=100)
    loop.switch_on(world, do, 0, 250, loop.COLD)
    assert do.said == [("on_start", 0, 750, loop.COLD), ("on_input", 0, 750, CLOCK)]
    assert (world.item[0].handle, world.item[0].ago) == (0, 50)


def test_who_dies_falls_silent(do, monkeypatch):
    silent = []
    monkeypatch.setattr(medium, "silence", lambda _world, *what: silent.append(what))
    world = world_of()
    world.commands = [Of(action=KILL, node=0, value=0, index=0)]
    loop.obey(world, do, 0, 9)
    loop.obey(world, do, 0, 9)  # who is off already has nothing on the air
    assert (silent, world.radios[0].alive) == ([(0, 9)], 0)


def test_an_edge_that_changes_a_carrier_is_told_once_all_are_there(do):
    world = world_of()
    world.air[0].start, world.air[0].end = 60, 75
    heap.push(world.heap, key_of(70, heap.STARTS, 1, 0))
    loop.edge(world, do, heap.STARTS, 1, 0, 70)
    assert (world.told[:2], world.radios[1].noted) == ([1, 1], 1)
    world.told[0], world.radios[1].noted, world.radios[1].cd, world.radios[1].voc = 0, 0, 1, 1
    heap.push(world.heap, key_of(85, heap.ENDS, 1, 0))
    loop.edge(world, do, heap.ENDS, 1, 0, 85)
    assert world.told[:2] == [1, 1]


@pytest.mark.parametrize(("checks", "before", "broken"), [
    (1, 0, loop.BROKEN_FRAME), (0, 0, 0), (1, 3, 3),
])  # fmt: skip
def test_a_receiver_that_changes_a_frame_is_told_on(do, checks, before, broken):
    """Those that hear it later are handed the same."""
    world = world_of(checks=checks, broken=before, broken_node=-1)
    world.air[0].start, world.air[0].end = 60, 75
    world.radios[1].present, world.radios[1].candidate = 1, 0
    world.heap.keys[0], world.heap.size[0] = key_of(85, heap.ENDS, 1, 0), 1
    seen = iter(range(9))
    do.digest = lambda _: next(seen)
    loop.edge(world, do, heap.ENDS, 1, 0, 85)
    assert world.run[0].broken == broken
    assert world.run[0].broken_node == (0 if broken == loop.BROKEN_FRAME else -1)
