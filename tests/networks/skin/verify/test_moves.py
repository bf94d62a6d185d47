"""What can happen in a small state, and what the explorer says is broken: each on both sides."""

import pytest

from innervate.kernel import records
from innervate.networks.skin.protocol import fields
from innervate.networks.skin.protocol.constants import INFINITY, NONE
from innervate.networks.skin.verify import calm, check, moves
from innervate.networks.skin.verify import row as r
from innervate.networks.skin.verify import world as w
from innervate.networks.skin.verify.row import FD_KNOWN, IS_PARENT, IS_SOON, PENALTY
from innervate.networks.skin.verify.world import (
    ANY,
    BROKEN_LOOP,
    BROKEN_ORDER,
    BROKEN_RANGE,
    BROKEN_WORSE,
    CUT_LINK,
    DELIVER,
    FINE,
    HEAL_LINK,
    LOSE,
    PC_TICK,
    RESTART_PC,
    SOON,
    TICK,
)  # fmt: skip
from tests.networks.skin.verify.tiny import PC, Tiny

GOOD = (5, 40, 0)
PERIODIC = {"updates": "periodic"}
EVERY = {"loss": 1, "cut": 1, "heal": 1, "false": 1, "restart": 1}


# Checkers.


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


# What can happen.


def heard(said=GOOD, frames=(), ticks=3, faults=(), **keys):
    """Cell 1 has heard something of cell 0, and more is on its way."""
    tiny = Tiny(ticks, faults=faults, **keys)
    tiny.port(1, 0, *said)
    if frames:
        tiny.queue(0, 1, *frames)
    return tiny


FALSE = {"false": 1}
SILENT = (INFINITY, 0, 0)
TWO = [(3, 41, 0), (4, 42, 0)]


@pytest.mark.parametrize(
    ("given", "is_cut", "ways"),
    [
        (dict(), False, 1),
        (dict(ticks=0), False, 0),
        (dict(ticks=ANY), False, 1),
        (dict(faults=FALSE), False, 2),  # the port may be found broken
        (dict(), True, 2),
        (dict(said=(5, 40, PENALTY), faults=FALSE), False, 1),  # it is so already
        (dict(said=(5, 40, PENALTY)), True, 1),
        (dict(said=SILENT), True, 2),
        (dict(said=SILENT, **PERIODIC), True, 1),  # nobody could tell
        (dict(said=SILENT, keep=True, **PERIODIC), True, 2),
        (dict(frames=TWO), False, 1),  # they arrive by themselves
        (dict(frames=TWO, **PERIODIC), False, 3),  # or with the tick: none, one, both
        (dict(frames=TWO, faults=FALSE, **PERIODIC), False, 4),
    ],
)
def test_in_how_many_ways_a_cell_can_tick(given, is_cut, ways):
    tiny = heard(**given)
    if is_cut:
        tiny.cut(0, 1)
    assert tiny.ways(TICK, 1) == ways


def test_each_port_of_a_cell_comes_into_its_tick_in_its_own_way():
    tiny = Tiny(faults=FALSE, **PERIODIC)
    tiny.port(0, PC, *GOOD)
    tiny.port(0, 1, *GOOD)
    tiny.queue(1, 0, *TWO)
    assert tiny.ways(TICK, 0) == 2 * 4


@pytest.mark.parametrize(
    ("counts", "listen", "keys", "ways"),
    [(0, 0, {}, 0), (1, 0, {}, 1), (0, 1, {}, 1), (1, 0, PERIODIC, 3), (0, 0, PERIODIC, 0)],
)
def test_in_how_many_ways_the_pc_can_tick(counts, listen, keys, ways):
    tiny = Tiny(counts=counts, **keys).pc(PC_LISTEN=listen)
    tiny.queue(0, PC, (0, 40, 1), (0, 41, 1))
    assert tiny.ways(PC_TICK) == ways


def test_news_are_sent_while_their_timer_runs():
    assert Tiny().ways(SOON, 1) == 0
    assert Tiny().cell(1, FLAGS=IS_SOON).ways(SOON, 1) == 1
    assert Tiny().cell(0, FLAGS=IS_SOON).ways(SOON, 1) == 0


def test_faults_happen_within_their_budgets_where_they_can():
    tiny = Tiny(faults=EVERY)
    way, link = tiny.way(0, 1), tiny.way(0, 1) // 2
    other = tiny.way(1, 0)
    assert (tiny.ways(DELIVER, way), tiny.ways(LOSE, way)) == (0, 0)
    tiny.queue(0, 1, *TWO)
    assert (tiny.ways(DELIVER, way), tiny.ways(LOSE, way)) == (1, 1)
    assert (tiny.ways(DELIVER, other), tiny.ways(LOSE, other)) == (0, 0)
    assert (tiny.ways(CUT_LINK, link), tiny.ways(HEAL_LINK, link)) == (1, 0)
    tiny.cut(0, 1)
    assert (tiny.ways(CUT_LINK, link), tiny.ways(HEAL_LINK, link)) == (0, 1)
    assert tiny.ways(CUT_LINK, 1 - link) == 1
    assert tiny.ways(RESTART_PC) == 1
    tiny.pc(PC_COUNTS=0)
    assert tiny.ways(RESTART_PC) == 0
    for place in (*range(5), 5):  # each by itself, and the sum of all
        spent = Tiny(faults=EVERY)
        spent.queue(0, 1, *TWO)
        spent.row[spent.lay.budget_at + place] = 0
        able = [spent.ways(LOSE, way), spent.ways(CUT_LINK, link), 1, 1, spent.ways(RESTART_PC)]
        for k in (0, 1, 4):
            assert able[k] == (place not in (k, 5))
        spent.cut(0, 1)
        assert spent.ways(HEAL_LINK, link) == (place not in (2, 5))
    assert Tiny(counts=0, faults=EVERY, keep=True).ways(RESTART_PC) == 1


def test_promptly_the_first_frame_under_way_comes_before_all_else():
    tiny = Tiny(faults=EVERY, prompt=True).cell(0, FLAGS=IS_SOON)
    ways = sorted((tiny.way(0, 1), tiny.way(1, 0)))
    assert tiny.ways(TICK, 0) == 4  # either port may be found broken
    for sender in (0, 1):
        tiny.queue(sender, 1 - sender, (3, 41, 0))
    assert [tiny.ways(DELIVER, way) for way in ways] == [1, 0]
    assert [tiny.ways(LOSE, way) for way in ways] == [1, 0]
    assert tiny.ways(TICK, 0) == tiny.ways(PC_TICK) == tiny.ways(SOON, 0) == 0
    assert tiny.ways(CUT_LINK, 0) == tiny.ways(RESTART_PC) == 0


# What happens.


def whole(ticks=3, faults=EVERY, **keys):
    return Tiny(ticks, faults=faults, lean=False, **keys)


def test_a_cable_that_is_cut_takes_what_is_on_it_along():
    tiny = whole()
    tiny.queue(0, 1, *TWO)
    tiny.queue(1, 0, *TWO)
    tiny.queue(0, PC, (0, 41, 1))
    link = tiny.way(0, 1) // 2
    tiny.step(CUT_LINK, link)
    assert tiny.queue(0, 1) == tiny.queue(1, 0) == []
    assert tiny.queue(0, PC) == [(0, 41, 1)]
    assert tiny.budget() == [1, 0, 1, 1, 1, 1]
    tiny.step(HEAL_LINK, link)
    assert tiny.row[tiny.lay.link_at + link] == 0
    assert tiny.budget() == [0] * 6  # two faults were all


def test_a_frame_that_is_lost_is_the_oldest():
    tiny = whole()
    tiny.queue(0, 1, *TWO)
    tiny.step(LOSE, tiny.way(0, 1))
    assert (tiny.queue(0, 1), tiny.budget()) == (TWO[1:], [0, 1, 1, 1, 1, 1])


def test_a_frame_that_arrives_is_the_oldest_and_is_heard_at_its_port():
    tiny = whole()
    tiny.queue(0, 1, *TWO)
    tiny.step(DELIVER, tiny.way(0, 1))
    assert (tiny.queue(0, 1), tiny.port(1, 0)[:2]) == (TWO[1:], TWO[0][:2])


def test_a_pc_that_restarts_forgets_and_listens():
    tiny = whole().pc(PC_SQ=30, PC_FLAGS=1, PC_LISTEN=0)
    tiny.step(RESTART_PC)
    at = tiny.lay.pc_at
    assert (tiny.row[at + w.PC_FLAGS], tiny.row[at + w.PC_LISTEN] > 0) == (0, True)
    assert tiny.budget() == [1, 1, 1, 1, 0, 1]


@pytest.mark.parametrize(("ticks", "left"), [(3, 2), (1, 0), (ANY, ANY)])
def test_a_tick_is_one_less(ticks, left):
    assert whole(ticks).step(TICK, 1).head(1, "TICKS") == left
    assert whole(ticks).step(TICK, 1).head(0, "TICKS") == ticks


def test_a_port_that_works_is_found_broken_at_the_price_of_a_fault():
    for is_cut, budget in ((False, [1, 1, 1, 0, 1, 1]), (True, [1, 1, 1, 1, 1, 2])):
        tiny = whole()
        tiny.port(1, 0, *GOOD)
        if is_cut:
            tiny.cut(0, 1)
        assert tiny.ways(TICK, 1) == 2
        tiny.step(TICK, 1, variant=1)
        assert tiny.port(1, 0)[2] & 3 * PENALTY
        assert tiny.budget() == budget
        fine = whole()
        fine.port(1, 0, *GOOD)
        fine.step(TICK, 1, variant=0)
        assert not fine.port(1, 0)[2] & 3 * PENALTY


def test_a_tick_takes_in_as_many_frames_as_it_is_said_to():
    for variant in range(3):
        tiny = whole(faults={}, **PERIODIC)
        tiny.port(1, 0, *GOOD)
        tiny.queue(0, 1, *TWO)
        tiny.step(TICK, 1, variant=variant)
        assert tiny.queue(0, 1) == TWO[variant:]
        assert tiny.port(1, 0)[:2] == [GOOD, *TWO][variant][:2]


def test_a_ticks_beacons_go_out_over_cables_that_are_up():
    for is_cut in (False, True):
        tiny = whole()
        tiny.port(0, PC, 0, 40, IS_PARENT)
        tiny.cell(0, FLAGS=r.SQ_KNOWN, SQ_OWN=40)
        if is_cut:
            tiny.cut(0, 1)
        tiny.step(TICK, 0)
        sent = tiny.queue(0, 1)
        assert [frame[:2] for frame in sent] == ([] if is_cut else [(1, 40)])


def test_the_pc_sends_a_number_for_every_count():
    tiny = whole(counts=2).pc(PC_SQ=30, PC_FLAGS=1)
    tiny.step(PC_TICK)
    assert tiny.row[tiny.lay.pc_at + w.PC_COUNTS] == 1
    assert [frame[:2] for frame in tiny.queue(PC, 0)] == [(0, 31)]
    listening = whole(counts=2).pc(PC_LISTEN=1).step(PC_TICK)
    assert listening.row[listening.lay.pc_at + w.PC_COUNTS] == 2


def test_who_has_no_parent_has_no_next_hop():
    tiny = Tiny()
    assert check.next_hop(tiny.world, 1) == NONE
    tiny.port(1, 0, 5, 40, IS_PARENT)
    tiny.port(0, PC, 0, 40, IS_PARENT)
    assert (check.next_hop(tiny.world, 1), check.next_hop(tiny.world, 0)) == (0, PC)
    assert check.next_hop(tiny.cut(0, 1).world, 1) == NONE
