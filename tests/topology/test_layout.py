"""Where cells are drawn, to the millimetre: patches by their cables or in a grid, layers."""

import math

import pytest

from innervate.topology import from_patches
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


def test_layers_of_a_free_graph_are_centred():
    links = [("pc.0", "a"), ("a", "b"), ("a", "c"), ("b", "d"), ("a", "e")]
    graph = free_graph(links)
    places = dict(zip(graph.names, cell_places(graph), strict=False))
    step = 2 * PITCH_MM
    assert places["a"] == pytest.approx((step, 0))
    assert [places[name] for name in "bce"] == near((0, step), (step, step), (2 * step, step))
    assert places["d"] == pytest.approx((step, 2 * step))
    assert math.dist(places["a"], places["d"]) == pytest.approx(2 * step)
