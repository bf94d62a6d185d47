"""A skin at any moment, put together from rows that are written here.

A line of three: pc.0 - c0 - c1 - c2 - pc.1; end = 4 * cell + port, W 0, E 1; pc.0 is end 12.
"""

from types import SimpleNamespace as Of

import numpy as np
import pytest

from innervate.networks.skin.plot.history import History, together
from innervate.networks.skin.protocol.constants import NONE
from innervate.scenario.actions.cables import CUT, KILL, LOOSE, RESTART, RESTORE, REVIVE
from tests.networks.skin.runs import line, plan_of

GRAPH = plan_of(line(3)).graph
W, E = 0, 1
# c0 and c1 go west, c2 east; later c1 goes east, too.
CHANGES = [(10, 0, W), (11, 1, W), (12, 2, E), (50, 1, E)]


def table(names, rows):
    """Columns of rows, and `row` like the first."""
    columns = zip(*rows, strict=True) if rows else [()] * len(names)
    found = Of(**{name: np.array(column, np.int64)
                  for name, column in zip(names, columns, strict=True)})  # fmt: skip
    found.row = getattr(found, names[0])
    return found


def history(faults=(), changes=CHANGES, steps=(), apart=()):
    """Faults are (at, action, end, node); a row's number is its time."""
    made = History.__new__(History)
    made.graph = GRAPH
    made._faults = {i: Of(action=action, end=end, node=node)
                    for i, (_, action, end, node) in enumerate(faults)}  # fmt: skip
    made._marks = table(("time_us", "event"), [(at, i) for i, (at, *_) in enumerate(faults)])
    made._changes = table(("time_us", "cell", "new"), changes)
    unrouted, made._apart = (table(("time_us", "cells"), some) for some in (steps, apart))
    made._lacking = together(unrouted, made._apart)
    return made


def shown(made, at):
    moment = made.at(at)
    return moment.parent.tolist(), moment.server.tolist(), sorted(moment.down), sorted(moment.dead)


def test_parents_are_those_of_the_last_change_up_to_a_moment():
    made = history()
    assert shown(made, 9) == ([NONE] * 3, [-1] * 3, [], [])
    assert shown(made, 11) == ([W, W, NONE], [0, 0, -1], [], [])
    assert shown(made, 49) == ([W, W, E], [0, 0, 1], [], [])
    assert shown(made, 50) == ([W, E, E], [0, 1, 1], [], [])
    assert made.at(50).hop.tolist() == [3, 2, 3]


def test_over_a_cut_cable_nothing_is_sent():
    made = history([(20, CUT, 12, -1), (30, CUT, 0, -1), (40, RESTORE, 0, -1),
                    (45, RESTORE, 12, -1), (46, RESTORE, 12, -1), (60, CUT, 4, -1)])  # fmt: skip
    assert shown(made, 19)[1:3] == ([0, 0, 1], [])
    assert shown(made, 20) == ([W, W, E], [-1, -1, 1], [0], [])
    assert shown(made, 40)[2] == [0]  # cut twice, put back once
    assert shown(made, 45)[1:3] == ([0, 0, 1], [])
    # Put back once too often is put back; c1 goes east by then, not over the cable to c0.
    assert shown(made, 60) == ([W, E, E], [0, 1, 1], [1], [])


def test_who_is_dead_has_no_cables_and_who_comes_back_knows_nothing():
    made = history([(20, KILL, -1, 1), (25, KILL, -1, 1), (30, REVIVE, -1, 1),
                    (31, REVIVE, -1, 1), (35, RESTART, -1, 0), (70, LOOSE, 0, -1)])  # fmt: skip
    assert shown(made, 19)[1] == [0, 0, 1]
    assert shown(made, 25) == ([W, NONE, E], [0, -1, 1], [1, 5], [1])
    assert shown(made, 34) == ([W, NONE, E], [0, -1, 1], [], [])
    assert shown(made, 35) == ([NONE, NONE, E], [-1, -1, 1], [], [])
    assert shown(made, 70) == ([NONE, E, E], [-1, 1, 1], [], [])  # it has learned since


def test_a_restart_of_the_pc_makes_no_cell_forget():
    made = history([(20, RESTART, -1, GRAPH.sink)])
    assert shown(made, 30)[0] == [W, W, E]


STEPS, APART = [(0, 3), (10, 1), (20, 0), (40, 2)], [(30, 1), (40, 0), (50, 2)]
LACKING = [(0, 3), (10, 1), (20, 0), (30, 1), (40, 2), (50, 4)]


@pytest.fixture
def counted():
    return history(steps=STEPS, apart=APART)


def test_who_lacks_a_way_is_unrouted_or_cut_off(counted):
    times, cells = counted.steps()
    assert list(zip(times.tolist(), cells.tolist(), strict=True)) == LACKING
    for at, many in LACKING:
        assert counted.lacking_at(at) == many
        assert counted.lacking_at(at + 9) == many
    assert (counted.lacking_at(45), counted.cut_off_at(45)) == (2, 0)
    assert (counted.lacking_at(35), counted.cut_off_at(35)) == (1, 1)


@pytest.mark.parametrize(("first", "last", "most"), [
    (0, 50, (50, 4)), (0, 49, (0, 3)), (10, 40, (40, 2)), (10, 30, (10, 1)), (11, 19, (11, 1)),
    (40, 40, (40, 2)),
])  # fmt: skip
def test_when_most_lacked_a_way(counted, first, last, most):
    assert counted.lacking_max(first, last) == most


@pytest.mark.parametrize(("first", "last", "limit", "found"), [
    (0, 50, 1, (10, 1)), (0, 50, 1.5, (10, 1)), (0, 50, 0.5, (20, 0)), (21, 50, 2, (30, 1)),
    (40, 50, 1, (50, 4)), (10, 50, 1, (10, 1)), (0, 20, 0, (20, 0)), (0, 19, 0, (19, 1)),
])  # fmt: skip
def test_when_so_few_lacked_a_way_for_the_first_time(counted, first, last, limit, found):
    assert counted.first_below(first, last, limit) == found
