"""Robots that move, by hand: where they are, what they are told, what their links do."""

from types import SimpleNamespace as Of

import pytest

from innervate.sim.field import medium, motion, powers, queue
from innervate.sim.field.states import ALIVE, DEAD
from innervate.topology.placement import UNHEARD

SECOND = 1_000_000


def world_of(*points, moving=1):
    """Node 1 walks; its path stands behind a point of somebody else's."""
    path = [(0, 77, 77), *points]
    run = {"nodes": 3, "collisions": 1, "origin_x": 0, "origin_y": 0, "unit": 1, "rssi50": -9_500}
    return Of(
        run=[Of(moving=moving, **run)],
        radios=[Of(x=0, y=0, state=ALIVE) for _ in range(3)],
        walks=[Of(node=1, point=1, last=len(points), placed=0, noise=0)],
        points=[Of(time=time, x=x, y=y) for time, x, y in path],
    )  # fmt: skip


@pytest.fixture
def renewed(monkeypatch):
    """Whose links were worked out anew."""
    found = []
    monkeypatch.setattr(motion, "renew", lambda _world, node: found.append(node))
    return found


PATH = ((10, 0, 0), (10 + SECOND, 100, -50), (10 + 2 * SECOND, 100, -50), (10 + 3 * SECOND, 0, 0))


@pytest.mark.parametrize(("time", "place", "speed", "point"), [
    (9, (0, 0), (0, 0), 1), (10, (0, 0), (50, -25), 1), (10 + SECOND // 2, (50, -25), (50, -25), 1),
    (10 + SECOND - 1, (100, -50), (50, -25), 1), (10 + SECOND, (100, -50), (0, 0), 2),
    (10 + 2 * SECOND, (100, -50), (-50, 25), 3), (10 + 3 * SECOND, (0, 0), (0, 0), 4),
    (10 + 9 * SECOND, (0, 0), (0, 0), 4),
])  # fmt: skip
def test_a_walker_is_between_two_points_and_knows_its_speed(renewed, time, place, speed, point):
    world = world_of(*PATH)
    motion.walk_on(world, 0, time)
    assert (world.radios[1].x, world.radios[1].y) == place
    assert (world.walks[0].vx, world.walks[0].vy) == speed
    assert world.walks[0].point == point


@pytest.mark.parametrize(("x", "vx"), [(254, 127), (256, 128), (-400, -200), (3, 2), (-3, -1)])
def test_a_speed_is_in_2_cm_per_second(renewed, x, vx):
    world = world_of((0, 0, 0), (SECOND, x, 0))
    motion.walk_on(world, 0, 0)
    assert world.walks[0].vx == vx


def test_links_are_worked_out_when_it_is_first_placed_and_whenever_it_has_moved(renewed):
    world = world_of((0, 0, 0), (SECOND, 0, 100), (2 * SECOND, 0, 100))
    for time, count in ((0, 1), (1, 1), (SECOND // 2, 2), (SECOND, 3), (SECOND + 5, 3)):
        motion.walk_on(world, 0, time)
        assert renewed == [1] * count
    still = world_of((0, 0, 0), moving=0)
    motion.walk_on(still, 0, 5)
    assert (renewed, still.walks[0].placed) == ([1] * 3, 1)


@pytest.mark.parametrize(("place", "unit", "told"), [
    ((1_234, 777), 10, (103, 108)), ((204, -300), 10, (0, 0)), ((205, -295), 10, (1, 1)),
    ((194, -306), 10, (-1, -1)), ((10**9, -(10**9)), 1, (10**9 - 200, 300 - 10**9)),
])  # fmt: skip
def test_a_place_is_in_units_from_the_corner(place, unit, told):
    world = world_of((0, 0, 0))
    run, radio = world.run[0], world.radios[1]
    run.origin_x, run.origin_y, run.unit = 200, -300, unit
    radio.x, radio.y = place
    motion.believe(world, 0)
    assert (world.walks[0].told_x, world.walks[0].told_y) == told


@pytest.mark.parametrize("state", [ALIVE, DEAD])
def test_who_is_on_learns_its_place_again_and_again(renewed, state):
    world, said = world_of((0, 30, 40)), []
    world.run[0].sample, world.heap = 500, Of(keys=[0] * 4, size=[0])
    world.radios[1].state = state
    do = Of(note_carriers=lambda _world, _do, time: said.append(time),
            tell_place=lambda _world, _do, *what: said.append(what))  # fmt: skip
    motion.sample(world, do, 0, 70)
    assert said == ([70, (0, 70)] if state == ALIVE else [70])
    assert (world.walks[0].told_x, world.walks[0].told_y) == (30, 40)
    assert world.heap.keys[0] == queue.key_of(570, queue.SAMPLE, 1, 0)


def test_all_links_of_who_moves_are_set_both_ways_and_then_what_they_do(monkeypatch):
    world, said = world_of((0, 0, 0)), []
    world.losses = None
    world.radios[0].x, world.radios[2].y = 30, 40
    monkeypatch.setattr(powers, "loss", lambda _table, cm2: cm2)
    monkeypatch.setattr(motion, "set_link", lambda _world, *what: said.append(what))
    monkeypatch.setattr(medium, "note_interference", lambda _world: said.append("met"))
    motion.renew(world, 1)
    assert said == [(1, 0, 900), (0, 1, 900), (1, 2, 1_600), (2, 1, 1_600), "met"]
    said.clear()
    world.run[0].collisions = 0
    motion.renew(world, 1)
    assert said[-1] == (2, 1, 1_600)


def test_a_link_is_as_loud_as_at_a_metre_less_what_it_loses(monkeypatch):
    world, said = world_of((0, 0, 0)), []
    world.base, world.rssi, world.prob, world.chances = [UNHEARD] * 9, [5] * 9, [5] * 9, None
    world.base[5] = -4_000
    monkeypatch.setattr(powers, "chance", lambda _table, over: over)
    monkeypatch.setattr(medium, "set_power", lambda _world, *what: said.append(what))
    motion.set_link(world, 1, 2, 3_000)
    motion.set_link(world, 2, 1, 3_000)  # which is not heard at all
    assert (world.rssi, world.prob) == ([5] * 5 + [-7_000, 5, 5, 5], [5] * 5 + [2_500, 5, 5, 5])
    assert said == [(1, 2)]
