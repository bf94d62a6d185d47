"""The fence in whole numbers against shapely's floats; every value on the way below 2^30."""

from math import cos, hypot, pi, sin

import pytest
import shapely
from hypothesis import assume, given
from hypothesis import strategies as st

from innervate.dialect import plain
from innervate.networks.mesh.protocol import fence as mesh_fence
from innervate.networks.mesh.protocol.constants import CLEAR, CROSS, PREDICT
from innervate.networks.mesh.protocol.fields import PARAMS

Params = plain.make("Params", PARAMS)
EXTENT = 23_000
ERROR = 0.51
FAR = mesh_fence.FAR


def bounded(name):
    """An operator of int that asserts what the dialect asks of every value."""

    def operate(*operands):
        value = getattr(int, name)(*operands)
        assert value is NotImplemented or abs(value) < 1 << 30, (name, operands)
        return value if value is NotImplemented else Small(value)

    return operate


BINARY = ("add", "sub", "mul", "floordiv", "lshift", "rshift")
Small = type(
    "Small",
    (int,),
    {f"__{name}__": bounded(f"__{name}__") for name in (*BINARY, "neg", "abs")}
    | {f"__r{name}__": bounded(f"__r{name}__") for name in BINARY},
)


def fence(*rings, **values):
    params = Params()
    at = 0
    for ring in rings:
        for k, (x, y) in enumerate(ring):
            params.px[at + k], params.py[at + k] = Small(x), Small(y)
            params.after[at + k] = at + (k + 1) % len(ring)
        at += len(ring)
    params.points = at
    params.unit_cm = Small(1)
    params.clear_margin = Small(20)
    params.predict_ms = Small(500)
    for name, value in values.items():
        setattr(params, name, Small(value))
    return params


def star(centre, angles, radii):
    return [
        (round(centre[0] + r * cos(a)), round(centre[1] + r * sin(a)))
        for a, r in zip(sorted(angles), radii, strict=True)
    ]


@st.composite
def stars(draw, centre, least, most):
    count = draw(st.integers(3, 12))
    steps = [draw(st.floats(0.3, 1)) for _ in range(count)]
    angles = [2 * pi * sum(steps[:k]) / sum(steps) for k in range(count)]
    return star(centre, angles, [draw(st.floats(least, most)) for _ in range(count)])


@st.composite
def shapes(draw):
    """An outer ring and up to two holes, from the least to the greatest size."""
    scale = draw(st.sampled_from([0.002, 0.05, 1]))
    half = EXTENT * scale / 2
    rings = [draw(stars((half, half), 0.4 * half, half))]
    for side in draw(st.sampled_from([(), (0.3,), (-0.3, 0.3)])):
        centre = (half + side * half, half + draw(st.floats(-0.2, 0.2)) * half)
        rings.append(draw(stars(centre, 0.02 * half, 0.25 * half)))
    shape = shapely.Polygon(rings[0], rings[1:])
    assume(shape.is_valid)
    return rings, shape


def near(shape):
    """Positions in and around a shape, on its corners and edges, too."""
    west, south, east, north = (round(bound) for bound in shape.bounds)
    more = max(40, (east - west) // 3)
    corners = [(round(x), round(y)) for x, y in shape.exterior.coords]
    return (
        st.tuples(st.integers(west - more, east + more), st.integers(south - more, north + more))
        | st.sampled_from(corners)
        | st.tuples(st.integers(-32_768, 32_767), st.integers(-32_768, 32_767))
    )


def compare(params, shape, x, y):
    found = mesh_fence.margin(params, Small(x), Small(y))
    point = shapely.Point(x, y)
    true = shape.boundary.distance(point)
    if true > FAR:
        assert abs(found) == FAR
    elif true >= ERROR or true == 0:
        assert abs(abs(found) - true) <= ERROR
    else:
        assert abs(found) <= 1
    if true > 1e-6:  # shapely's own point-in-polygon is exact, its distance nearly
        assert (found > 0) == shape.contains(point)
        assert found != 0


@given(st.data())
def test_margin_is_that_of_shapely(data):
    rings, shape = data.draw(shapes())
    params = fence(*rings)
    for _ in range(8):
        compare(params, shape, *data.draw(near(shape)))


@given(
    st.lists(st.tuples(st.sampled_from([0, 1, 2, 11_500, 22_999, 23_000]), st.integers(0, 23_000)),
             min_size=3, max_size=6, unique=True),
    st.tuples(st.integers(-32_768, 32_767), st.integers(-32_768, 32_767)),
)  # fmt: skip
def test_the_largest_extent_keeps_within_its_bounds(ring, place):
    shape = shapely.Polygon(ring)
    assume(shape.is_valid)
    compare(fence(ring), shape, *place)


@given(st.integers(0, (1 << 30) - 1))
def test_root(n):
    found = mesh_fence.root(Small(n))
    assert found * found <= n < (found + 1) * (found + 1)


@given(st.integers(1, (1 << 30) - 1), st.floats(0, 32_767))
def test_division_by_a_root(n, true):
    a = int(true * n**0.5)
    true = min(a / n**0.5, FAR)
    assert abs(mesh_fence.over_root(Small(a), Small(n)) - true) <= 0.501


@given(st.data())
def test_closing_speed_is_what_the_distance_loses(data):
    rings, shape = data.draw(shapes())
    params = fence(*rings)
    x, y = data.draw(near(shape))
    vx, vy = data.draw(st.tuples(st.integers(-127, 127), st.integers(-127, 127)))
    edge = data.draw(st.integers(0, params.points - 1))
    after = params.after[edge]
    line = shapely.LineString(
        [(params.px[edge], params.py[edge]), (params.px[after], params.py[after])]
    )
    here = line.distance(shapely.Point(x, y))
    assume(1 < here < FAR)
    step = 1e-3
    there = line.distance(shapely.Point(x + step * vx, y + step * vy))
    found = mesh_fence.closing(params, edge, *(Small(v) for v in (x, y, vx, vy)))
    assert found == pytest.approx((here - there) / step, abs=0.51 + 30 * step * 127**2 / here)


SQUARE = [(0, 0), (1000, 0), (1000, 1000), (0, 1000)]
HOLE = [(400, 400), (400, 600), (600, 600), (600, 400)]


@pytest.mark.parametrize(
    ("place", "expected"),
    [
        ((300, 500), 100),  # nearer to the hole than to the outer ring
        ((500, 500), -100),  # in the hole
        ((500, 400), 0),
        ((0, 0), 0),
        ((-3, -4), -5),
        ((1000, 7), 0),
        ((1001, 7), -1),
        ((100, 30), 30),
        ((-30_000, 500), -FAR),
    ],
)
def test_margin_by_hand(place, expected):
    assert mesh_fence.margin(fence(SQUARE, HOLE), *place) == expected


def test_no_fence_is_never_crossed():
    assert mesh_fence.margin(Params(), 3, 4) == FAR


class Robot:
    outside = 0

    def __init__(self, params):
        self.params = params

    def at(self, x, y, vx=0, vy=0):
        """The alarm at this position, and the state after it."""
        self.x, self.y, self.vx, self.vy = (Small(value) for value in (x, y, vx, vy))
        return mesh_fence.judge(self, self.params), self.outside


def test_a_walk_out_and_back():
    robot = Robot(fence(SQUARE))  # 20 cm to clear, half a second ahead; 50 = 1 m/s
    assert robot.at(500, 500, 50) == (-1, 0)
    assert robot.at(950, 500, 50) == (-1, 0)  # 50 cm left at 1 m/s: not yet less than 500 ms
    assert robot.at(951, 500, 50) == (PREDICT, 1)
    assert robot.at(999, 500, 50) == (-1, 1)
    assert robot.at(1000, 500, 50) == (-1, 1)
    assert robot.at(1001, 500, 50) == (CROSS, 2)
    assert robot.at(1050, 500, -50) == (-1, 2)
    assert robot.at(980, 500, -50) == (-1, 2)  # inside by 20 cm: not more than that
    assert robot.at(979, 500, -50) == (CLEAR, 0)
    assert robot.at(960, 500, -50) == (-1, 0)
    assert robot.at(960, 500, 50) == (PREDICT, 1)


def test_a_prediction_is_taken_back_silently_and_late():
    robot = Robot(fence(SQUARE))
    assert robot.at(960, 500, 50) == (PREDICT, 1)
    assert robot.at(960, 500, 30) == (-1, 1)  # 40 cm at 60 cm/s is late enough, but just
    assert robot.at(985, 500, 0) == (-1, 1)  # nearer than clear_margin
    assert robot.at(960, 500, -50) == (-1, 0)
    assert robot.at(1002, 500, 127) == (CROSS, 2)


def test_the_wall_ahead_counts_not_only_the_nearest():
    robot = Robot(fence(SQUARE))
    assert robot.at(970, 10, 100) == (PREDICT, 1)


def test_larger_units_predict_the_same():
    for unit in (1, 10, 100):
        big = fence([(0, 0), (10_000, 0), (10_000, 10_000), (0, 10_000)], unit_cm=unit)
        robot = Robot(big)
        ahead = 100 // unit  # 2 m/s for half a second
        assert robot.at(10_000 - ahead, 5000, 100) == (-1, 0)
        assert robot.at(10_000 - ahead + 1, 5000, 100) == (PREDICT, 1)


def test_bounds_are_really_looked_at():
    with pytest.raises(AssertionError):
        mesh_fence.length(Small(30_000), Small(30_000))
    assert hypot(mesh_fence.REACH, mesh_fence.REACH) ** 2 < 1 << 30
