"""What the proofs assume, looked at in worlds made by hand: each condition on both of its sides."""

from types import SimpleNamespace as Of

import pytest

from innervate.dialect.arith import HALF16, MASK16
from innervate.networks.skin.protocol.constants import (
    BEACON,
    DATA,
    INFINITY,
    NONE,
    ONE,
    RULE_FEASIBLE,
    RULE_PAPER,
    RULE_STRICT,
)  # fmt: skip
from innervate.networks.skin.sim import proved
from innervate.sim.cables.wires import URGENT_BLOCK
from innervate.sim.cables.world import ALIVE, DEAD
from innervate.sim.status import COLD, MEMORY_LOST

CELLS, POOL = 3, 2
# Ports: pc.0 - n0.0, n0.1 - n1.0, n1.1 - n2.0; ends are 4 * cell + port, those of the PC from 12.
PEERS = {0: 12, 12: 0, 1: 4, 4: 1, 5: 8, 8: 5}
START = 40_000


def cell():
    return Of(parent=NONE, fd_known=1, fd_sq=START, sq_known=1, sq_own=START, pf=[ONE] * 4,
              heard=[0] * 4, dist=[INFINITY] * 4, sq=[START] * 4)  # fmt: skip


def world_of(rule=RULE_FEASIBLE, **run):
    own = {"cells": CELLS, "pool_slots": POOL, "rows": 0, "row_limit": 9, "outside": 0,
           "counted": NONE, "latency_per_frame": 0, "latency_high": 900}  # fmt: skip
    made = Of(
        params=[Of(rule=rule)], run=[Of(**own | run)], rows=[Of() for _ in range(9)],
        cells=[cell() for _ in range(CELLS)], alive=[ALIVE] * (CELLS + 1),
        ends=[Of(peer=PEERS.get(end, NONE), busy=500, latency=80) for end in range(16)],
        epoch=[0] * 16, pc=Of(own=[Of(sq_known=1, sq=START)]),
        watch=Of(was_on=[0] * CELLS, forgot=[NONE] * CELLS, clear_at=[0] * CELLS),
        wheel=Of(clock=[1000] * 4, pool=[POOL + 2] * 4,
                 events=[Of(bucket=proved.NIL, kind=URGENT_BLOCK, target=5, epoch=0)
                         for _ in range(POOL + 2)]),
        frames=[Of(kind=BEACON, dist=2, sq=START) for _ in range(2)],
    )  # fmt: skip
    return made


def said(world):
    """The assumptions that were left, each with who and the other, in order."""
    return [(row.a, row.node, row.b) for row in world.rows[: world.run[0].rows]]


def test_each_assumption_is_told_the_first_time():
    world = world_of()
    for what in (proved.HOLD, proved.NUMBERS, proved.HOLD, proved.RESTART):
        proved.leave(world, 7, 1, what, 2)
    assert said(world) == [(proved.HOLD, 1, 2), (proved.NUMBERS, 1, 2), (proved.RESTART, 1, 2)]
    assert world.run[0].outside == 0b111
    assert {(row.time, row.code) for row in world.rows[:3]} == {(7, proved.OUTSIDE)}


@pytest.mark.parametrize("rule", [RULE_FEASIBLE, RULE_STRICT, RULE_PAPER])
@pytest.mark.parametrize("cause", [COLD, MEMORY_LOST])
def test_the_pc_stays_and_a_cell_starts_once(rule, cause):
    world = world_of(rule, counted=9)
    proved.on_started(world, 1, CELLS, cause)
    is_left = rule == RULE_STRICT and cause != COLD
    assert said(world) == [(proved.PC_STAYS, CELLS, NONE)] * is_left
    assert world.run[0].counted == NONE

    world = world_of(rule)
    proved.on_started(world, 1, 2, cause)
    assert said(world) == []
    proved.on_started(world, 1, 2, cause)
    is_left = cause == COLD and rule != RULE_PAPER
    assert said(world) == [(proved.FIRST_START, 2, NONE)] * is_left


def test_what_was_announced_may_be_under_way_until_the_slowest_port_is_done():
    world = world_of()
    world.ends[5].busy, world.ends[4].latency = 700, 300
    proved.on_forgotten(world, 1, proved.HOLD)
    assert (world.watch.clear_at[1], world.watch.forgot[1]) == (800, proved.HOLD)
    world.run[0].latency_per_frame = 1
    proved.on_forgotten(world, 1, proved.RESTART)
    assert (world.watch.clear_at[1], world.watch.forgot[1]) == (1600, proved.RESTART)
    world.run[0].latency_per_frame = 0  # nothing makes it earlier
    proved.on_forgotten(world, 1, proved.HOLD)
    assert world.watch.clear_at[1] == 1600
    unproved = world_of(RULE_PAPER)
    proved.on_forgotten(unproved, 1, proved.HOLD)
    assert unproved.watch.forgot[1] == NONE


@pytest.mark.parametrize(("fd", "sq", "knew"), [(0, 0, False), (1, 0, True), (0, 1, True)])
def test_who_stops_forgets_what_it_announced_if_it_did(fd, sq, knew):
    world = world_of()
    world.cells[1].fd_known, world.cells[1].sq_known = fd, sq
    proved.on_stopped(world, 1)
    assert world.watch.forgot[1] == (proved.RESTART if knew else NONE)


KEEPS = [
    ({}, False),
    ({"parent": 1}, True),  # n0 has n1 at port 1
    ({"parent": 0}, False),
    ({"dist": 3}, False),
    ({"dist": 3, "pf": ONE - 1}, True),
    ({"dist": 3, "heard": 1}, True),
    ({"dist": 3, "heard": 2}, False),
    ({"heard": 1}, False),
]


def settle(node, port=1, **fields):
    for name, value in fields.items():
        if name == "parent":
            node.parent = value
        else:
            getattr(node, name)[port] = value


@pytest.mark.parametrize(("fields", "keeps"), KEEPS)
def test_a_neighbour_with_an_old_route_is_seen(fields, keeps):
    world = world_of()
    world.watch.forgot[1] = proved.HOLD
    settle(world.cells[0], **fields)
    proved.on_routed(world, 1, 1)
    assert said(world) == [(proved.HOLD, 1, 0)] * keeps
    assert world.watch.forgot[1] == NONE


def test_who_is_off_keeps_no_route():
    world = world_of()
    world.watch.forgot[1] = proved.HOLD
    settle(world.cells[0], parent=1)
    world.alive[0] = DEAD
    proved.on_routed(world, 1, 1)
    assert said(world) == []


FLYING = [
    ({}, True),
    ({"bucket": proved.NIL}, False),
    ({"kind": URGENT_BLOCK + 1}, False),
    ({"epoch": 2}, False),
    ({"target": 8}, True),
    ({"target": 4}, False),  # from n0 to n1, which forgot
    ({"target": 1}, True),
    ({"frame": DATA}, False),
    ({"dist": INFINITY}, False),
    ({"late": 1}, False),
]


@pytest.mark.parametrize(("change", "seen"), FLYING)
def test_an_old_route_on_its_way_is_seen(change, seen):
    """The newest slot of the pool has a beacon of n1, which has forgotten, to a neighbour."""
    world = world_of()
    world.watch.forgot[1], world.watch.clear_at[1] = proved.RESTART, 1000
    event, frame = world.wheel.events[-1], world.frames[-1]
    event.bucket, event.target, event.epoch = 0, 8, 0
    world.epoch[8] = world.epoch[1] = 0
    for name in event.__dict__.keys() & change.keys():
        setattr(event, name, change[name])
    frame.kind, frame.dist = change.get("frame", BEACON), change.get("dist", 2)
    world.wheel.clock[proved.NOW] += change.get("late", 0)
    proved.on_routed(world, 1, 1)
    assert said(world) == [(proved.RESTART, 1, event.target >> 2)] * seen


def test_a_beacon_on_its_way_to_the_pc_is_no_route_of_a_cell():
    world = world_of()
    world.watch.clear_at[0] = 2000
    world.wheel.events[-1].bucket, world.wheel.events[-1].target = 0, 12
    assert proved.under_way(world, 0) == NONE


def spans(low, high, rule=RULE_FEASIBLE, where="cell", **more):
    """What is said if numbers reach so far behind the PC's, and so far ahead."""
    world = world_of(rule)
    for node in world.cells:
        node.sq_own = node.fd_sq = START
    if where == "cell":
        world.cells[1].fd_sq = (START + low) & MASK16
        world.cells[1].sq_own = (START + low) & MASK16
        settle(world.cells[2], 0, dist=1, heard=1, sq=(START + high) & MASK16)
    elif where == "ports":
        settle(world.cells[1], 0, dist=1, pf=0, sq=(START + low) & MASK16)
        settle(world.cells[1], 1, dist=1, heard=1, sq=(START + high) & MASK16)
    else:
        for event, frame, by in zip(world.wheel.events[POOL:], world.frames, (low, high),
                                    strict=True):  # fmt: skip
            event.bucket, event.target, frame.sq = 0, 5, (START + by) & MASK16
    for name, value in more.items():
        setattr(world.cells[1], name, value)
    proved.on_counted(world, 3)
    return said(world)


@pytest.mark.parametrize("where", ["cell", "ports", "air"])
def test_numbers_in_use_lie_within_half_of_all(where):
    far = HALF16 - 6000
    assert spans(-far, 5999, where=where) == []
    assert spans(-far, 6000, where=where) == [(proved.NUMBERS, 1, NONE)]
    # What the PC may still count before they are looked at again is in use as well.
    assert spans(proved.COUNTS - HALF16 + 1, 0, where=where) == []
    assert spans(proved.COUNTS - HALF16, 0, where=where) == [(proved.NUMBERS, 1, NONE)]


def test_whose_numbers_count():
    far = proved.COUNTS - HALF16
    assert spans(far, 0, RULE_STRICT) == [(proved.NUMBERS, 1, NONE)]
    assert spans(far, 0, RULE_STRICT, sq_known=0) == []
    assert spans(far, 0, RULE_STRICT, fd_known=0) == [(proved.NUMBERS, 1, NONE)]
    assert spans(far, 0, fd_known=0) == []
    assert spans(far, 0, sq_known=0) == [(proved.NUMBERS, 1, NONE)]
    assert spans(far, 0, RULE_PAPER) == []
    assert spans(far, 0, where="ports", dist=[INFINITY] * 4) == []
    assert spans(far, 0, where="ports", pf=[ONE] * 4) == []


def test_numbers_are_looked_at_now_and_then():
    world = world_of()
    world.cells[1].fd_sq = (START + proved.COUNTS - HALF16) & MASK16
    for sq_known, ago, looked in ((0, proved.COUNTS, False), (1, proved.COUNTS - 1, False),
                                  (1, proved.COUNTS, True)):  # fmt: skip
        world.pc.own[0].sq_known = sq_known
        world.run[0].counted = START - ago
        proved.on_counted(world, 3)
        assert bool(said(world)) == looked
        assert world.run[0].counted == (START if looked else START - ago)


def test_who_is_off_uses_no_numbers():
    world = world_of()
    world.cells[1].fd_sq = (START + proved.COUNTS - HALF16) & MASK16
    world.alive[1] = DEAD
    proved.on_counted(world, 3)
    assert said(world) == []


@pytest.mark.parametrize(
    ("change", "left"),
    [({}, True), ({"parent": 1}, False), ({"dist": INFINITY}, False), ({"sq": START}, False)],
)
def test_a_parent_that_says_what_is_older_has_been_overtaken(change, left):
    world = world_of(RULE_STRICT)
    world.cells[2].parent = change.get("parent", 0)
    beacon = Of(dist=change.get("dist", 1), sq=change.get("sq", START - 1))
    proved.on_beacon(world, 3, 2, 0, beacon)
    assert said(world) == [(proved.ORDER, 2, 1)] * left
