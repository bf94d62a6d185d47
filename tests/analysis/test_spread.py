"""Places for nodes of which only the links are known."""

from itertools import combinations
from math import dist

import numpy as np
import pytest

from innervate.analysis.spread import spread


@pytest.mark.parametrize("count", [0, 1, 2, 12])
def test_without_links_nodes_stand_on_a_circle(count):
    places = spread(count, []).tolist()
    assert len(places) == count
    radius = max(1.0, count / 6)
    assert all(dist(place, (0, 0)) == pytest.approx(radius) for place in places)
    if count == 12:
        sides = {round(dist(places[i], places[i - 1]), 6) for i in range(12)}
        assert len(sides) == 1
        assert places[0] == pytest.approx((0, -2))  # the first at the top, then clockwise
        assert places[3] == pytest.approx((2, 0))


# Nodes are moved aside by 0.15, so that no two lie on one place.
MOVED = 0.31


def test_a_line_is_drawn_as_a_line():
    places = spread(5, [(0, 1), (1, 2), (3, 2), (3, 4)]).tolist()
    for a, b in combinations(range(5), 2):
        assert dist(places[a], places[b]) == pytest.approx(b - a, abs=MOVED)
    assert places[0][0] < places[4][0]  # the first at the left


def test_whom_no_link_joins_is_a_hop_farther_than_the_farthest():
    places = spread(4, [(0, 1), (1, 2)]).tolist()
    near = min(dist(places[3], places[k]) for k in range(3))
    assert near > 1.5
    assert dist(places[0], places[2]) == pytest.approx(2, abs=MOVED + 0.2)


def test_parts_that_no_link_joins_lie_farther_apart_than_those_that_one_does():
    places = spread(4, [(0, 1), (2, 3)]).tolist()
    for a, b in combinations(range(4), 2):
        far = dist(places[a], places[b])
        assert (far < 1.4) == ((a, b) in {(0, 1), (2, 3)}), (a, b, far)


def test_who_is_as_far_from_everybody_lies_by_itself():
    places = spread(6, list(combinations(range(6), 2))).tolist()
    assert min(dist(a, b) for a, b in combinations(places, 2)) > 0.05


def test_a_ring_is_drawn_the_same_whatever_the_processor_takes_for_its_axes(monkeypatch):
    ring = [(k, (k + 1) % 5) for k in range(5)]
    places, found = spread(5, ring), np.linalg.eigh

    def turned(matrix):
        """The same spaces, other axes in those that have more than one."""
        values, vectors = found(matrix)
        c, s = np.cos(0.7), np.sin(0.7)
        assert values[-1] == pytest.approx(values[-2])
        vectors[:, -2:] = vectors[:, -2:] @ np.array([[c, s], [-s, c]])
        return values, -vectors

    monkeypatch.setattr(np.linalg, "eigh", turned)
    assert spread(5, ring) == pytest.approx(places, abs=1e-9)
