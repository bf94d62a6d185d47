"""What is kept of any network in a field, and what it hands down: frames, deliveries, a queue.

Frames are counted once for every node that could hear them, in `world.counters`.
"""

from innervate.dialect.arith import MASK30
from innervate.sim import heard, taps
from innervate.sim import heard as counts
from innervate.sim.field import access, calls, medium
from innervate.sim.field.medium import NONE
from innervate.sim.field.states import ALIVE, ON_AIR
from innervate.sim.status import BROKEN, DONE, POOL_FULL, ROWS_FULL

ON_CARRIER = 4  # in trails
ON_SENT = 5
LOST = {**heard.LOST, "cut": counts.CUT, "busy": counts.BUSY, "queue": counts.FULL}


def pressing(world):
    """Why the loop has to stop before the next event, or DONE; limits leave room for one."""
    run = world.run[0]
    if run.broken:
        return BROKEN
    if run.rows > run.row_limit or run.deliveries > run.delivery_limit:
        return ROWS_FULL
    if run.trail > run.trail_limit or run.taps > run.tap_limit:
        return ROWS_FULL
    if world.heap.size[0] + 64 * run.nodes + 64 > len(world.heap.keys):
        return POOL_FULL
    return DONE


def reach_of(world, node):
    """How many could hear a node."""
    nodes, count = world.run[0].nodes, 0
    for j in range(nodes):
        count += world.prob[node * nodes + j] > 0
    return count


def lose_all(world, node, why):
    """A frame of a node does not get on the air."""
    count = reach_of(world, node)
    world.counters[counts.SENT] += count
    world.counters[why] += count


def record_sent(world, place, time, length, receivers):
    """A frame has left the air: who was off or cut off; or its sender died in the middle of it."""
    air = world.air[place]
    if air.state != ON_AIR:
        return
    if world.run[0].moving:  # robots come and go while it is on the air
        in_reach = reach_of(world, air.node)
        world.counters[counts.SENT] += in_reach - air.receivers
        air.receivers = in_reach
    if time < air.end:
        world.counters[counts.BROKEN_OFF] += air.receivers
        return
    nodes = world.run[0].nodes
    for j in range(nodes):
        at = air.node * nodes + j
        if world.prob[at] > 0 and world.radios[j].state != ALIVE:
            world.counters[counts.OFF] += 1
        elif world.prob[at] > 0 and world.power[at] == 0:
            world.counters[counts.CUT] += 1


def count_frame(world, place, out, why):
    """Count a frame as it goes out, or what became of it at a node."""
    if out:
        air = world.air[place]
        air.receivers = reach_of(world, air.node)
        world.counters[counts.SENT] += air.receivers
    elif why == taps.FINE:
        world.counters[counts.ARRIVED] += 1
    elif why == taps.SENDING:
        world.counters[counts.SENDING] += 1
    elif why == taps.COLLISION:
        world.counters[counts.COLLIDED] += 1
    elif why == taps.CUT:
        world.counters[counts.CUT] += 1
    else:
        world.counters[counts.NOISY] += 1


def put_off(world, do, node, frame, act):
    """A frame has to wait for those before it."""
    run, radio = world.run[0], world.radios[node]
    if radio.waiting >= run.room:
        lose_all(world, node, counts.FULL)
        return
    place = node * run.room + (radio.first + radio.waiting) % run.room
    do.copy_frame(world.ring[place], frame)
    world.acts[place].b = act.b
    radio.waiting += 1


def next_one(world, do, node, time):
    """The node's radio is free: the frame that waited longest."""
    run, radio = world.run[0], world.radios[node]
    if radio.waiting > 0 and radio.held == NONE and radio.state == ALIVE:
        place = node * run.room + radio.first
        radio.first = (radio.first + 1) % run.room
        radio.waiting -= 1
        access.hand_down(world, do, node, world.ring[place], world.acts[place], time)


def tell_sent(world, do, node, time, ok):
    """A node's frame has left the air, or the medium access has given it up."""
    if not ok:
        lose_all(world, node, counts.BUSY)
    do.tell_end(world, do, node, time, ok)
    next_one(world, do, node, time)


def note_report(_world, _node, _time, _code):
    """A report has its row, and no more."""


def sample(_world, _do, _index, _time):
    """Nobody walks, where there are no robots."""


def tell_no_place(_world, _do, _index, _time):
    """A protocol that does not want to know is not told where its robot is."""


def offer(world, do, index, time):
    """Hand a node what its user has for it."""
    given = world.offers[index]
    node = given.node
    if world.radios[node].state == ALIVE:
        do.take_item(world, index)
        calls.give(world, do, node, time, given.kind)


def tell_carrier(world, do, node, time):
    """Tell a node what its radio hears now."""
    radio = world.radios[node]
    cd = 1 if medium.senses(world, node) else 0
    radio.told = cd
    do.on_carrier(world, node, (time + radio.offset) & MASK30, cd, 0)
    calls.finish(world, do, node, time, ON_CARRIER, cd)


def tell_own_end(world, do, node, time, _ok):
    """Tell a node whose frame has left the air what its radio hears now."""
    tell_carrier(world, do, node, time)


def tell_nothing(_world, _do, _node, _time, _ok):
    """A protocol that does not want to know is not told what became of its frames."""


def tell_nobody(_world, _do, _time):
    """... nor are nodes that carriers have come or gone."""


def tell_gone(world, do, node, time, ok):
    """Tell a node that its frame has left the air, or (`ok` 0) was given up."""
    do.on_sent(world, node, (time + world.radios[node].offset) & MASK30, ok)
    calls.finish(world, do, node, time, ON_SENT, ok)


def tell_changes(world, do, time):
    """Tell every node whose carrier has come or gone, and that listens."""
    for node in range(world.run[0].nodes):
        radio = world.radios[node]
        if radio.state == ALIVE and not radio.deaf:
            cd = 1 if medium.senses(world, node) else 0
            if cd != radio.told:
                tell_carrier(world, do, node, time)
