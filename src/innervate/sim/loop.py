"""The simulation loop: one function, compiled on arrays or plain on lists.

It takes events off the wheel, lets the node's protocol handle them, drains the outbox, and stops
when the time, the commands or the room in a table is used up; `run.status` says which.
"""

from collections.abc import Callable
from typing import NamedTuple

from innervate.kernel.bits import mix
from innervate.kernel.tables import fetch
from innervate.protocol.arith import MASK30
from innervate.protocol.outbox import DELIVER, REPORT, SEND, SET_TIMER
from innervate.sim import clocks, commands, orders, rows, touch, wires
from innervate.sim import wheel as queue
from innervate.sim.observer import BROKEN_OUTBOX
from innervate.sim.wheel import FRESH, LAST, NIL
from innervate.sim.wires import OFFERED
from innervate.sim.world import ALIVE, DEAD, OFF, SOURCE

# Why the loop stopped.
DONE = 0
POOL_FULL = 1
ROWS_FULL = 2
BROKEN = 3
BUDGET = 4

ON_START = 0
ON_FRAME = 1
ON_TIMER = 2
ON_INPUT = 3

COLD = 0
MEMORY_LOST = 1


# Events between two looks at the room left in the tables.
BATCH = 64
FORESEE_CELLS = 2000  # fewer fit into the processor's caches anyway
FORESEE_EVENTS = 4
ROWS_PER_EVENT = 24


class Handlers(NamedTuple):
    """A loop's parts, bound to a stack; `advance` is the loop itself."""

    drain: Callable[..., None]
    look: Callable[..., None]
    finish: Callable[..., None]
    switch_on: Callable[..., None]
    on_timer_slot: Callable[..., None]
    on_arrival: Callable[..., None]
    dispatch: Callable[..., None]
    give_order: Callable[..., None]
    report: Callable[..., None]
    advance: Callable[..., None]


def pressing(world):
    """Why the loop has to stop before the next batch, or DONE."""
    run = world.run[0]
    pool = world.wheel.pool
    if run.broken:
        return BROKEN
    if pool[FRESH] + BATCH * 16 + 2 * world.out.limit[0] > run.pool_slots + pool[LAST]:
        return POOL_FULL
    if run.rows + BATCH * ROWS_PER_EVENT > run.row_limit:
        return ROWS_FULL
    if run.deliveries + BATCH > run.delivery_limit > 0 or run.trail + BATCH > run.trail_limit > 0:
        return ROWS_FULL
    if run.taps > run.tap_limit:  # beyond the limit there is room for a batch
        return ROWS_FULL
    return DONE


def foresee(world, wheel):
    """Have what an event a little later needs fetched from memory while others are handled."""
    slot = wheel.clock[queue.PENDING]
    for _ in range(FORESEE_EVENTS):
        if slot == NIL:
            break
        slot = wheel.links[queue.BUCKETS + slot]
    if slot == NIL:
        index = queue.first(wheel, 0, wheel.clock[queue.NOW] & queue.MASK)
        if index == NIL:
            return
        slot = wheel.links[index]
    run = world.run[0]
    if slot >= run.pool_slots:
        end = wheel.events[slot].target
        node = min(end >> 2, run.cells - 1)
        fetch(world.epoch, end, 0)
    else:
        node = min(slot - clocks.timer_of(world, slot) * run.nodes, run.cells - 1)
        fetch(world.ends, 4 * node, 0)
        fetch(world.ends, 4 * node, 1)
        fetch(world.cells, node, 3)
        fetch(world.starts, node, 0)
    fetch(world.cells, node, 0)
    fetch(world.cells, node, 1)
    fetch(world.cells, node, 2)
    fetch(world.clocks, node, 0)
    fetch(world.alive, node, 0)


def build(stack):
    """The loop for a stack: an object with start, hear, fire, sample, give, digest, report,
    stopped, check, deliver and copy_frame (see skin_stack.py).
    """
    start, hear, fire = stack.start, stack.hear, stack.fire
    sample, give = stack.sample, stack.give
    digest, report, stopped = stack.digest, stack.report, stack.stopped
    check, deliver, copy_frame = stack.check, stack.deliver, stack.copy_frame

    def drain(world, node, time, now, port):
        """Carry out what a handler put into the outbox; fold it into the fingerprint."""
        run = world.run[0]
        out = world.out
        mark = run.fingerprint
        first_end = 4 * node
        for i in range(out.count[0]):
            act = out.action[i]
            kind, a, b, c = act.kind, act.a, act.b, act.c
            if kind == SEND:
                frame = out.frame[i]
                mark = mix(mark, digest(frame) ^ ((a * 4 + c) << 53) ^ (b << 20))
                if b > 0:
                    wires.delay(world, first_end + a, frame, time + b, c, copy_frame)
                else:
                    wires.transmit(world, first_end + a, frame, time, c, copy_frame)
                continue
            mark = mix(mark, kind ^ (a << 3) ^ (b << 20) ^ (c << 50))
            if kind == SET_TIMER:
                slot = clocks.timer_slot(world, node, a)
                if world.wheel.events[slot].bucket != NIL:
                    queue.remove(world.wheel, slot)
                queue.insert(world.wheel, slot, clocks.true_time(world, node, time, now, b))
            elif kind == REPORT:
                report(world, time, node, a, b, c)
            elif kind == DELIVER:
                mark = mix(mark, digest(out.frame[i]))
                deliver(world, time, node, port, out.frame[i])
        out.count[0] = 0
        run.fingerprint = mark
        if out.overflow[0] and run.broken == 0:
            run.broken = BROKEN_OUTBOX
            run.broken_node = node

    def finish(world, node, time, handler, port):
        """After a handler: account for it, carry out what it asked for, check."""
        run = world.run[0]
        run.handled += 1
        run.fingerprint = mix(run.fingerprint, (time << 26) ^ (node << 6) ^ (port << 40) ^ handler)
        if world.out.count[0] > 0:
            drain(world, node, time, clocks.reading(world.clocks[node], time), port)
        if run.watchful:
            look(world, node, time, handler, port)

    def look(world, node, time, handler, port):
        """Checkers, and the trail of all handler calls."""
        run = world.run[0]
        if run.checks:
            check(world, node)
            if run.broken and run.broken_at < 0:
                run.broken_at = time
        rows.keep_step(world, node, time, handler, port)

    def switch_on(world, node, time, cause):
        """Start a node, and its source of samples if it has one."""
        run = world.run[0]
        clock = world.clocks[node]
        now = clocks.reading(clock, time)
        world.alive[node] = ALIVE
        start(world, node, now & MASK30, cause)
        finish(world, node, time, ON_START, cause)
        if run.source_us > 0 and node < run.cells:
            slot = clocks.timer_slot(world, node, SOURCE)
            if world.wheel.events[slot].bucket == NIL:
                wait = clocks.true_delay(world, node, time, world.starts[node].source)
                queue.insert(world.wheel, slot, time + wait)

    def on_timer_slot(world, slot, time):
        """A node's timer, its first switching on, or its next sample."""
        timer = clocks.timer_of(world, slot)
        node = slot - timer * world.run[0].nodes
        if world.alive[node] == OFF:
            switch_on(world, node, time, COLD)
        elif world.alive[node] == DEAD:
            return
        elif timer == SOURCE:
            now = clocks.reading(world.clocks[node], time)
            world.counters[OFFERED] += 1
            touch.read_sensors(world, node, time)
            world.sample[0].made_at = time & MASK30
            sample(world, node, now & MASK30)
            finish(world, node, time, ON_INPUT, 0)
            wait = clocks.true_delay(world, node, time, world.run[0].source_us)
            queue.insert(world.wheel, slot, time + wait)
        else:
            now = clocks.reading(world.clocks[node], time)
            fire(world, node, now & MASK30, timer)
            finish(world, node, time, ON_TIMER, timer)

    def on_arrival(world, event, slot, time):
        """A frame at the end of its cable."""
        run = world.run[0]
        end = event.target
        node = min(end >> 2, run.cells)
        frame = world.frames[slot - run.pool_slots]
        if wires.lands(world, event, node, frame, time):
            port = end - 4 * node
            hear(world, node, time, port, frame)
            world.counters[wires.ARRIVED + event.kind] += 1
            finish(world, node, time, ON_FRAME, port)
        queue.give(world.wheel, slot)

    def dispatch(world, slot, time):
        """Hand an event to what it is for."""
        run = world.run[0]
        if slot >= run.pool_slots:
            event = world.wheel.events[slot]
            if event.kind == wires.DELAYED:
                wires.release(world, slot, time, copy_frame)
            else:
                on_arrival(world, event, slot, time)
        elif slot < run.tx_slots:
            on_timer_slot(world, slot, time)
        else:
            wires.wire_free(world, slot - run.tx_slots, time, copy_frame)

    def give_order(world, order):
        """The PC is given a command for cells."""
        if orders.begin(world, order):
            node = world.run[0].cells
            now = clocks.reading(world.clocks[node], order.at)
            give(world, now & MASK30)
            finish(world, node, order.at, ON_INPUT, 0)

    def advance(world, until, budget):
        """Run up to, not including, time `until` (us), or about `budget` events."""
        run = world.run[0]
        wheel = world.wheel
        for _ in range(0, budget, BATCH):
            run.status = pressing(world)
            if run.status != DONE:
                return
            limit = until
            if run.next_command < run.commands:
                limit = min(until, world.commands[run.next_command].at)
            for _ in range(BATCH):
                slot = queue.pop(wheel, limit)
                if slot == NIL:
                    break
                if run.cells > FORESEE_CELLS:
                    foresee(world, wheel)
                dispatch(world, slot, wheel.clock[queue.NOW])
            if slot == NIL and run.broken == 0:
                if limit >= until:
                    return
                command = world.commands[run.next_command]
                if command.action == commands.GIVE:
                    give_order(world, command)
                else:
                    commands.obey(world, command, switch_on, stopped)
                run.next_command += 1
        run.status = BUDGET

    return Handlers(
        drain, look, finish, switch_on, on_timer_slot, on_arrival, dispatch, give_order, report,
        advance,
    )  # fmt: skip
