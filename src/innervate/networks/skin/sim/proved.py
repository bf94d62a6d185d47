"""Whether a run keeps to what the proofs assume (docs/prove.md); one that leaves that says so.

What is proved of a skin, for any number of cells, rests on assumptions about time. To leave one
breaks nothing by itself: what follows is covered by the other checkers alone. The first time that
each is left becomes a row. That frames come as they were sent or not at all, and that a cable joins
the same two ends for ever, the medium of cables cannot do otherwise.
"""

from innervate.dialect.arith import HALF16, MASK16, later
from innervate.networks.skin.protocol import constants as const
from innervate.networks.skin.protocol.constants import INFINITY, NONE, ONE, PORTS
from innervate.sim.cables.wires import URGENT_BLOCK
from innervate.sim.cables.world import ALIVE
from innervate.sim.rows import record_row as note
from innervate.sim.status import COLD
from innervate.sim.wheel import FRESH, NIL, NOW

OUTSIDE = 106  # a row's code: a = what was assumed, b = the other node, or NONE

# What is assumed.
RESTART = 0  # who was restarted takes a route when nobody has an old one of it any more
HOLD = 1  # ... and so does who has forgotten its feasible distance
NUMBERS = 2  # numbers in use lie within half of all
FIRST_START = 3  # a cell is switched on for the first time once
PC_STAYS = 4  # rule strict: the PC is not restarted
ORDER = 5  # rule strict: a cable keeps the order of its frames

# Numbers are looked at whenever the PC has counted so far, with as much to spare.
COUNTS = 4096


def is_proved(world):
    """True under a rule of which something is proved."""
    rule = world.params[0].rule
    return rule == const.RULE_FEASIBLE or rule == const.RULE_STRICT


def leave(world, time, node, what, other):
    """Something that is assumed does not hold: a row, the first time."""
    run = world.run[0]
    if (run.outside >> what) & 1 == 0:
        run.outside |= 1 << what
        note(world, time, node, OUTSIDE, what, other)


def on_started(world, time, node, cause):
    """A node is switched on."""
    run = world.run[0]
    if node == run.cells:
        run.counted = NONE
        if cause != COLD and world.params[0].rule == const.RULE_STRICT:
            leave(world, time, node, PC_STAYS, NONE)
        return
    if cause == COLD and world.watch.was_on[node] and is_proved(world):
        leave(world, time, node, FIRST_START, NONE)
    world.watch.was_on[node] = 1


def on_forgotten(world, cell, why):
    """A cell forgets all that it ever announced: until when that may be under way."""
    if not is_proved(world):
        return
    run, watch = world.run[0], world.watch
    watch.forgot[cell] = why
    for p in range(PORTS):
        wire = world.ends[4 * cell + p]
        latency = run.latency_high if run.latency_per_frame else wire.latency
        watch.clear_at[cell] = max(watch.clear_at[cell], wire.busy + latency)


def on_stopped(world, cell):
    """A cell loses its memory."""
    if world.cells[cell].fd_known or world.cells[cell].sq_known:
        on_forgotten(world, cell, RESTART)


def on_routed(world, time, cell):
    """A cell that had forgotten what it announced takes a route again: who keeps an old one?"""
    watch = world.watch
    why = watch.forgot[cell]
    watch.forgot[cell] = NONE
    for p in range(PORTS):
        peer = world.ends[4 * cell + p].peer
        other = peer >> 2
        if peer < 0 or other >= world.run[0].cells or world.alive[other] != ALIVE:
            continue
        if keeps(world, other, peer & 3):
            leave(world, time, cell, why, other)
    if world.wheel.clock[NOW] <= watch.clear_at[cell]:
        other = under_way(world, cell)
        if other != NONE:
            leave(world, time, cell, why, other)


def keeps(world, node, port):
    """True if a cell has the neighbour on a port as parent, or a route of it that it may take."""
    cell = world.cells[node]
    works = cell.pf[port] < ONE or cell.heard[port] == 1
    return cell.parent == port or (cell.dist[port] < INFINITY and works)


def under_way(world, cell):
    """The cell that a route which `cell` announced is on its way to, or NONE."""
    run, wheel = world.run[0], world.wheel
    for slot in range(run.pool_slots, wheel.pool[FRESH]):
        if is_route(world, slot):
            target = wheel.events[slot].target
            if world.ends[target].peer >> 2 == cell and target >> 2 < run.cells:
                return target >> 2
    return NONE


def is_route(world, slot):
    """True if a slot of the pool is a beacon on its way, over a live cable, that says a route."""
    event = world.wheel.events[slot]
    if event.bucket == NIL or event.kind != URGENT_BLOCK:
        return False
    if event.epoch != world.epoch[event.target]:
        return False
    frame = world.frames[slot - world.run[0].pool_slots]
    return frame.kind == const.BEACON and frame.dist < INFINITY


def on_counted(world, time):
    """The PC's period has ended: now and then, and after a restart, look at all numbers in use."""
    run, own = world.run[0], world.pc.own[0]
    if own.sq_known == 0 or not is_proved(world):
        return
    if run.counted != NONE and ((own.sq - run.counted) & MASK16) < COUNTS:
        return
    run.counted = own.sq
    oldest, newest, who = 0, COUNTS, run.cells
    for node in range(run.cells):
        if world.alive[node] == ALIVE:
            low, high = span(world, node, own.sq)
            newest = max(newest, high)
            if low < oldest:
                oldest, who = low, node
    for slot in range(run.pool_slots, world.wheel.pool[FRESH]):
        if is_route(world, slot):
            ahead = ahead_of(world.frames[slot - run.pool_slots].sq, own.sq)
            newest = max(newest, ahead)
            if ahead < oldest:
                oldest, who = ahead, min(world.wheel.events[slot].target >> 2, run.cells)
    if newest - oldest >= HALF16:
        leave(world, time, who, NUMBERS, NONE)


def ahead_of(sq, of):
    """How far a number is ahead of another; negative behind it."""
    return ((sq - of + HALF16) & MASK16) - HALF16


def span(world, node, of):
    """How far the numbers that a cell uses are ahead of another: the least and the greatest."""
    cell = world.cells[node]
    low = high = 0
    if world.params[0].rule == const.RULE_STRICT:
        if cell.sq_known:
            low = high = ahead_of(cell.sq_own, of)
    elif cell.fd_known:
        low = high = ahead_of(cell.fd_sq, of)
    for p in range(PORTS):
        if cell.dist[p] < INFINITY and (cell.pf[p] < ONE or cell.heard[p] == 1):
            ahead = ahead_of(cell.sq[p], of)
            low, high = min(low, ahead), max(high, ahead)
    return low, high


def on_beacon(world, time, node, port, beacon):
    """Rule strict: what a parent says is no older than what was taken from it."""
    cell = world.cells[node]
    if cell.parent == port and beacon.dist < INFINITY and later(cell.sq_own, beacon.sq):
        leave(world, time, node, ORDER, world.ends[4 * node + port].peer >> 2)
