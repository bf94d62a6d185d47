"""What is shown of a skin in space, by tables that are written here: ways, loads, who is off."""

from types import SimpleNamespace as Of

import numpy as np
import polars as pl
import pytest

from innervate.networks.skin.export.rrd import _Changes, _off, _ports_and_loads
from innervate.networks.skin.export.scenes import _balls, _touch
from innervate.networks.skin.export.states import TOUCH_WINDOW_US, States, places_m
from innervate.scenario.actions.cables import CUT, KILL, RESTART, REVIVE
from tests.networks.skin.runs import free, plan_of

# pc.0 - a - b - c, and d at pc.1; every port is named.
TREE = plan_of(free([("pc.0", "a.0"), ("a.1", "b.0"), ("b.1", "c.0"), ("pc.1", "d.0")],
                    duration_s=0.25))  # fmt: skip
A, B, C, D = range(4)
BLUE, ORANGE, YELLOW = (0.0, 0.45, 0.7), (0.9, 0.4, 0.0), (0.95, 0.9, 0.25)


def tables(*routes, received=(), outages=((0, 4, 0),)):
    """Rows (us, cell, port of the parent), (us, cell, proximity, three forces)."""
    found = {
        "routes": pl.DataFrame(list(routes) or [(10**9, 0, 0)], ["time_us", "cell", "new"],
                               orient="row"),
        "outages": pl.DataFrame(list(outages), ["time_us", "unrouted", "cut_off"], orient="row"),
    }  # fmt: skip
    if received:
        names = ["time_us", "cell", "proximity", "force_0", "force_1", "force_2"]
        found["received"] = pl.DataFrame(list(received), names, orient="row")
    return found


def at_the_end(*routes, **more):
    """The states after all of these rows."""
    *_, (_, found) = States(TREE, tables(*routes, **more), 100_000).snapshots()
    return found


def seen(of, *routes, step_us=100_000, **more):
    return [(at, of(now)) for at, now in States(TREE, tables(*routes, **more), step_us).snapshots()]


def test_what_happens_at_a_moment_is_seen_a_step_later():
    routes = (99_999, A, 0), (100_000, D, 0), (249_999, B, 0), (250_000, C, 0)
    assert seen(lambda now: now.hops, *routes) == [
        (100_000, [1, -1, -1, -1]), (200_000, [1, -1, -1, 1]), (250_000, [1, 2, -1, 1]),
    ]  # fmt: skip
    outages = (0, 4, 0), (100_000, 3, 1), (150_000, 2, 2)
    assert seen(lambda now: (now.unrouted, now.cut_off), outages=outages) == [
        (100_000, (4, 0)), (200_000, (2, 2)), (250_000, (2, 2)),
    ]  # fmt: skip


def test_a_ring_leads_nowhere_nor_do_those_behind_it():
    now = at_the_end((1, A, 1), (2, B, 0), (3, C, 0), (4, D, 0))
    assert now.hops == [-1, -1, -1, 1]
    assert now.hop == [B, A, B, 4]
    assert at_the_end((1, A, 3)).hop[A] == -1  # a port without a cable
    assert at_the_end((1, A, 0), (2, A, -1)).hop[A] == -1


def test_a_cable_carries_the_samples_of_all_behind_it():
    routes = (1, A, 0), (2, B, 0), (3, C, 0), (4, D, 0)
    assert _ports_and_loads(at_the_end(*routes)) == ([0, 0, 0, 1], [3, 2, 1, 1])
    assert _ports_and_loads(at_the_end(*routes[1:])) == ([-1, -1, -1, 1], [0, 0, 0, 1])
    assert _ports_and_loads(at_the_end(routes[0], routes[2])) == ([0, -1, -1, -1], [1, 0, 0, 0])


@pytest.mark.parametrize(("at", "off"), [
    (99, set()), (100, {1}), (199, {1}), (200, {1, 2}), (299, {1, 2}), (300, {2}), (999, {2}),
])  # fmt: skip
def test_who_is_off_is_so_from_the_moment_it_is_killed_until_it_is_revived(at, off):
    faults = [(100, KILL, 1), (150, CUT, -1), (200, KILL, 2), (250, RESTART, 1), (300, REVIVE, 1)]
    plan = Of(faults=[Of(at_us=when, action=what, node=who) for when, what, who in faults])
    assert _off(plan, at) == off


def test_what_has_not_changed_has_no_row():
    changes = _Changes()
    for at, row in ((1, [1, 2]), (2, [1, 2]), (3, [1, 2, 3]), (4, [1, 2])):
        changes.add(at, np.array(row))
    assert (changes.times_us, changes.lengths) == ([1, 3, 4], [2, 3, 2])


FELT = 200_000, B, 70, 3000, 0, 3001


def test_the_touch_is_known_for_a_while_and_then_nobody_knows():
    now = at_the_end(received=(FELT,))
    assert now.force == [0, 2000, 0, 0]
    for at, known in ((200_000, True), (200_000 + TOUCH_WINDOW_US, True),
                      (200_001 + TOUCH_WINDOW_US, False)):  # fmt: skip
        told = _touch(at, now)
        assert told["known"] == [False, known, False, False]
        assert (told["force_mn"][B], told["proximity"][B]) == ((2000, 70) if known else (0, 0))


def colours(at, now):
    entities = _balls(at, now)["entities"]
    spheres = [one["color"] for one in entities[0]["spheres"]]
    return [tuple(one[part] for part in "rgb") for one in spheres], entities[1]["lines"][0]


def test_a_cell_is_yellow_by_its_force_and_its_line_leads_to_its_parent():
    hard = (200_000, A, 0, 9000, 9000, 9000)
    now = at_the_end((1, A, 0), (2, B, 0), received=(FELT, hard))
    found, lines = colours(250_000, now)
    mixed = tuple(round(a / 3 + 2 * b / 3, 3) for a, b in zip(BLUE, YELLOW, strict=True))
    assert found == [YELLOW, mixed, ORANGE, ORANGE]
    places = [tuple(point.values()) for point in lines["points"]]
    assert places == [tuple(round(x, 4) for x in now.places[cell]) for cell in (B, A)]
    assert colours(200_001 + TOUCH_WINDOW_US, now)[0] == [BLUE, BLUE, ORANGE, ORANGE]


def test_places_are_metres_with_the_second_axis_up():
    flat = plan_of(free([("pc.0", "a.0"), ("a.1", "b.0")])).graph
    assert [z for *_, z in places_m(flat)] == [0.0, 0.0]
    assert [y <= 0 for _, y, _ in places_m(flat)] == [True, True]
    assert min(y for _, y, _ in places_m(flat)) < 0
    solid = Of(positions=[1000, 2000, -500, 0, 0, 1])
    assert places_m(solid) == [(1.0, 2.0, -0.5), (0.0, 0.0, 0.001)]
