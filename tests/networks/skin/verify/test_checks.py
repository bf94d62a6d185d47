"""What the explorer says is broken, settled, or may have been forgotten: each on both sides."""

import pytest

from innervate.kernel import records
from innervate.networks.skin.protocol import fields
from innervate.networks.skin.protocol.constants import INFINITY
from innervate.networks.skin.verify import calm, check, moves
from innervate.networks.skin.verify import world as w
from innervate.networks.skin.verify.row import FD_KNOWN, IS_PARENT
from innervate.networks.skin.verify.world import (
    ANY,
    BROKEN_LOOP,
    BROKEN_ORDER,
    BROKEN_RANGE,
    BROKEN_WORSE,
    FINE,
)  # fmt: skip
from tests.networks.skin.verify.tiny import PC, Tiny

EVERY = {"loss": 1, "cut": 1, "heal": 1, "false": 1, "restart": 1}


@pytest.mark.parametrize(
    ("after", "forgot", "known", "rule", "broken"),
    [
        ((1, 40, 5), 0, 1, "feasible", False),
        ((1, 40, 4), 0, 1, "feasible", False),
        ((1, 41, 9), 0, 1, "feasible", False),  # a newer number begins anew
        ((1, 40, 6), 0, 1, "feasible", True),
        ((1, 39, 5), 0, 1, "feasible", True),
        ((1, 39, 1), 0, 1, "feasible", True),
        ((0, 40, 5), 0, 1, "feasible", True),
        ((0, 0, 0), 1, 1, "feasible", False),  # forgotten, and said
        ((1, 39, 9), 1, 1, "feasible", False),
        ((1, 39, 9), 0, 0, "feasible", False),  # there was none
        ((1, 40, 6), 0, 1, "strict", False),  # that rule has none
    ],
)
def test_a_feasible_distance_gets_no_worse_but_by_being_forgotten(
    after, forgot, known, rule, broken
):
    world = Tiny(rule=rule).world
    cell = world.cells[0]
    cell.fd_known, cell.fd_sq, cell.fd_dist = after
    moves.check_feasible(world, known, 40, 5, forgot)
    assert world.found[0] == (BROKEN_WORSE if broken else FINE)


WORDS = [name for name, length, *_ in fields.CELL for _ in range(length or 1)]


@pytest.mark.parametrize("place", range(len(WORDS)), ids=lambda i: f"{WORDS[i]} {i}")
def test_every_word_of_a_cell_has_its_range(place):
    world = Tiny().world
    lows, highs = records.bounds(fields.CELL)
    words, low, high = world.words[0], int(lows[place]), int(highs[place])
    was = words[place]
    for value, broken in ((low - 1, True), (low, False), (high, False), (high + 1, True)):
        world.found[0] = FINE
        words[place] = value
        moves.check_range(world)
        assert world.found[0] == (BROKEN_RANGE if broken else FINE)
    words[place] = was


def chained(rule="feasible", first=(1, 40, 4), second=(1, 40, 5)):
    """Cell 1 goes through cell 0; their feasible distances: (known, number, distance)."""
    tiny = Tiny(rule=rule)
    for c, (known, sq, dist) in enumerate((first, second)):
        tiny.cell(c, FLAGS=known * FD_KNOWN, FD_SQ=sq, FD_DIST=dist)
    tiny.port(1, 0, 5, 40, IS_PARENT)
    return tiny


@pytest.mark.parametrize(
    ("first", "second", "broken"),
    [
        ((1, 40, 4), (1, 40, 5), False),
        ((1, 40, 5), (1, 40, 5), True),
        ((1, 40, 6), (1, 40, 5), True),
        ((1, 41, 9), (1, 40, 5), False),
        ((1, 39, 1), (1, 40, 5), True),
        ((1, 40, 9), (0, 0, 0), False),  # worse than any
        ((0, 0, 0), (1, 40, 5), False),  # the parent forgot, and has no route
    ],
)
def test_a_parent_is_nearer_by_its_feasible_distance(first, second, broken):
    assert check.check(chained(first=first, second=second).world) == (
        BROKEN_ORDER if broken else FINE
    )
    assert check.check(chained("strict", first, second).world) == FINE
    assert check.check(chained(first=first, second=second).cut(0, 1).world) == FINE


def test_a_parent_that_forgot_has_no_route():
    tiny = chained(first=(0, 0, 0))
    tiny.port(0, PC, 0, 40, IS_PARENT)
    assert check.check(tiny.world) == BROKEN_ORDER


def test_a_ring_of_parents_is_a_loop_while_its_cables_are_up():
    def ring(**keys):
        tiny = Tiny(**keys)
        tiny.port(1, 0, 5, 40, IS_PARENT)
        tiny.port(0, 1, 5, 40, IS_PARENT)
        return tiny

    for rule in ("paper", "paper-lax", "strict"):
        assert check.check(ring(rule=rule).world) == BROKEN_LOOP
        assert check.check(ring(rule=rule).cut(0, 1).world) == FINE
    straight = chained("paper")
    straight.port(0, PC, 0, 40, IS_PARENT)
    assert check.check(straight.world) == FINE
    assert check.check(ring().world) == BROKEN_ORDER  # the other finds it first


def test_depths_are_hops_over_live_cables():
    def depths(tiny):
        check.measure_depths(tiny.world)
        return list(tiny.world.depth)

    assert depths(Tiny()) == [1, 2, 0]
    assert depths(Tiny().cut(0, 1)) == [1, INFINITY, 0]
    assert depths(Tiny().cut(0, PC)) == [INFINITY, INFINITY, 0]
    assert depths(Tiny(graph="pc-1 1-2 2-pc")) == [1, 1, 0]
    assert depths(Tiny(graph="pc-1 1-2 2-pc").cut(0, PC)) == [2, 1, 0]


def settled():
    tiny = Tiny()
    tiny.port(0, PC, 0, 40, IS_PARENT)
    tiny.port(0, 1, 2, 40, 2)
    tiny.port(1, 0, 1, 40, IS_PARENT)
    return tiny


@pytest.mark.parametrize(
    ("cell", "other", "said"),
    [
        (1, 0, (1, 40, 0)),  # no parent
        (1, 0, (2, 40, IS_PARENT)),  # it thinks itself deeper, or nearer, than it is
        (1, 0, (0, 40, IS_PARENT)),
        (0, PC, (0, 40, 0)),
        (0, PC, (1, 40, IS_PARENT)),
        (0, 1, (3, 40, 2)),  # a neighbour that is no parent counts, too
        (0, 1, (1, 40, 2)),
        (0, 1, (INFINITY, 0, 0)),
        (0, 1, (2, 40, IS_PARENT)),
    ],
)
def test_a_skin_has_settled_when_all_know_the_shortest_ways(cell, other, said):
    tiny = settled()
    assert check.is_settled(tiny.world)
    if said[2] & IS_PARENT and other == 1:
        tiny.port(0, PC, 0, 40, 0)
    tiny.port(cell, other, *said)
    assert not check.is_settled(tiny.world)


def test_who_is_cut_off_need_not_settle():
    tiny = settled().cut(0, 1)
    tiny.port(1, 0, 7, 7, 0)
    assert check.is_settled(tiny.world)  # nor does what a dead cable said last matter
    lost = settled().cut(0, PC)
    assert check.is_settled(lost.world)  # nobody is connected


@pytest.mark.parametrize(("hold", "may"), [(4, False), (5, True), (8, True)])
def test_who_may_have_had_no_route_for_too_long(hold, may):
    # FD_HOLD is 9 periods; with 3 ticks a time without a route is known to within 3 periods.
    tiny = Tiny(3, keep=True).cell(1, HOLD=hold)
    assert tiny.world.at[w.HELD] == 4
    check.measure_depths(tiny.world)
    assert calm.may_expire(tiny.world, 1) == may
    tiny.port(1, 0, 5, 40, IS_PARENT)
    assert not calm.may_expire(tiny.world, 1)
    tiny.port(1, 0, 5, 40, 0)
    tiny.cut(0, 1)
    check.measure_depths(tiny.world)
    assert not calm.may_expire(tiny.world, 1)


def test_without_budgets_all_go_on_and_nothing_breaks():
    tiny = Tiny(3, 7, EVERY).cell(0, TICKS=0).cell(1, TICKS=ANY)
    calm.forget_budgets(tiny.world)
    assert [tiny.head(c, "TICKS") for c in (0, 1)] == [1, 1]
    assert tiny.row[tiny.lay.pc_at + w.PC_COUNTS] == 1
    assert tiny.budget() == [0] * 6
