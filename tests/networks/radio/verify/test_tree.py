"""A tree of draws: which values are tried, which runs follow from one, and where it begins."""

import itertools
from dataclasses import replace

import pytest

from innervate.networks.radio.verify import tree
from innervate.networks.radio.verify.fuzz import drawn, smaller, trouble
from innervate.networks.radio.verify.grid import Grid, Point, points
from innervate.networks.radio.verify.tree import FEW, Asked, Grown, Tree, values
from innervate.verify.draws import branches


@pytest.mark.parametrize(
    ("count", "tried"),
    [(1, [0]), (2, [0, 1]), (FEW, list(range(6))), (FEW + 1, [0, 3, 6]), (100, [0, 50, 99])],
)
def test_of_few_values_all_are_tried_and_of_many_the_ends_and_the_middle(count, tried):
    assert values(count) == tried


def test_the_first_draws_are_answered_by_the_script_and_all_others_by_a_generator():
    asked = Asked(3)
    asked.begin((1, 2))
    told = []
    for count in (4, 100, 5, 7, 7, 7):
        asked.ask(count)
        told.append(asked.answer)
    assert told[:3] == [1, 99, 0]
    assert asked.ranges == [4, 100, 5]
    assert all(0 <= one < 7 for one in told[3:])
    again = Asked(3)
    for _ in range(2):  # the same draws in every run
        again.begin((1, 2))
        for count in (4, 100, 5, 7, 7, 7):
            again.ask(count)
        assert again.answer == told[-1]
    again.begin(())
    assert (again.ranges, again.script) == ([], ())


def test_every_answer_to_every_draw_is_run_once():
    """Draws out of 2, 3 and, only after a 1 first, 10."""

    def ranges_of(script):
        first = script[0] if script else 0
        return [2, 3, *([10] if first else [])]

    todo, seen = [()], []
    while todo:
        script = todo.pop()
        ranges = ranges_of(script)
        full = script + (0,) * (len(ranges) - len(script))
        seen.append(full)
        todo += branches(script, [len(values(count)) for count in ranges])
    wanted = [*itertools.product([0], range(3)), *itertools.product([1], range(3), range(3))]
    assert sorted(seen) == sorted(wanted)


def test_points_are_all_offers_and_delays_with_the_first_at_0():
    grid = Grid(3, "paper", 0, offers_us=(0, 52), delays_us=(1, 2))
    found = list(points(replace(grid, draws=0)))
    assert len(found) == len(set(found)) == 2**2 * 2**3
    assert {point.offers_us[0] for point in found} == {0}
    assert found[0] == Point((0, 0, 0), (1, 1, 1), ((), (), ()))
    assert found[-1] == Point((0, 52, 52), (2, 2, 2), ((), (), ()))


@pytest.mark.parametrize(("limit", "ended", "runs"), [(0, "complete", 6), (4, "limit", 4),
                                                      (6, "limit", 6)])  # fmt: skip
def test_a_search_counts_its_runs_and_what_breaks(monkeypatch, limit, ended, runs):
    """Two points; of each three runs, of which the one that draws a 2 breaks."""
    made = Tree(Grid(2, "paper", 0, offers_us=(0,), delays_us=(1, 2)), 2)

    def run(plan, advance, asked, script):
        asked.begin(script)
        asked.ask(3)
        return (5 if asked.answer == 2 else 0), []

    monkeypatch.setattr(tree, "_run", run)
    monkeypatch.setattr(tree.loop, "bind", lambda _: None)
    told = []
    grown = tree.search(made, limit=limit, progress=lambda one: bool(told.append(one.runs)))
    assert (grown.ended, grown.runs, grown.deepest, told) == (ended, runs, 1, [])
    first = Point((0, 0), (1,), ((), ()))
    assert grown.first == {5: (first, (2,))}
    assert grown.broken == {5: 2 if runs == 6 else 1}


def test_a_search_that_is_ended_says_so(monkeypatch):
    monkeypatch.setattr(tree, "_run", lambda _plan, _advance, asked, script: (
        asked.begin(script) or 0, []))  # fmt: skip
    monkeypatch.setattr(tree.loop, "bind", lambda _: None)
    made = Tree(Grid(4, "paper", 0, offers_us=(0, 1), delays_us=(1, 2)), 2)
    told = []
    grown = tree.search(made, progress=lambda one: told.append(one.runs) or len(told) == 2)
    assert (grown.ended, told, grown.runs) == ("interrupted", [20, 40], 40)
    assert grown.as_dict()["broken"] == {}
    assert Grown(made, 1, 2, 0.12345, {}, {}, "complete").as_dict()["wall_s"] == 0.123


def test_smaller_teams_are_smaller():
    import random

    for seed in range(20):
        team = drawn(random.Random(seed), seed)
        found = list(smaller(team))
        assert all(one != team for one in found)
        counts = {one["stations"] for one in found if "stations" in one} - {team["stations"]}
        assert counts == ({team["stations"] - 1} if team["stations"] > 2 else set())
    assert trouble({"lost_silently": 0}) == ""
    assert trouble({"lost_silently": 2}) == "2 packets lost silently"
