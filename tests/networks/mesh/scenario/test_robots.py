"""Robots of a mesh: where they begin, how long each leg takes, where they wander."""

import itertools

import pytest

from innervate import scenario as scenarios
from innervate.scenario.errors import ScenarioError

PLACES = [
    {"name": f"r{k}", "x_m": x, "y_m": y} for k, (x, y) in enumerate([(0, 0), (30, 5), (8, 40)])
]
ALONE = {"kind": "mesh", "node": PLACES, "duration_s": 20.0}
LINKS = {"kind": "mesh", "nodes": 3, "link": [{"a": 0, "b": 1}, {"a": 1, "b": 2}],
         "duration_s": 20.0}  # fmt: skip


def walk(tables=ALONE, **robot):
    made = scenarios.plan(scenarios.from_dict(tables | {"robot": [{"node": 1, **robot}]}))
    (one,) = made.walks
    assert one.node == 1
    assert made.robots == [0, 1, 0]
    return list(one.points)


def test_one_that_does_not_move_stands_where_its_node_is():
    assert walk() == [(0, 3000, 500)]
    assert walk(start_s=2.5) == [(2_500_000, 3000, 500)]


def test_legs_take_as_long_as_they_are():
    way = [[0.014, 1], [3, 5], [3, 5], [3, 5.01], [-3, -2.99]]
    assert walk(waypoints=way, speed_mps=2.0, start_s=1.0) == [
        (1_000_000, 1, 100),
        (1_000_000 + 2_497_003, 300, 500),
        (1_000_000 + 2_497_003 + 5_000, 300, 501),
        (1_000_000 + 2_497_003 + 5_000 + 5_000_000, -300, -299),
    ]


def test_it_rests_where_it_has_come_to_but_not_at_first():
    assert walk(waypoints=[[0, 0], [1, 0], [1, 3]], speed_mps=1.0, pause_s=0.5) == [
        (0, 0, 0),
        (1_000_000, 100, 0),
        (1_500_000, 100, 0),
        (4_500_000, 100, 300),
    ]


def test_a_leg_takes_a_microsecond_at_least():
    (_, *first), (at, *last) = walk(waypoints=[[0, 0], [0.01, 0]], speed_mps=100.0, start_s=0)
    assert (first, last, at) == ([0, 0], [1, 0], 100)


@pytest.mark.parametrize(
    ("given", "box"),
    [
        ({"area": [30, 90, 10, 70]}, (1000, 7000, 3000, 9000)),
        ({"area": [10, 70, 30, 90]}, (1000, 7000, 3000, 9000)),
        ({}, (0, 0, 3000, 4000)),
    ],
)
def test_where_it_wanders(given, box):
    points = walk(random=True, speed_mps=5.0, **given, tables=ALONE | {"duration_s": 2000.0})
    assert points[0] == (0, 3000, 500)
    assert points[-2][0] < 2_000_000_000 <= points[-1][0]
    xs, ys = [x for _, x, _ in points[1:]], [y for _, _, y in points[1:]]
    low_x, low_y, high_x, high_y = box
    assert low_x <= min(xs) < low_x + 200
    assert high_x - 200 < max(xs) <= high_x
    assert low_y <= min(ys) < low_y + 200
    assert high_y - 200 < max(ys) <= high_y
    for (t0, x0, y0), (t1, x1, y1) in itertools.pairwise(points):
        far_cm = ((x1 - x0) ** 2 + (y1 - y0) ** 2) ** 0.5
        assert t1 - t0 == pytest.approx(far_cm / 500 * 1e6, abs=1)


def test_without_places_it_wanders_in_its_area_or_its_fence():
    points = walk(LINKS, random=True, area=[1, 2, 3, 4])
    assert all(100 <= x <= 300 and 200 <= y <= 400 for _, x, y in points)
    fence = {"polygon": [[0, 0], [7, 0], [7, 9], [0, 9]]}
    points = walk(LINKS | {"fence": fence}, random=True, speed_mps=50.0)
    assert all(0 <= x <= 700 and 0 <= y <= 900 for _, x, y in points)
    assert max(y for *_, y in points) > 700
    with pytest.raises(ScenarioError, match="robot n1 has no position; give it waypoints"):
        walk(LINKS)


def test_waypoints_say_where_its_node_begins():
    robot = [{"node": 2, "waypoints": [[12, 13], [14, 15]]}]
    made = scenarios.plan(scenarios.from_dict(ALONE | {"robot": robot}))
    assert made.positions_cm == [(0, 0), (3000, 500), (1200, 1300)]


def test_a_robot_is_named_once():
    with pytest.raises(ScenarioError, match="there are two robots r1; leave one out"):
        scenarios.plan(scenarios.from_dict(ALONE | {"robot": [{"node": 1}, {"node": "r1"}]}))


def test_one_that_turns_too_often_is_refused():
    with pytest.raises(ScenarioError, match="changes its way more than 100,000 times"):
        walk(random=True, speed_mps=100.0, area=[0, 0, 0.01, 0.01],
             tables=ALONE | {"duration_s": 1000.0})  # fmt: skip
