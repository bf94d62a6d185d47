"""Radio on a grid: practical CSMA/CD-R is in order, the published one has ties."""

import pytest

from innervate.networks.radio.verify import command
from innervate.networks.radio.verify import grid as grid
from innervate.networks.radio.verify import tree as tree
from innervate.running.errors import RunError


def test_a_grid_has_all_its_points():
    made = grid.Grid(stations=3, offers_us=(0, 52), parts=2)
    assert len(set(grid.points(made))) == made.points == 2**2 * 2**3 * 2**3


def test_draws_fall_where_they_should():
    made = grid.Grid(stations=4, draws=2, parts=3)
    from innervate.dialect import rng

    for parts, states in grid.seeds_of(made).items():
        assert len(set(states)) == 4
        for state in states:
            x = state
            for part in parts:
                x = rng.step(x)
                assert (x & rng.LOW15) * 3 >> 15 == part


@pytest.mark.parametrize("turnaround_us", [0, 2000])
def test_practical_is_in_order(turnaround_us):
    found = grid.search(grid.Grid(2, "practical", turnaround_us, offers_us=(0, 52, 208), parts=2))
    assert (found.ended, found.broken) == ("complete", {})
    some = grid.search(grid.Grid(3, "practical", turnaround_us, parts=2), limit=150)
    assert (some.done, some.broken) == (150, {})


@pytest.mark.slow
@pytest.mark.parametrize("turnaround_us", [0, 2000])
@pytest.mark.parametrize("packet_slots", [5, 25])
def test_practical_is_in_order_with_four(turnaround_us, packet_slots):
    made = grid.Grid(4, "practical", turnaround_us, packet_slots, (0, 104), parts=2)
    found = grid.search(made)
    assert (found.ended, found.broken) == ("complete", {})


def test_the_published_mode_has_unordered_ties():
    made = grid.Grid(2, "paper", parts=2)
    found = grid.search(made)
    assert set(found.broken) == {grid.OVERLAP}
    told = grid.story(made, found.first[grid.OVERLAP])
    assert command._lines(found)[-1].endswith("So: two turns overlap: their order is open.")
    assert sum("sends a CR-R" in line for line in told) >= 2


def test_a_grid_that_cannot_be_is_refused():
    with pytest.raises(RunError, match="2 to 4 stations"):
        grid.base_plan(grid.Grid(stations=5))
    with pytest.raises(RunError, match="at most twice"):
        grid.base_plan(grid.Grid(delays_us=(52, 208)))


@pytest.mark.parametrize("turnaround_us", [0, 2000])
def test_practical_is_in_order_whatever_two_stations_draw(turnaround_us):
    made = grid.Grid(2, "practical", turnaround_us, offers_us=(0,), delays_us=(104,))
    grown = tree.search(tree.Tree(made, depth=4))
    assert (grown.ended, grown.broken) == ("complete", {})
    assert grown.deepest == 4
    assert grown.runs >= 3**2


@pytest.mark.slow
@pytest.mark.parametrize("turnaround_us", [0, 2000])
@pytest.mark.parametrize(("stations", "depth"), [(2, 8), (3, 6), (4, 5)])
def test_practical_is_in_order_whatever_is_drawn(stations, depth, turnaround_us):
    delays_us = (52, 104) if stations == 2 else (104,)
    made = grid.Grid(stations, "practical", turnaround_us, 5, (0, 52), delays_us)
    grown = tree.search(tree.Tree(made, depth), limit=4000)
    assert grown.broken == {}


def test_ties_do_not_depend_on_what_is_drawn():
    made = grid.Grid(2, "paper", offers_us=(0,), delays_us=(104,))
    grown = tree.search(tree.Tree(made, depth=2))
    assert grown.ended == "complete"
    assert grown.broken.keys() == {grid.OVERLAP}
    assert tree.search(tree.Tree(made, depth=2), limit=1).ended == "limit"


def test_all_values_of_a_small_draw_and_the_ends_of_a_large_one():
    assert tree.values(3) == [0, 1, 2]
    assert tree.values(1000) == [0, 500, 999]


def test_what_was_found_is_told_to_programs():
    point = grid.Point((0, 52), (104,), ((1,), (2,)))
    asked = grid.Grid(2, "practical", offers_us=(0, 52), delays_us=(52, 104), parts=3)
    found = grid.Found(asked, 7, 1.23456, {grid.ORDER: 3}, {grid.ORDER: point}, "interrupted")
    told = found.as_dict()
    said = "a turn is not the one that was announced"
    assert {key: told[key] for key in told if key not in ("grid", "first")} == {
        "points": 2 * 2 * 9, "done": 7, "wall_s": 1.235, "ended": "interrupted",
        "broken": {said: 3},
    }  # fmt: skip
    assert told["grid"]["packet_slots"] == 5
    assert told["first"] == {
        said: {"offers_us": (0, 52), "delays_us": (104,), "parts": ((1,), (2,))}
    }
