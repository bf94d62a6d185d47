"""Interface ports are drawn beside their cell, on the side of its port, where there is room."""

import math

import numpy as np
import pytest

from innervate.networks.skin.view import scene
from innervate.topology import from_patches
from innervate.topology.patch import DOWN, UP, E, W

H = math.sqrt(3) / 2
# Where a neighbour by that port can lie in a honeycomb, the first choice first [skin 1].
SIDES = {W: [(-1, 0)], E: [(1, 0)], UP: [(0.5, -H), (-0.5, -H)], DOWN: [(0.5, H), (-0.5, H)]}
ALL = [place for places in SIDES.values() for place in places]


@pytest.mark.parametrize("port", SIDES)
def test_a_port_of_the_pc_lies_beside_its_cell(port):
    graph = from_patches([(1, 1, "Z")])
    graph.add_interface(0, port)
    cell, interface = scene.places(graph)
    assert tuple(interface - cell) == pytest.approx(SIDES[port][0])


def beside(port, taken, centre=(0.0, 0.0)):
    others = np.array([(0.0, 0.0), *taken], float)
    return scene._beside(np.zeros(2), port, np.array(centre), others)


@pytest.mark.parametrize("port", [UP, DOWN])
def test_where_one_side_of_the_port_is_taken_it_is_on_the_other(port):
    first, second = SIDES[port]
    assert beside(port, [first]) == pytest.approx(second)


@pytest.mark.parametrize("port", SIDES)
@pytest.mark.parametrize("away", ALL)
def test_where_the_side_of_the_port_is_taken_it_is_away_from_the_middle(port, away):
    taken = [side for side in SIDES[port] if side != away]
    found = beside(port, taken, centre=(-away[0], -away[1]))
    assert found == pytest.approx(away)


@pytest.mark.parametrize(("near", "moves"), [(0.69, True), (0.71, False)])
def test_what_would_overlap_is_taken(near, moves):
    """Nearer than 0.7 of a pitch."""
    found = beside(E, [(1 + near, 0.0)], centre=(-1.0, 0.1))
    assert (found != pytest.approx((1, 0))) == moves


def test_where_all_is_taken_it_is_where_most_room_is():
    taken = [(0.7 * x, 0.7 * y) for x, y in ALL if (x, y) != (-0.5, H)] + [(-0.75, 1.5 * H)]
    found = beside(W, taken)
    rooms = {side: min(math.dist(side, one) for one in [(0, 0), *taken]) for side in ALL}
    assert max(rooms.values()) < 0.7
    assert found == pytest.approx(max(rooms, key=rooms.get))


def test_cells_are_drawn_a_pitch_apart():
    graph = from_patches([(3, 2, "Z")])
    places = scene.places(graph)
    assert math.dist(places[0], places[1]) == pytest.approx(1)
    assert tuple(places[3] - places[0]) == pytest.approx((0.5, H))


def test_the_usual_distance_is_of_cells_that_are_apart():
    """A line of five: of four cables one joins two cells that lie at one place."""
    graph = from_patches([(5, 1, "Z")])
    for xs, pitch in (([0, 3, 3, 8, 8.5], 3.0), ([0, 0, 0, 0, 0], 14.0), ([0, 2, 2, 2, 9], 4.5)):
        cells = np.array([(x, 0.0) for x in xs])
        assert scene._pitch(graph, cells) == pitch
