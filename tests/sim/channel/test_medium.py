"""The channel that all share, edge by edge: what is heard, what is spoilt, who is told."""

from types import SimpleNamespace

import pytest

from innervate.dialect.rng import step
from innervate.sim import heap
from innervate.sim.channel import medium
from innervate.sim.channel.world import Heap
from innervate.sim.heap import AIRS, ENDS, READY, key_of

LOW15 = 0x7FFF
STATIONS = 3


def radio(**more):
    given = {"present": 0, "alive": 1, "deaf": 0, "candidate": medium.NOBODY, "noted": 0, "cd": 0,
             "voc": 0, "garble": 0, "fade": 0, "ready_at": 0, "told_at": 0}  # fmt: skip
    return SimpleNamespace(**given | more)


def world_of(*radios, loss=0):
    """Three stations; each hears the others after 10 and 20 us, the next one first."""
    count = STATIONS
    return SimpleNamespace(
        run=[SimpleNamespace(stations=count, loss=loss, rng=12345, garbled=0)],
        radios=[*radios, *(radio() for _ in range(count - len(radios)))],
        air=[
            SimpleNamespace(start=0, end=0, spoilt=0, at_start=0, at_end=0)
            for _ in range(count * AIRS)
        ],
        degree=[count - 1] * count, order=[1, 2, 0, 2, 0, 0, 1, 0, 0], delay=[10, 20, 0] * count,
        told=[0] * (count + 2), heap=Heap([0] * 64, [0]),
    )  # fmt: skip


def due(world):
    """What is in the queue, in order."""
    return sorted(world.heap.keys[: world.heap.size[0]])


def test_so_many_reservations_are_spoilt_and_no_more():
    one, seen = radio(garble=3, fade=2), []
    for _ in range(7):
        air = SimpleNamespace(spoilt=0)
        medium.impair(world_of(one), one, air)
        seen.append(air.spoilt)
    assert seen == [1, 1, 1, 2, 2, 0, 0]
    assert (one.garble, one.fade) == (0, 0)


@pytest.mark.parametrize(("state", "candidate"), [
    ({}, 5), ({"present": 1}, medium.NOBODY), ({"alive": 0}, medium.NOBODY),
    ({"deaf": medium.SENDING}, medium.NOBODY), ({"deaf": medium.HEARING}, medium.NOBODY),
])  # fmt: skip
def test_a_frame_is_followed_if_it_comes_alone_to_who_listens(state, candidate):
    world = world_of(radio(candidate=9, **state))
    before = world.radios[0].present
    medium.begin_signal(world, 0, 5)
    assert (world.radios[0].candidate, world.radios[0].present) == (candidate, before + 1)


@pytest.mark.parametrize(("state", "spoilt", "received"), [
    ({"candidate": 5}, 0, True), ({"candidate": 5}, 1, False), ({"candidate": 4}, 0, False),
    ({"candidate": medium.NOBODY}, 0, False), ({"candidate": 5, "alive": 0}, 0, False),
])  # fmt: skip
def test_a_frame_is_received_if_nothing_met_it(state, spoilt, received):
    world = world_of(radio(present=1, **state))
    world.air[5].spoilt = spoilt
    assert bool(medium.end_signal(world, 0, 5)) == received
    assert (world.radios[0].present, world.radios[0].candidate) == (0, medium.NOBODY)
    assert world.run[0].rng == 12345  # without loss no chance is asked


@pytest.mark.parametrize(("more", "received"), [(0, True), (1, False)])
def test_noise_takes_a_frame_whose_draw_is_below_its_share(more, received):
    world = world_of(radio(present=1, candidate=5))
    drawn = step(12345)
    world.run[0].loss = (drawn & LOW15) + more
    assert bool(medium.end_signal(world, 0, 5)) == received
    assert world.run[0].garbled == more
    assert world.run[0].rng == drawn


def test_stations_whose_carrier_changed_are_told_in_order():
    changed = {"present": 1}
    world = world_of(*(radio(**changed) for _ in range(3)))
    for node in (2, 0, 1, 0):
        medium.note_carrier(world, node)
    assert world.told[:4] == [3, 0, 1, 2]


@pytest.mark.parametrize(("state", "told"), [
    ({"present": 0}, False), ({"present": 1}, True), ({"present": 1, "cd": 1, "voc": 1}, False),
    ({"present": 2, "cd": 1, "voc": 1}, True), ({"present": 2, "cd": 1}, False),
    ({"present": 0, "cd": 1}, True), ({"present": 1, "deaf": medium.SENDING}, False),
    ({"present": 1, "deaf": medium.HEARING}, True), ({"present": 1, "alive": 0}, False),
    ({"present": 1, "noted": 1}, False), ({"present": 1, "noted": 2}, True),
])  # fmt: skip
def test_a_change_is_one_of_carrier_or_of_a_single_voice(state, told):
    world = world_of(radio(**state))
    medium.note_carrier(world, 0)
    assert world.told[0] == told


@pytest.mark.parametrize(("start", "end", "spoilt", "cut_to"), [
    (100, 300, 0, 200), (200, 300, 0, 200), (250, 300, 0, 250), (100, 201, 1, 200),
    (100, 200, 0, None), (100, 300, 2, None),
])  # fmt: skip
def test_who_falls_silent_ends_what_is_on_the_air_now(start, end, spoilt, cut_to):
    world = world_of()
    air = world.air[1 * AIRS + 2]
    air.start, air.end, air.spoilt = start, end, spoilt
    medium.silence(world, 1, 200)
    if cut_to is None:
        assert (air.end, air.spoilt, due(world)) == (end, spoilt, [])
    else:
        unsent = start >= 200  # and no edge of it has passed anybody
        assert (air.end, air.spoilt) == (cut_to, medium.UNSENT if unsent else medium.GARBLED)
        what = (1 << heap.AIR_BITS) | 2
        assert due(world) == [key_of(cut_to + 10, ENDS, 2, what)]
        assert [bool(medium.is_end(world, 1, 2, air, at)) for at in (cut_to, cut_to + 10)] == [
            False, True,
        ]  # fmt: skip
        air.at_end = 2
        assert not medium.is_end(world, 1, 2, air, cut_to + 10)


def test_who_breaks_off_listens_at_once_and_is_told_nothing():
    world = world_of(radio(deaf=medium.SENDING, ready_at=900, told_at=950))
    medium.break_off(world, 0, 200)
    assert (world.radios[0].ready_at, world.radios[0].told_at) == (200, medium.NEVER)
    assert due(world) == [key_of(200, READY, 0, 0)]
    medium.break_off(world, 1, 200)  # who does not send has nothing to break off
    assert len(due(world)) == 1


@pytest.mark.parametrize(("cursor", "left"), [(0, 1), (1, 1), (2, 0), (3, 0)])
def test_an_edge_goes_from_station_to_station_until_all_had_it(cursor, left):
    world = world_of()
    what = (2 << heap.AIR_BITS) | 1
    heap.push(world.heap, key_of(100, ENDS, 0, what))
    medium.go_on(world, ENDS, what, 100, cursor)
    assert len(due(world)) == left
    if left:
        place = 2 * STATIONS + cursor
        assert due(world) == [key_of(100 + world.delay[place], ENDS, world.order[place], what)]
