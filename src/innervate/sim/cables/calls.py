"""Calls of nodes' functions: when one is due, and what becomes of all that it asked for.

`do` are the network's functions (see `sim/cables`).
"""

from innervate.dialect.access import SAMPLE
from innervate.dialect.arith import MASK30
from innervate.dialect.outbox import DELIVER, REPORT, SEND, SET_TIMER
from innervate.kernel.bits import mix
from innervate.sim import clocks, rows
from innervate.sim import wheel as queue
from innervate.sim.cables import wires
from innervate.sim.cables.wires import OFFERED
from innervate.sim.cables.world import ALIVE, BROKEN_OUTBOX, BROKEN_PORT, DEAD, OFF, SOURCE
from innervate.sim.status import COLD, ON_FRAME, ON_INPUT, ON_START, ON_TIMER
from innervate.sim.wheel import NIL

NOT_CALLED = -1  # no handler: the node is off, or the frame was lost


def drain(world, do, node, time, now, port):
    """Carry out what a handler put into the outbox; fold it into the fingerprint."""
    run = world.run[0]
    out = world.out
    mark = run.fingerprint
    first_end = 4 * node
    for i in range(out.count[0]):
        act = out.action[i]
        kind, a, b, c = act.kind, act.a, act.b, act.c
        if kind == SEND:
            if run.checks and node < run.cells and (a < 0 or a > 3):
                run.broken, run.broken_node = BROKEN_PORT, node
                break
            frame = out.frame[i]
            mark = mix(mark, do.digest(frame) ^ ((a * 4 + c) << 53) ^ (b << 20))
            if b > 0:
                wires.delay(world, do, first_end + a, frame, time + b, c)
            else:
                wires.transmit(world, do, first_end + a, frame, time, c)
            continue
        mark = mix(mark, kind ^ (a << 3) ^ (b << 20) ^ (c << 50))
        if kind == SET_TIMER:
            slot = clocks.timer_slot(world, node, a)
            if world.wheel.events[slot].bucket != NIL:
                queue.remove(world.wheel, slot)
            queue.insert(world.wheel, slot, clocks.true_time(world, node, time, now, b))
        elif kind == REPORT:
            do.on_report(world, time, node, a, b, c)
        elif kind == DELIVER:
            mark = mix(mark, do.digest(out.frame[i]))
            do.on_deliver(world, time, node, port, out.frame[i])
    out.count[0] = 0
    run.fingerprint = mark
    if out.overflow[0] and run.broken == 0:
        run.broken = BROKEN_OUTBOX
        run.broken_node = node


def finish(world, do, node, time, handler, port):
    """After a handler: account for it, carry out what it asked for, check."""
    run = world.run[0]
    run.handled += 1
    run.fingerprint = mix(run.fingerprint, (time << 26) ^ (node << 6) ^ (port << 40) ^ handler)
    if world.out.count[0] > 0:
        drain(world, do, node, time, clocks.reading(world.clocks[node], time), port)
    if run.watchful:
        look(world, do, node, time, handler, port)


def look(world, do, node, time, handler, port):
    """Checkers, and the trail of all handler calls."""
    run = world.run[0]
    if run.checks:
        do.check(world, node)
        if run.broken and run.broken_at < 0:
            run.broken_at = time
    rows.record_step(world, node, time, handler, port)


def switch_on(world, do, node, time, cause):
    """Start a node, and its source of samples if it has one."""
    run = world.run[0]
    now = clocks.reading(world.clocks[node], time)
    world.alive[node] = ALIVE
    do.on_start(world, node, now & MASK30, cause)
    finish(world, do, node, time, ON_START, cause)
    if run.source_us > 0 and node < run.cells:
        slot = clocks.timer_slot(world, node, SOURCE)
        if world.wheel.events[slot].bucket == NIL:
            wait = clocks.true_delay(world, node, time, world.starts[node].source)
            queue.insert(world.wheel, slot, time + wait)


def on_event(world, do, slot, time):
    """A node's timer, its next sample, or a frame at the end of its cable.

    What follows a handler stands here once for all of them: compiled, it is part of its caller.
    """
    run = world.run[0]
    is_frame = slot >= run.pool_slots
    if is_frame:
        end = world.wheel.events[slot].target
        node = min(end >> 2, run.cells)
        port = end - 4 * node
        handler = on_arrival(world, do, slot, node, port, time)
    else:
        port = clocks.timer_of(world, slot)
        node = slot - port * run.nodes
        handler = on_due(world, do, node, port, time)
        if handler == ON_INPUT:
            port = 0
    if handler != NOT_CALLED:
        finish(world, do, node, time, handler, port)
    if is_frame:
        queue.give(world.wheel, slot)
    elif handler == ON_INPUT:
        wait = clocks.true_delay(world, node, time, run.source_us)
        queue.insert(world.wheel, slot, time + wait)


def on_due(world, do, node, timer, time):
    """A node's timer, its first switching on, or its next sample; what was called of it."""
    if world.alive[node] == OFF:
        switch_on(world, do, node, time, COLD)
        return NOT_CALLED
    if world.alive[node] == DEAD:
        return NOT_CALLED
    now = clocks.reading(world.clocks[node], time) & MASK30
    if timer == SOURCE:
        world.counters[OFFERED] += 1
        do.sense(world, node, time)
        do.on_input(world, node, now, SAMPLE)
        return ON_INPUT
    do.on_timer(world, node, now, timer)
    return ON_TIMER


def on_arrival(world, do, slot, node, port, time):
    """A frame at the end of its cable; what was called of the node there."""
    event = world.wheel.events[slot]
    frame = world.frames[slot - world.run[0].pool_slots]
    if not wires.lands(world, do, event, node, frame, time):
        return NOT_CALLED
    do.on_frame(world, node, time, port, frame)
    world.counters[wires.ARRIVED + event.kind] += 1
    return ON_FRAME
