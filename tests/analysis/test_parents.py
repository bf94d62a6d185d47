"""Who has a way, told from next hops, on networks that can be counted by hand."""

from innervate.analysis.parents import Harm, Ways, most_without, settled_us, time_without_us

# 0 is the sink; 1 and 2 are cabled to it, 3 to both, 1 and 2 to each other.
CABLES = ((0, 0, 1, 0), (0, 1, 2, 0), (1, 1, 3, 0), (2, 1, 3, 1), (1, 2, 2, 2))
UP = [(10, 1, 0), (20, 3, 0), (30, 2, 0)]


def played(changes, *harm):
    return Ways(4, 0, CABLES).play(changes, harm)


def test_ways_come_one_by_one():
    assert played(UP).steps == [(0, 3), (10, 2), (20, 1), (30, 0)]
    assert played(UP).roots() == [-1, 1, 2, 1]


def test_a_way_behind_one_that_is_missing_is_none():
    assert played([(5, 3, 0), (10, 1, 0)]).steps == [(0, 3), (10, 1)]


def test_a_cable_takes_all_ways_that_lead_through_it():
    ways = played([*UP, (140, 1, 2), (150, 1, 1)], Harm(100, cables=(0,)))
    assert ways.steps[-3:] == [(30, 0), (100, 2), (140, 0)] or ways.steps[-1][1] == 2
    assert [at for at, _ in ways.steps if at >= 100] == [100, 140, 150]


def test_a_node_that_dies_is_not_counted():
    ways = played([*UP, (120, 3, 1)], Harm(100, nodes=(1,)))
    assert [step for step in ways.steps if step[0] >= 100] == [(100, 1), (120, 0)]


def test_who_is_joined_by_no_cable_is_not_counted():
    ways = played(UP, Harm(100, cables=(2, 3)))
    assert ways.steps[-1] == (30, 0)


def test_loops_are_counted_when_they_close():
    ways = played([(10, 1, 2), (20, 2, 2), (30, 3, 0), (40, 2, 0)])
    assert ways.loops == [20]
    assert [count for _, count in ways.steps] == [3, 0]
    again = played([(10, 1, 1), (20, 3, 1), (30, 2, 2), (40, 3, -1), (50, 3, 1)])
    assert again.loops == [30, 50]


def test_of_one_moment_harm_comes_before_a_change():
    """1 takes 0 again at the very moment at which the cable to it goes: that way is none."""
    ways = played([*UP, (40, 1, -1), (100, 1, 0)], Harm(100, cables=(0,)))
    assert ways.steps[-1] == (40, 2)
    assert ways.roots() == [-1, -1, 2, -1]


def test_who_has_changed_over_does_not_share_the_lot_of_whom_it_left():
    ways = played([*UP, (40, 3, 1), (50, 1, -1)])
    assert ways.steps[-2:] == [(30, 0), (50, 1)]  # 3 goes through 2 by now
    assert ways.roots() == [-1, -1, 2, 2]


def test_changes_back_over_a_dead_cable_lead_nowhere():
    assert played([*UP, (150, 1, 0)], Harm(100, cables=(0,))).steps[-1][1] == 2


STEPS = [(0, 3), (10, 0), (100, 2), (120, 0), (125, 1), (140, 0)]


def test_an_outage_is_over_when_it_stays_so():
    assert settled_us(STEPS, 0, 100, 50) == 10
    assert settled_us(STEPS, 100, 500, 4) == 120
    assert settled_us(STEPS, 100, 500, 50) == 140
    assert settled_us(STEPS, 100, 141, 50) == 140  # nothing more is known
    assert settled_us(STEPS, 100, 130, 50) is None
    assert settled_us(STEPS, 50, 90, 50) == 50
    assert settled_us(STEPS, 100, 500, 5) == 120  # so long exactly
    assert settled_us(STEPS, 100, 500, 6) == 140


def test_what_happens_at_the_end_of_what_is_looked_at_is_no_part_of_it():
    assert most_without(STEPS, 50, 100) == 0
    assert most_without(STEPS, 100, 120) == 2
    assert settled_us(STEPS, 100, 120, 5) is None
    assert time_without_us(STEPS, 100, 120) == 2 * 20


def test_how_many_and_for_how_long():
    assert most_without(STEPS, 50, 90) == 0
    assert most_without(STEPS, 100, 500) == 2
    assert time_without_us(STEPS, 100, 500) == 2 * 20 + 15
    assert time_without_us(STEPS, 5, 110) == 3 * 5 + 2 * 10
