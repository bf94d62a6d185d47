"""Walks against a fence: when they cross and how far they get."""

from math import hypot
from types import SimpleNamespace

import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from innervate.networks.mesh.analysis import fence
from innervate.scenario.robots import Walk

SQUARE = [(0, 0), (1000, 0), (1000, 1000), (0, 1000)]
HOLE = [(400, 400), (400, 600), (600, 600), (600, 400)]
SHAPE = shapely.Polygon(SQUARE, [HOLE])


def edges(*rings):
    return [(ring[k - 1], corner) for ring in rings for k, corner in enumerate(ring)]


RING = edges(SQUARE, HOLE)
places = st.tuples(st.integers(-500, 1500), st.integers(-500, 1500))
walks = st.lists(places, min_size=2, max_size=5).map(
    lambda points: Walk(0, tuple((1000 * (k + 1), x, y) for k, (x, y) in enumerate(points)))
)


def test_out_and_back_at_one_metre_a_second():
    walk = Walk(0, ((1_000_000, 900, 500), (4_000_000, 1200, 500), (7_000_000, 900, 500)))
    assert fence.crossings(RING, walk, 10e6) == [(2e6, True), (6e6, False)]
    assert fence.crossings(RING, walk, 5e6) == [(2e6, True)]
    assert fence.overrun_cm(RING, walk, 2e6, 2.07e6) == pytest.approx(7)
    assert fence.overrun_cm(RING, walk, 2e6, 10e6) == pytest.approx(200)
    assert fence.overrun_cm(RING, walk, 0, 2e6) == 0
    assert fence.overrun_cm(RING, walk, 5e6, 5e6) == 0


def test_a_hole_is_outside_and_its_middle_the_worst():
    walk = Walk(0, ((0, 300, 500), (400_000, 700, 500)))
    assert fence.crossings(RING, walk, 1e6) == [(100_000, True), (300_000, False)]
    assert fence.overrun_cm(RING, walk, 0, 1e6) == pytest.approx(100, abs=fence.CLOSE_CM)


def test_to_touch_or_follow_the_fence_is_not_to_cross_it():
    touch = Walk(0, ((0, 900, 500), (1000, 1000, 500), (2000, 900, 400)))
    along = Walk(0, ((0, 900, 0), (1000, 100, 0), (2000, 100, 100)))
    assert fence.crossings(RING, touch, 1e6) == fence.crossings(RING, along, 1e6) == []
    assert fence.overrun_cm(RING, touch, 0, 1e6) == fence.overrun_cm(RING, along, 0, 1e6) == 0


def test_the_worst_place_is_found_where_it_is():
    """From (400, 450) to (600, 590) of a hole: 150 / 340 of the way both edges are as near."""
    walk = Walk(0, ((0, 400, 450), (1_000_000, 600, 590)))
    worst = 200 * 150 / 340
    assert fence.overrun_cm(RING, walk, 0, 1e6) == pytest.approx(worst, abs=fence.CLOSE_CM)
    assert fence.CLOSE_CM == 1e-3


SIDES = [
    (0, 0, 1000, 0),
    (1000, 0, 1000, 1000),
    (1000, 1000, 0, 1000),
    (0, 1000, 0, 0),
    (400, 400, 400, 600),
    (400, 600, 600, 600),
    (600, 600, 600, 400),
    (600, 400, 400, 400),
]


@pytest.mark.parametrize("side", SIDES)
@pytest.mark.parametrize("turn", [1, -1])
def test_the_fence_itself_is_inside_all_round_and_so_are_its_corners(side, turn):
    a, b = (side[:2], side[2:])[::turn]
    x, y = ((one + other) / 2 for one, other in zip(a, b, strict=True))
    for place in (a, b, (x, y)):
        assert fence.margin_cm(RING, place) == 0
    along = Walk(0, ((0, *a), (1000, *b)))
    standing = Walk(0, ((0, x, y),))
    for walk in (along, standing):
        assert fence.crossings(RING, walk, 1e6) == []
        assert fence.overrun_cm(RING, walk, 0, 1e6) == 0


def test_a_hair_beyond_the_fence_is_outside():
    for place, inside in (((500, 1000 + 1e-10), True), ((500, 1000 + 1e-8), False),
                          ((1000 + 1e-8, 500), False), ((1000 - 1e-8, 500), True)):  # fmt: skip
        walk = Walk(0, ((0, 500, 500), (1000, *place)))
        found = fence.crossings(RING[:4], walk, 1e6)
        assert (found == []) == inside or found[-1].time_us == pytest.approx(1000)
        assert (fence.margin_cm(RING, place) >= 0) == inside


def test_until_a_time_is_before_that_time_and_a_walk_begins_at_its_first_point():
    walk = Walk(0, ((1_000_000, 900, 500), (3_000_000, 1100, 500)))
    assert fence.crossings(RING, walk, 2e6) == []
    assert fence.crossings(RING, walk, 2e6 + 1) == [(pytest.approx(2e6), True)]
    assert fence.crossings(RING, walk, 1e6) == []
    assert fence.position_cm(walk, 0) == fence.position_cm(walk, 1_000_000) == (900, 500)
    assert fence.position_cm(walk, 1_500_000) == (950, 500)
    assert fence.position_cm(walk, 3_000_000) == fence.position_cm(walk, 9e9) == (1100, 500)
    outside = Walk(0, ((0, 1100, 500), (1_000_000, 900, 500)))
    assert fence.crossings(RING, outside, 1e6) == [(500_000, False)]
    assert fence.overrun_cm(RING, outside, 250_000, 1e6) == pytest.approx(50)


def test_an_edge_of_no_length_is_a_point():
    ring = [*edges(SQUARE), ((0, 0), (0, 0))]
    assert fence.margin_cm(ring, (3, 4)) == 3
    assert fence.margin_cm(ring, (-3, -4)) == -5
    with pytest.raises(ValueError, match=r"empty|arg"):
        fence.margin_cm([], (1, 1))


def test_a_robot_that_never_moves():
    outside = Walk(0, ((0, 1300, 1400),))
    assert fence.crossings(RING, outside, 1e6) == []
    assert fence.overrun_cm(RING, outside, 0, 1e6) == hypot(300, 400)
    with pytest.raises(ValueError, match="point"):
        fence.position_cm(Walk(0, ()), 3)


@given(places)
def test_margin_is_that_of_shapely(place):
    point = shapely.Point(place)
    sign = 1 if SHAPE.covers(point) else -1
    true = sign * SHAPE.boundary.distance(point)
    assert fence.margin_cm(RING, place) == pytest.approx(true)


@given(walks)
@settings(max_examples=60)
def test_the_way_outside_is_that_of_shapely(walk):
    crossed = fence.crossings(RING, walk, 1e6)
    first = fence.margin_cm(RING, fence.position_cm(walk, 0)) < 0
    assert [c.outward for c in crossed] == [(k % 2 == 0) != first for k in range(len(crossed))]
    line = shapely.LineString([(x, y) for _t, x, y in walk.points])
    if line.length:
        samples = shapely.points([fence.position_cm(walk, t) for t in range(0, 6000, 25)])
        worst = shapely.distance(SHAPE, samples).max()
        found = fence.overrun_cm(RING, walk, 0, 6000)
        assert worst - fence.CLOSE_CM <= found <= worst + 2828 * 25 / 1000


@given(walks)
@settings(max_examples=60)
def test_every_crossing_lies_on_the_fence(walk):
    for time_us, _outward in fence.crossings(RING, walk, 1e6):
        assert abs(fence.margin_cm(RING, fence.position_cm(walk, time_us))) < 1e-6


def test_edges_of_a_plan_lie_in_the_world():
    params = {"unit_cm": 10, "points": 3, "px": [0, 5, 5, 0], "py": [0, 0, 7, 0]}
    plan = SimpleNamespace(params=params | {"after": [1, 2, 0, 0]}, origin_cm=(-100, 40))
    corners = [(-100, 40), (-50, 40), (-50, 110)]
    assert fence.edges_of(plan) == [(corners[k], corners[(k + 1) % 3]) for k in range(3)]
