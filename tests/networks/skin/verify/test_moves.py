"""What can happen in a small state, in how many ways, and what it leaves behind."""

import pytest

from innervate.networks.skin.protocol.constants import INFINITY, NONE
from innervate.networks.skin.verify import check
from innervate.networks.skin.verify import row as r
from innervate.networks.skin.verify import world as w
from innervate.networks.skin.verify.row import IS_PARENT, IS_SOON, PENALTY
from innervate.networks.skin.verify.world import (
    ANY,
    CUT_LINK,
    DELIVER,
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


def test_the_pcs_period_takes_in_as_many_frames_as_it_is_said_to():
    for variant in range(3):
        tiny = whole(faults={}, counts=2, **PERIODIC).pc(PC_SQ=30, PC_FLAGS=1)
        tiny.queue(0, PC, *TWO)
        assert tiny.ways(PC_TICK) == 3
        tiny.step(PC_TICK, variant=variant)
        assert tiny.queue(0, PC) == TWO[variant:]


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
