"""The medium of a field by hand: who is met by what, who receives, whose place is given back."""

from types import SimpleNamespace

import pytest

from innervate.dialect.rng import step
from innervate.sim import taps
from innervate.sim.channel.world import Heap
from innervate.sim.field import medium, powers, queue
from innervate.sim.field.states import ALIVE, COMMITTED, DEAD, FREE, HELD, ON_AIR

NODES, PLACES = 3, 4
LOW15 = 0x7FFF


def world_of(collisions=1, capture=powers.CAPTURE_ONE, prob=32_768):
    """Three nodes; everybody hears node 0 with 100, node 1 with 40 and node 2 with 7."""
    return SimpleNamespace(
        run=[SimpleNamespace(nodes=NODES, free=PLACES, broken=0, broken_node=-1, on_air=0,
                             collisions=collisions, turnaround=192, phy_bytes=6, byte_ns=32_000,
                             transmissions=0, received=0, rng=12345, capture=capture,
                             tap_limit=0)],
        radios=[SimpleNamespace(state=ALIVE, deaf=0, on_air=0) for _ in range(NODES)],
        air=[SimpleNamespace(node=0, state=FREE, start=0, end=0) for _ in range(PLACES)],
        free=list(range(PLACES)), on_air=[0] * PLACES, sums=[0] * NODES, got=[0] * NODES,
        power=[0, 100, 100, 40, 0, 40, 7, 7, 0], prob=[prob] * 9, worst=[0] * (PLACES * NODES),
        heap=Heap([0] * 32, [0]),
    )  # fmt: skip


def begun(world, *senders, at=1_000, length=30):
    """Frames of these nodes are on the air from now on: their places."""
    places = []
    for node in senders:
        places.append(medium.reserve(world, node, HELD))
        medium.commit(world, places[-1], at - 192)
        medium.start(world, places[-1], at, length)
    return places


def lost(found):
    """A tap that notes who missed a frame, and why."""
    return lambda world, place, node, time, out, why: found.append((node, why))


def test_places_are_given_out_until_there_are_none_and_come_back():
    world = world_of()
    places = [medium.reserve(world, 1, HELD) for _ in range(PLACES)]
    assert sorted(places) == list(range(PLACES))
    assert (world.air[places[0]].node, world.air[places[0]].state) == (1, HELD)
    assert world.run[0].broken == 0
    assert medium.reserve(world, 2, HELD) == medium.NONE
    assert (world.run[0].broken, world.run[0].broken_node) == (medium.BROKEN_AIR, 2)
    assert medium.reserve(world, 0, HELD) == medium.NONE
    assert world.run[0].broken_node == 2  # who was the first
    medium.release(world, places[1])
    assert world.air[places[1]].state == FREE
    assert medium.reserve(world, 0, HELD) == places[1]


def test_a_frame_lasts_as_long_as_its_bytes_and_those_in_front():
    world = world_of()
    assert medium.airtime(world, 30) == 36 * 32
    world.run[0].byte_ns = 208_333
    assert medium.airtime(world, 1) == 1458  # 1,458.331 us, rounded down


def test_who_turns_round_is_deaf_and_misses_what_is_not_over():
    world = world_of()
    (place,) = begun(world, 0)
    end = world.air[place].end
    for later, worst in ((end, 0), (end - 1, medium.DEAF)):
        world.worst[place * NODES + 1] = 0
        medium.miss(world, 1, later)
        assert world.worst[place * NODES + 1] == worst
    other = medium.reserve(world, 2, HELD)
    medium.commit(world, other, 2_000)
    assert (world.air[other].state, world.radios[2].deaf) == (COMMITTED, 1)
    assert world.worst[place * NODES + 2] == medium.DEAF
    keys = sorted(world.heap.keys[: world.heap.size[0]])
    assert queue.key_of(2_192, queue.STARTS, 2, other) in keys
    ideal = world_of(collisions=0)
    medium.commit(ideal, medium.reserve(ideal, 1, HELD), 0)
    assert ideal.radios[1].deaf == 0


def test_signals_add_up_at_everybody_and_go_away_again():
    world = world_of()
    first, second = begun(world, 0, 1)
    assert world.sums == [40, 100, 140]
    assert (world.run[0].on_air, world.run[0].transmissions) == (2, 2)
    # What the frames met: the one of 0 was met by 40 at node 2, that of 1 by 100.
    assert world.worst[first * NODES + 2] == 40
    assert world.worst[second * NODES + 2] == 100
    medium.leave(world, first)
    assert world.sums == [40, 0, 40]
    assert (world.run[0].on_air, world.on_air[0]) == (1, second)
    assert (world.radios[0].deaf, world.radios[0].on_air, world.radios[1].deaf) == (0, 0, 1)
    medium.note_interference(world)
    assert world.worst[second * NODES + 2] == 100  # the worst there was


def test_who_is_joined_again_to_a_sender_hears_it_and_does_not_receive_it(monkeypatch):
    monkeypatch.setattr(powers, "strength", lambda table, cdb: cdb)
    world, found = world_of(), []
    world.cut, world.strengths, world.rssi = [0] * 9, None, list(world.power)
    medium.set_cut(world, 0, 2, 1)
    mine, other = begun(world, 0, 1)
    assert (world.worst[other * NODES + 2], world.sums[2]) == (0, 40)
    medium.set_cut(world, 2, 0, 0)
    assert (world.worst[other * NODES + 2], world.sums[2]) == (100, 140)
    met = world.worst[mine * NODES : mine * NODES + 3]
    assert met == [medium.DEAF, medium.DEAF, medium.SEVERED]
    medium.leave(world, mine)
    assert medium.receivers(world, mine, lost(found)) == 0
    assert found == [(1, taps.SENDING), (2, taps.CUT)]
    medium.sever(world, 1, 0)
    assert world.worst[other * NODES] == medium.DEAF  # it was sending all the time


@pytest.mark.parametrize(("ratio", "captured"), [(2.5, True), (2.4, True), (2.6, False)])
def test_the_stronger_frame_is_captured_if_it_is_so_much_stronger(ratio, captured):
    world = world_of(capture=int(powers.CAPTURE_ONE * ratio))
    place, _ = begun(world, 0, 1)
    world.run[0].tap_limit, missed = 1, []
    count = medium.receivers(world, place, lost(missed))
    assert count == world.run[0].received == int(captured)
    assert world.got[:count] == [2] * count
    expected = [(1, taps.SENDING)] + [(2, taps.COLLISION)] * (not captured)
    assert missed == expected


@pytest.mark.parametrize(("more", "count"), [(0, 0), (1, 1)])
def test_a_frame_comes_in_if_the_draw_is_below_the_chance(more, count):
    drawn = step(12345) & LOW15
    world = world_of(prob=drawn + more)
    world.radios[1].state = DEAD
    (place,) = begun(world, 0)
    world.power[2] = 100
    assert medium.receivers(world, place, lost([])) == count


def test_who_is_dead_or_hears_nothing_is_not_asked():
    world = world_of()
    world.power[1] = 0
    world.radios[2].state = DEAD
    (place,) = begun(world, 0)
    assert world.worst[place * NODES + 2] == medium.DEAF
    assert medium.receivers(world, place, lost([])) == 0
    assert world.run[0].rng == 12345


@pytest.mark.parametrize(("cdbm", "dbm"), [
    (-6_850, -68), (-6_851, -69), (-6_949, -69), (-20_000, -128), (20_000, 127), (49, 0), (50, 1),
])  # fmt: skip
def test_a_node_measures_whole_decibels(cdbm, dbm):
    world = SimpleNamespace(run=[SimpleNamespace(nodes=2)], rssi=[0, cdbm, 0, 0])
    assert medium.rssi_dbm(world, 0, 1) == dbm


@pytest.mark.parametrize(("state", "left"), [(ON_AIR, 0), (HELD, 1), (COMMITTED, 1)])
def test_a_frame_whose_sender_died_is_none_any_more(state, left):
    world = world_of()
    (place,) = begun(world, 0)
    world.air[place].state = state
    free = world.run[0].free
    medium.abandon(world, place)
    assert world.run[0].on_air == left
    assert world.run[0].free == free + (state == HELD)
    assert (world.sums == [0, 0, 0]) == (state == ON_AIR)
