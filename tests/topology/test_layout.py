"""Where cells are drawn, to the millimetre: patches by their cables or in a grid, layers."""

import math
import random
from itertools import combinations

import numpy as np
import pytest

from innervate.topology import body_graph, from_patches, layout
from innervate.topology.free import free_graph
from innervate.topology.layout import CABLED_PATCHES_MAX, GAP_MM, PITCH_MM, ROW_MM, cell_places

W, E, UP, DOWN = range(4)


def near(*points):
    return [pytest.approx(point, abs=1e-9) for point in points]


@pytest.mark.parametrize(("rows", "wide"), [(1, 28.0), (2, 35.0), (5, 35.0)])
def test_patches_that_no_cable_joins_stand_side_by_side(rows, wide):
    places = cell_places(from_patches([(3, rows, "Z"), (1, 1, "Z")]))
    assert places[-1] == pytest.approx((wide + GAP_MM, 0.0))
    assert max(y for _, y in places) == pytest.approx(ROW_MM * (rows - 1))


@pytest.mark.parametrize(("patch", "across", "wide", "high"), [
    ((1, 1, "Z"), 9, 28.0, 28.0), ((2, 3, "Z"), 9, 49.0, 28 + 2 * ROW_MM),
    ((9, 1, "Z"), 4, 140.0, 28.0),
])  # fmt: skip
def test_many_patches_stand_in_rows_of_a_square(patch, across, wide, high):
    count = CABLED_PATCHES_MAX + 1
    places = cell_places(from_patches([patch] * count))
    firsts = places[:: patch[0] * patch[1]]
    assert firsts == near(*((wide * (i % across), high * (i // across)) for i in range(count)))
    # One less is not too many to look at their cables: all are to the right of each other.
    row = cell_places(from_patches([patch] * (count - 1)))
    assert {y for _, y in row[:: patch[0] * patch[1]]} == {0.0}


@pytest.mark.parametrize("place", [0, 7, CABLED_PATCHES_MAX])
def test_of_many_patches_the_widest_and_the_highest_say_how_far_apart_all_are(place):
    patches = [(1, 1, "Z")] * (CABLED_PATCHES_MAX + 2)
    patches[place], patches[place + 1] = (1, 3, "Z"), (3, 1, "Z")
    wide, high = 2 * PITCH_MM + GAP_MM, 2 * ROW_MM + GAP_MM
    places = cell_places(from_patches(patches))
    first = 0
    for i, (columns, rows, _) in enumerate(patches):
        assert places[first] == pytest.approx((wide * (i % 8), high * (i // 8)))
        first += columns * rows


def joined(*cables, cells=3):
    """Patches of one cell, and (cell, port, cell, port) joined."""
    graph = from_patches([(1, 1, "Z")] * cells)
    for a, port_a, b, port_b in cables:
        graph.connect(graph.end(a, port_a), graph.end(b, port_b))
    return cell_places(graph)


def test_patches_lie_a_cell_away_on_the_side_of_their_cable():
    assert joined((0, E, 1, W), cells=2) == near((0, 0), (PITCH_MM, 0))
    assert joined((0, W, 1, E), cells=2) == near((PITCH_MM, 0), (0, 0))
    assert joined((0, DOWN, 1, UP), cells=2) == near((0, 0), (0, ROW_MM))
    assert joined((0, E, 1, W), (0, W, 2, E)) == near((14, 0), (28, 0), (0, 0))


def test_where_the_side_is_taken_the_next_one_is():
    # Both at E of cell 0 in turn: the second one finds the place taken and goes to another side.
    places = joined((0, E, 1, W), (1, W ^ 1, 2, W))
    assert places == near((0, 0), (14, 0), (28, 0))
    ring = joined((0, E, 1, W), (1, E, 2, W), (2, E, 3, W), cells=4)
    assert [x for x, _ in ring] == pytest.approx([0, 14, 28, 42])


@pytest.mark.parametrize("order", [(0, 1), (1, 0)])
def test_where_no_room_is_near_a_patch_stands_to_the_right_of_all(order):
    """A cable in the middle of a patch of 27 x 27, another patch beside it."""
    graph = from_patches([(27, 27, "Z"), (1, 1, "Z"), (1, 1, "Z")])
    corners = {0: (0.0, 0.0), 1: (2 * 27 * PITCH_MM, 50.0)}
    middle, alone = graph.end(13 * 27 + 13, E), graph.end(27 * 27 + 1, W)
    known = {patch: corners[patch] for patch in order}
    place = layout._beside(graph, known, 0, middle, alone)
    assert place == (2 * 27 * PITCH_MM + GAP_MM, 0.0)


def test_layers_of_a_free_graph_are_centred():
    links = [("pc.0", "a"), ("a", "b"), ("a", "c"), ("b", "d"), ("a", "e")]
    graph = free_graph(links)
    places = dict(zip(graph.names, cell_places(graph), strict=False))
    step = 2 * PITCH_MM
    assert places["a"] == pytest.approx((step, 0))
    assert [places[name] for name in "bce"] == near((0, step), (step, step), (2 * step, step))
    assert places["d"] == pytest.approx((step, 2 * step))
    assert math.dist(places["a"], places["d"]) == pytest.approx(2 * step)


SIDES = ((-PITCH_MM, 0.0), (PITCH_MM, 0.0), (0.0, -ROW_MM), (0.0, ROW_MM))  # as ports are


def boxes(graph):
    """(low x, high x, low y, high y) of every patch as it is drawn."""
    places, found, first = cell_places(graph), [], 0
    for patch in graph.patches:
        xs, ys = zip(*places[first : first + patch.columns * patch.rows], strict=True)
        found.append((min(xs), max(xs), min(ys), max(ys)))
        first += patch.columns * patch.rows
    return found


def are_apart(a, b, share=1.0):
    """True if there is a cell's room between two boxes, one way or the other."""
    x, y = share * PITCH_MM - 1e-6, share * ROW_MM - 1e-6
    return a[1] + x < b[0] or b[1] + x < a[0] or a[3] + y < b[2] or b[3] + y < a[2]


def shapes(rng, count):
    return [(rng.randint(1, 4), rng.randint(1, 4), rng.choice("ZS")) for _ in range(count)]


def cable(graph, rng, a, b):
    """Joins two patches somewhere, if both have a port left; the two (cell, port)."""
    ends = []
    for patch in (a, b):
        free = [(cell, port) for cell in range(graph.cells) for port in graph.free_ports(cell)
                if graph.patch_of(cell) == patch]  # fmt: skip
        if not free:
            return None
        ends.append(rng.choice(free))
    graph.connect(*(graph.end(*end) for end in ends))
    return ends


@pytest.mark.parametrize("seed", range(60))
def test_a_patch_lies_as_near_its_cable_as_there_is_room(seed):
    """The cabled cells come to lie one, two ... steps apart, first on the side of their ports."""
    rng = random.Random(seed)
    graph = from_patches(shapes(rng, 2))
    (mine, port_a), (theirs, port_b) = cable(graph, rng, 0, 1)
    places = cell_places(graph)
    first, second = boxes(graph)
    ax, ay = places[mine]
    towards = [SIDES[port_a], SIDES[port_b ^ 1], *SIDES]
    for steps in (1, 2, 3, 5, 8):
        for dx, dy in towards:
            x, y = ax + steps * dx - places[theirs][0], ay + steps * dy - places[theirs][1]
            moved = (second[0] + x, second[1] + x, second[2] + y, second[3] + y)
            if are_apart(first, moved):
                assert (x, y) == pytest.approx((0, 0), abs=1e-6)
                return
    raise AssertionError("patches of four by four have room eight steps away")


@pytest.mark.parametrize("seed", range(40))
def test_patches_do_not_lie_on_each_other(seed):
    rng = random.Random(seed)
    count = rng.randint(3, 7)
    graph = from_patches(shapes(rng, count))
    for _ in range(rng.randint(0, 2 * count)):
        cable(graph, rng, *rng.sample(range(count), 2))
    drawn = boxes(graph)
    assert all(are_apart(a, b, 0.99) for a, b in combinations(drawn, 2))
    assert (min(box[0] for box in drawn), min(box[2] for box in drawn)) == pytest.approx((0, 0))


@pytest.mark.parametrize("count", [3, 4, 5, 8, 13, 21])
def test_a_skin_round_a_limb_is_unrolled_where_it_has_most_room(count):
    """Points of a long cylinder that stands anywhere: heights stay, and arcs become straight."""
    rng = np.random.default_rng(count)
    turns, heights = np.sort(rng.uniform(0, math.tau, count)), np.linspace(-900, 900, count)
    turns = np.concatenate([turns, turns + math.pi])  # so that their middle is the axis
    heights = np.concatenate([heights, heights])
    straight = np.stack([30 * np.cos(turns), 30 * np.sin(turns), heights], axis=1)
    basis = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    solid = straight @ basis.T + rng.uniform(-500, 500, 3)
    graph = body_graph(
        [f"c{i}" for i in range(2 * count)], [tuple(point) for point in solid.tolist()], 1e6, 1
    )
    x, y = np.array(cell_places(graph)).T
    assert sorted(y) == pytest.approx(sorted(heights + 900), abs=0.5)
    arcs = np.sort(turns % math.tau)
    widest = np.max(np.diff([*arcs, arcs[0] + math.tau]))
    assert x.min() == pytest.approx(0, abs=0.5)
    assert x.max() == pytest.approx(30 * (math.tau - widest), abs=0.5)
    gaps = np.sort(np.diff(np.sort(x)))
    assert gaps == pytest.approx(np.sort(np.diff([*arcs, arcs[0] + math.tau]))[:-1] * 30, abs=0.5)


def limb(axis, side, third):
    """A skin of four rings round a limb, 1.3 times as long as it is thick."""
    points = []
    for height in (-30.0, -10.0, 10.0, 30.0):
        for k in range(8):
            u, v = 17 * math.cos(k * math.pi / 4), 17 * math.sin(k * math.pi / 4)
            points.append(tuple(height * a + u * b + v * c
                                for a, b, c in zip(axis, side, third, strict=True)))  # fmt: skip
    return points


HALF = math.sqrt(0.5)
TURNS = {
    "x": ((1, 0, 0), (0, 1, 0), (0, 0, 1)), "z": ((0, 0, 1), (1, 0, 0), (0, 1, 0)),
    "x and y": ((HALF, HALF, 0), (HALF, -HALF, 0), (0, 0, 1)),
    "x against y": ((HALF, -HALF, 0), (HALF, HALF, 0), (0, 0, 1)),
    "y against z": ((0, HALF, -HALF), (0, HALF, HALF), (1, 0, 0)),
}  # fmt: skip


@pytest.mark.parametrize("way", TURNS)
def test_a_limb_is_unrolled_along_its_longest_axis_wherever_that_points(way):
    points = limb(*TURNS[way])
    axis = layout._longest_axis(points)
    along = sum(a * b for a, b in zip(axis, TURNS[way][0], strict=True))
    assert abs(along) == pytest.approx(1, abs=1e-6)
    assert layout._longest_axis([(0.0, 0.0, 0.0)]) == (1.0, 0.0, 0.0)


def test_cells_that_nothing_joins_with_the_pc_stand_at_the_bottom():
    graph = free_graph([("pc.0", "a"), ("a", "b"), ("x", "y")])
    rows = {name: y for name, (_, y) in zip(graph.names, cell_places(graph), strict=True)}
    step = 2 * PITCH_MM
    assert rows == {"a": 0, "b": step, "x": 2 * step, "y": 2 * step}
