"""What watches routes, by hand: a line of three cells at the PC, each step and its rows."""

from types import SimpleNamespace as Of

import pytest

from innervate.networks.skin.protocol.constants import (
    DROP_AGAIN,
    DROP_LOOP,
    DROP_NO_ROUTE,
    DROP_TOO_FAR,
    NONE,
    REPORT_BALANCE,
    REPORT_BROKEN,
    REPORT_DROP,
    REPORT_PARENT,
    RULE_FEASIBLE,
    RULE_STATIC,
)
from innervate.networks.skin.sim import checks, observer
from innervate.networks.skin.sim.counters import AGAIN, EARLY, LOOPED, NO_ROUTE, TOO_FAR
from innervate.networks.skin.sim.observer import (
    APART,
    BROKEN_FEASIBLE,
    BROKEN_LOOP,
    CUT_OFF,
    JOINED,
    LOOP_CLOSED,
    LOOP_OPEN,
    UNROUTED,
)
from innervate.scenario.actions.cables import CUT, GIVE
from innervate.sim.cables.world import ALIVE, DEAD, OFF

CELLS = 3
W, E = 0, 1
PEERS = {12: 0, 0: 12, 1: 4, 4: 1, 5: 8, 8: 5}  # pc - c0 - c1 - c2


def world_of(ports=(W, W, W), rule=RULE_STATIC, **run):
    """Routes as cells say; all have them that lead to the PC, and are joined with it."""
    names = ("rows", "broken", "loops", "loops_open", "unrouted", "noted", "apart", "next_command",
             "commands", "broken_node", "broken_other")  # fmt: skip
    world = Of(
        run=[Of(**dict.fromkeys(names, 0) | {"cells": CELLS, "observe": 1, "checks": 1, "joined": 3,
                                          "row_limit": 20}
                | run)],
        ends=[Of(peer=PEERS.get(end, -1)) for end in range(13)], epoch=[0] * 13,
        watch=Of(port=list(ports), routed=[1] * 3, had=[1] * 3, joined=[1] * 3, ring=[NONE] * 3,
                 apart=[NONE] * 3, before=[1] * 3, stack=[0] * 3),
        rows=[Of() for _ in range(20)], counters=[0] * 40, alive=[ALIVE] * 4, commands=[],
        params=[Of(rule=rule)], cells=[None] * 3,
    )  # fmt: skip
    return world


def rows(world):
    return [(row.code, row.node, row.a, row.b) for row in world.rows[: world.run[0].rows]]


def cut(world, end):
    for one in (end, PEERS[end]):
        world.epoch[one] = 1


@pytest.mark.parametrize(
    ("reason", "counter"),
    [(DROP_NO_ROUTE, NO_ROUTE), (DROP_LOOP, LOOPED), (DROP_AGAIN, AGAIN), (DROP_TOO_FAR, TOO_FAR)],
)
@pytest.mark.parametrize(("had", "observe"), [(0, 1), (1, 1), (0, 0)])
def test_a_drop_is_counted_by_reason_and_early_before_the_first_route(
    reason, counter, had, observe
):
    world = world_of(observe=observe)
    world.watch.had[1], world.watch.routed[1] = had, 0
    observer.on_report(world, 70, 1, REPORT_DROP, reason, 0)
    early = int(reason == DROP_NO_ROUTE and not had and observe)
    assert {k: n for k, n in enumerate(world.counters) if n} == {counter: 1} | (
        {EARLY: 1} if early else {}
    )
    assert rows(world) == []


@pytest.mark.parametrize(("code", "port", "noted"), [
    (REPORT_BROKEN, E, True), (REPORT_BROKEN, 2, False), (REPORT_PARENT, W, True),
])  # fmt: skip
def test_a_port_without_a_cable_is_not_found_broken(code, port, noted):
    world = world_of()
    observer.on_report(world, 70, 1, code, port, W)
    assert rows(world) == ([(code, 1, port, W)] if noted else [])
    unseen = world_of(observe=0)
    observer.on_report(unseen, 70, 1, code, port, W)
    assert rows(unseen) == []


@pytest.mark.parametrize("code", [REPORT_PARENT, REPORT_BALANCE])
def test_who_loses_its_parent_loses_the_route_with_all_behind_it(code):
    world = world_of()
    observer.on_report(world, 70, 1, code, W, NONE)
    assert (world.watch.routed, world.watch.had) == ([1, 0, 0], [1, 1, 1])
    assert rows(world) == [(code, 1, W, NONE), (UNROUTED, 1, 2, 0)]
    observer.on_report(world, 80, 1, code, NONE, W)
    assert world.watch.routed == [1, 1, 1]
    assert rows(world)[2:] == [(code, 1, NONE, W), (UNROUTED, 1, 0, 0)]
    assert world.rows[3].time == 80


def test_only_those_joined_with_the_pc_lack_a_route():
    world = world_of()
    world.watch.joined[2] = 0
    observer.follow(world, 70, 1, NONE)
    assert world.run[0].unrouted == 1
    world.watch.had = [1, 0, 0]
    observer.follow(world, 80, 1, W)
    assert (world.run[0].unrouted, world.watch.had) == (0, [1, 1, 1])


@pytest.mark.parametrize(("port", "is_cut", "hop"), [
    (W, False, 0), (E, False, 2), (2, False, NONE), (NONE, False, NONE), (W, True, NONE),
])  # fmt: skip
def test_the_next_hop_is_over_a_live_cable(port, is_cut, hop):
    world = world_of((W, port, W))
    if is_cut:
        cut(world, 4)
    assert observer.next_hop(world, 1) == hop
    assert observer.peer_of_parent(world, 1) == (hop if not is_cut else 0)
    assert observer.next_hop(world, 0) == CELLS


@pytest.mark.parametrize(("rule", "checks", "broken"), [
    (RULE_FEASIBLE, 1, BROKEN_LOOP), (RULE_FEASIBLE, 0, 0), (RULE_STATIC, 1, 0),
])  # fmt: skip
def test_a_loop_is_told_by_who_closed_it_and_closed_by_whoever_leaves_it(rule, checks, broken):
    world = world_of(rule=rule, checks=checks)
    observer.follow(world, 70, 1, E)
    run, watch = world.run[0], world.watch
    assert (watch.ring, watch.routed) == ([NONE, 1, 1], [1, 0, 0])
    assert (run.loops, run.loops_open, run.broken) == (1, 1, broken)
    if broken:
        assert (run.broken_node, run.broken_other) == (1, 2)
    observer.follow(world, 80, 2, NONE)
    assert (watch.ring, watch.routed, run.loops, run.loops_open) == ([NONE] * 3, [1, 0, 0], 1, 0)
    assert rows(world) == [(LOOP_OPEN, 1, 2, 0), (LOOP_CLOSED, 1, 0, 0)]  # told by its start


@pytest.mark.parametrize(("next_command", "after", "goes"), [
    (0, (70, CUT), True), (0, (70, GIVE), False), (0, (71, CUT), False), (1, (70, CUT), False),
])  # fmt: skip
def test_what_lasts_no_time_is_not_told(next_command, after, goes):
    world = world_of(next_command=next_command, commands=2)
    world.commands = [Of(at=70, action=CUT), Of(at=after[0], action=after[1])]
    assert observer.goes_on(world, 70) == goes
    cut(world, 4)
    observer.on_links_changed(world, 70, 1, 5)
    told = [row[0] for row in rows(world)]
    assert told == ([CUT_OFF] if goes else [CUT_OFF, APART, JOINED])


def test_a_cut_tells_whose_chain_used_it_and_who_is_apart():
    world = world_of()
    world.watch.before = [0, 1, 1]
    cut(world, 4)
    observer.on_links_changed(world, 70, 1, -1)
    watch, run = world.watch, world.run[0]
    assert (watch.routed, watch.joined, watch.apart) == ([1, 0, 0], [1, 0, 0], [NONE, 70, 70])
    assert rows(world) == [(CUT_OFF, 1, -1, 2), (APART, 1, 2, 2), (JOINED, 1, 1, 0)]
    assert (run.unrouted, run.apart, run.joined) == (0, 2, 1)
    for end in (4, 1):
        world.epoch[end] = 2
    observer.on_links_changed(world, 90, 1, -1)
    assert (watch.routed, watch.apart, run.unrouted) == ([1, 1, 1], [NONE] * 3, 0)
    assert rows(world)[3:] == [(CUT_OFF, 1, -1, 0), (APART, 1, 0, 0), (JOINED, 1, 3, 0)]


def test_who_is_joined_and_has_no_way_is_unrouted_after_a_change():
    world = world_of((W, W, NONE))
    observer.on_links_changed(world, 70, 1, -1)
    assert (world.watch.routed, world.run[0].unrouted) == ([1, 1, 0], 1)
    assert rows(world) == [(CUT_OFF, 1, -1, 1), (UNROUTED, 1, 1, 0)]


def test_a_ring_that_is_cut_is_closed_and_one_that_closes_by_a_cable_is_found():
    world = world_of((W, E, W))
    world.watch.ring, world.watch.routed, world.run[0].loops_open = [NONE, 1, 1], [1, 0, 0], 1
    cut(world, 5)
    observer.on_links_changed(world, 70, 1, -1)
    assert (world.watch.ring, world.run[0].loops_open) == ([NONE] * 3, 0)
    assert rows(world)[0] == (LOOP_CLOSED, 1, 0, 0)
    for end in (5, 8):
        world.epoch[end] = 2
    observer.on_links_changed(world, 80, 1, -1)
    assert (world.watch.ring, world.run[0].loops_open) == ([NONE, 1, 1], 1)


@pytest.mark.parametrize(("state", "apart", "fresh"), [(ALIVE, 2, 1), (OFF, 2, 1), (DEAD, 1, 0)])
def test_those_cut_off_are_counted_since_when_they_are(state, apart, fresh):
    world = world_of()
    world.watch.joined, world.watch.apart = [1, 0, 0], [5, 40, NONE]
    world.alive[2], world.run[0].apart, world.run[0].joined = state, 1, 1
    observer.note_apart(world, 70, 1)
    assert world.watch.apart == [NONE, 40, 70 if fresh else NONE]
    assert rows(world) == ([(APART, 1, apart, fresh)] if fresh else [])


def test_one_that_is_cut_off_as_another_dies_is_told_though_there_are_as_many():
    world = world_of()
    world.watch.joined, world.watch.apart = [1, 0, 0], [NONE, 40, NONE]
    world.alive[1], world.run[0].apart, world.run[0].joined = DEAD, 1, 1
    observer.note_apart(world, 70, 1)
    assert rows(world) == [(APART, 1, 1, 1)]


def test_before_a_command_routes_are_remembered():
    world = world_of()
    world.watch.routed = [1, 0, 1]
    observer.remember(world)
    assert world.watch.before == [1, 0, 1]
    assert world.watch.before is not world.watch.routed


def cell(sq, dist):
    return Of(fd_known=1, fd_sq=sq, fd_dist=dist)


@pytest.mark.parametrize(("mine", "parents", "rule", "port", "broken"), [
    ((9, 3), (9, 2), RULE_FEASIBLE, W, 0), ((9, 2), (9, 2), RULE_FEASIBLE, W, BROKEN_FEASIBLE),
    ((9, 1), (9, 2), RULE_FEASIBLE, W, BROKEN_FEASIBLE), ((9, 2), (9, 2), RULE_STATIC, W, 0),
    ((9, 2), (9, 2), RULE_FEASIBLE, NONE, 0), ((8, 9), (9, 2), RULE_FEASIBLE, W, 0),
])  # fmt: skip
def test_a_route_is_strictly_worse_than_the_parents(mine, parents, rule, port, broken):
    world = world_of((W, port, W), rule)
    world.cells[1], world.cells[0] = cell(*mine), cell(*parents)
    checks.check_route(world, 1)
    run = world.run[0]
    assert (run.broken, run.broken_node, run.broken_other) == (
        (broken, 1, 0) if broken else (0, 0, 0)
    )
    run.broken = 4
    checks.check_route(world, 0)  # whose parent is the PC; and the first is told
    assert run.broken == 4


def test_a_way_into_a_loop_of_others_is_no_loop_of_its_own():
    world = world_of((W, E, W))
    world.watch.ring, world.watch.routed = [NONE, 1, 1], [1, 0, 0]
    assert not observer.closes(world, 1, 0)
    observer.follow(world, 70, 0, E)
    assert (world.watch.ring, world.watch.routed, rows(world)) == ([NONE, 1, 1], [0, 0, 0], [])
