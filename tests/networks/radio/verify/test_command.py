"""What `innervate verify radio` looks at is what docs/verify.md says, and its lines count it."""

from types import SimpleNamespace

import pytest

from innervate.networks.radio.verify import command
from innervate.networks.radio.verify.grid import WORDS, Found, Grid
from innervate.networks.radio.verify.tree import Grown, Tree
from innervate.verify.errors import VerifyError

BOTH = (52, 104)  # delays of a pair, us


def asked(cells=None, rule=None):
    options = SimpleNamespace(cells=cells, rule=rule, states=0)
    return [(one.func, one.args[0]) for one in command.explorations(None, options)]


@pytest.mark.parametrize(("cells", "rule", "stations", "turnarounds"), [
    (None, None, (2, 3), (0, 2000)), (2, "practical", (2,), (0, 2000)),
    (4, None, (2, 3, 4), (0, 2000)), (3, "paper", (2, 3), (0,)),
])  # fmt: skip
def test_a_grid_and_a_tree_of_every_number_of_stations(cells, rule, stations, turnarounds):
    found = asked(cells, rule)
    assert [one for one, _ in found] == [command._search, command._grow] * (len(found) // 2)
    wanted = [(count, ta) for count in stations for ta in turnarounds]
    for func in (command._search, command._grow):
        grids = [grid for one, grid in found if one is func]
        assert [(grid.stations, grid.turnaround_us) for grid in grids] == wanted
        assert {grid.mode for grid in grids} == {rule or "practical"}


@pytest.mark.parametrize(("stations", "offers", "parts", "draws"), [
    (2, (0, 52, 104, 208), 3, 2), (3, (0, 52, 208), 2, 1), (4, (0, 52, 208), 2, 1),
])  # fmt: skip
def test_a_grid_combines_moments_both_delays_and_parts_of_the_first_draws(
    stations, offers, parts, draws
):
    grid = next(one for _, one in asked(4) if one.stations == stations)
    assert (grid.offers_us, grid.delays_us, grid.parts, grid.draws) == (offers, BOTH, parts, draws)
    pairs = stations * (stations - 1) // 2
    points = len(offers) ** (stations - 1) * 2**pairs * parts ** (draws * stations)
    assert grid.points == points


@pytest.mark.parametrize(("stations", "depth", "delays"), [(2, 6, BOTH), (3, 4, (104,)),
                                                           (4, 3, (104,))])  # fmt: skip
@pytest.mark.parametrize("turnaround_us", [0, 2000])
def test_a_tree_has_fewer_moments_and_delays_and_every_draw(stations, depth, delays, turnaround_us):
    tree = command._tree(Grid(stations, "practical", turnaround_us))
    assert (tree.depth, tree.grid.delays_us, tree.grid.offers_us) == (depth, delays, (0, 52))
    assert (tree.grid.stations, tree.grid.turnaround_us) == (stations, turnaround_us)


@pytest.mark.parametrize(("cells", "rule", "words"), [
    (1, None, "2 to 4 stations for radio, not 1"), (5, None, "2 to 4 stations for radio, not 5"),
    (2, "nosuch", 'practical or paper for radio, not "nosuch"'),
])  # fmt: skip
def test_what_there_is_not_is_refused_at_once(cells, rule, words):
    with pytest.raises(VerifyError, match=words):
        asked(cells, rule)


@pytest.mark.parametrize("which", [0, 1], ids=["grid", "tree"])
@pytest.mark.parametrize(("states", "stops"), [(1, False), (0, True), (0, False)])
def test_what_was_looked_at_in_part_is_not_complete(which, states, stops, monkeypatch):
    small = Grid(2, "practical", offers_us=(0,), delays_us=(52,), draws=1, parts=2)
    monkeypatch.setattr(command, "_grids", lambda *_: [small])
    monkeypatch.setattr(command, "_tree", lambda grid: Tree(grid, 5))
    options = SimpleNamespace(cells=2, rule="", states=states)
    explore = list(command.explorations(None, options))[which]
    case = explore(lambda *_: stops)
    few = stops and which == 0  # fewer points than those after which it is asked whether to stop
    assert case.is_complete == (case.record["ended"] == "complete")
    assert case.is_complete == (not states and (not stops or few))


def test_the_lines_say_what_was_looked_at_and_what_broke():
    grid = Grid(2, "practical", 2000)
    found = Found(grid, 8, 1.26, {}, {}, "complete")
    head = "2 stations, practical, turnaround 2000 us: "
    well = "all delivered, in order, nothing lost silently"
    (line,) = command._lines(found)
    assert line == f"{head}8 of {grid.points:,} points in 1.3 s; {well}"
    grown = Grown(Tree(grid, 6), 1316, 9, 2.0, {}, {}, "complete")
    begun = f"{head}every answer to the first 6 draws, 1,316 runs"
    assert command._tree_line(grown) == f"{begun} in 2.0 s; {well}"
    grown.ended = "limit"
    code = next(iter(WORDS))
    grown.broken[code] = 3
    assert command._tree_line(grown) == f"{begun} (limit) in 2.0 s; BROKEN: {WORDS[code]} (3 runs)"


@pytest.mark.parametrize("which", [0, 1], ids=["grid", "tree"])
def test_what_breaks_is_a_story_that_can_be_written(which, monkeypatch):
    """As published, stations that draw the same begin together."""
    small = Grid(2, "paper", offers_us=(0,), delays_us=(104,), draws=1, parts=1)
    monkeypatch.setattr(command, "_grids", lambda *_: [small])
    monkeypatch.setattr(command, "_tree", lambda grid: Tree(grid, 6))
    options = SimpleNamespace(cells=2, rule="paper", states=0 if which == 0 else 1)
    case = list(command.explorations(None, options))[which](lambda *_: False)
    assert case.is_broken
    *told, last = case.story.lines()
    assert last == f"So: {case.story.title}"
    assert case.story.title in WORDS.values()
    assert not [line for line in told if "So: " in line]
    assert sum("Station 0 is offered a packet at 0 us." in line for line in told) == 1
    assert sum("sends its packet, 0 to 1040 us." in line for line in told) == 2
    assert ("What stations draw, in the order of their asking: 0 of" in told[0]) == (which == 1)
