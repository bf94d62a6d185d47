"""Radio on a grid: practical CSMA/CD-R is in order, the published one has ties."""

import pytest

from innervate.run import radio_grid as grid
from innervate.run.errors import RunError


def test_a_grid_has_all_its_points():
    made = grid.Grid(stations=3, offers_us=(0, 52), parts=2)
    assert len(set(grid.points(made))) == made.points == 2**2 * 2**3 * 2**3


def test_draws_fall_where_they_should():
    made = grid.Grid(stations=4, draws=2, parts=3)
    from innervate.protocol import rng

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
    assert told[-1] == "So: two turns overlap: their order is open."
    assert sum("sends a CR-R" in line for line in told) >= 2


def test_a_grid_that_cannot_be_is_refused():
    with pytest.raises(RunError, match="2 to 4 stations"):
        grid.base_plan(grid.Grid(stations=5))
    with pytest.raises(RunError, match="at most twice"):
        grid.base_plan(grid.Grid(delays_us=(52, 208)))
