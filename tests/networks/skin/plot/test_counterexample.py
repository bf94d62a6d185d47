"""Where cells of a counterexample stand, and which of its moments are drawn."""

import pytest

from innervate.networks.skin.plot import counterexample
from innervate.networks.skin.verify import graphs, story
from innervate.networks.skin.verify.narrator import Scene

WIDE, HIGH = counterexample.PANEL


def told(graph, *scenes):
    return story.Story("", graph=graphs.parse(graph), scenes=list(scenes))


@pytest.mark.parametrize(("graph", "places"), [
    ("pc-1", [(1 / 2, 0, 1)]),
    ("pc-1 pc-2", [(1 / 3, 0, 1), (2 / 3, 0, 1)]),
    ("pc-1 1-2", [(1 / 2, 14, 1 / 2), (1 / 2, 0, 1)]),
    ("pc-1 1-2 2-3", [(1 / 2, 14, 1 / 3), (1 / 2, 0, 2 / 3), (1 / 2, 14, 1)]),
    ("pc-1 1-2 1-3", [(1 / 2, 14, 1 / 2), (1 / 3, 0, 1), (2 / 3, 0, 1)]),
])  # fmt: skip
def test_cells_stand_in_rows_by_their_hops_and_alone_off_the_line(graph, places):
    found = counterexample._places(told(graph))
    high = HIGH - 70
    assert found == [
        *(pytest.approx((WIDE * x + shift, 40 + high * depth)) for x, shift, depth in places),
        (WIDE / 2, 40),
    ]


def test_of_three_in_a_row_the_one_between_stands_lower():
    found = counterexample._places(told("pc-1 pc-2 pc-3"))
    assert [y for _, y in found[:3]] == [HIGH - 30, HIGH - 12, HIGH - 30]
    assert [x for x, _ in found[:3]] == [WIDE / 4, WIDE / 2, 3 * WIDE / 4]


@pytest.mark.parametrize(("moments", "shown"), [
    ("a", [0]), ("ab", [0, 1]), ("aab", [0, 2]), ("abb", [0, 1, 2]), ("aaba", [0, 2, 3]),
    ("aaaa", [0, 3]), ("aAa", [0, 1, 2]),
])  # fmt: skip
def test_what_changed_nothing_is_not_drawn_unless_it_is_the_last(moments, shown):
    known = {"a": ((0,), frozenset()), "A": ((0,), frozenset({(0, 1)})), "b": ((1,), frozenset())}
    scenes = [Scene(*known[one], actor) for actor, one in enumerate(moments)]
    assert counterexample._shown(told("pc-1", *scenes)) == shown
