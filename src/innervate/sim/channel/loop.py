"""The simulation loop of a radio channel: one function, compiled on arrays or plain on lists.

`do` are the functions of the network (see `sim/channel`).
"""

from collections.abc import Callable
from typing import Any

from innervate.dialect import access
from innervate.dialect.arith import MASK16, MASK30
from innervate.dialect.outbox import DELIVER, REPORT, SEND, SET_TIMER, STOP
from innervate.kernel.bits import mix
from innervate.scenario.actions.channel import BEGIN, FADE, GARBLE, JOIN, KILL
from innervate.scenario.actions.channel import LEAVE as RETIRE
from innervate.sim import heap as queue
from innervate.sim import status
from innervate.sim.channel import medium, traffic
from innervate.sim.channel.medium import NEVER
from innervate.sim.channel.world import RING, TIMERS
from innervate.sim.rows import record_row

ON_CARRIER = 4
BROKEN_OUTBOX = 3
BROKEN_FRAME = 8  # a receiver changed the frame that the others are handed, too
WHAT_MASK = (1 << queue.STATION_SHIFT) - 1

COLD, LATE = 0, 1
BATCH = 16  # events between two looks at the room left in the tables
ROWS_PER_EVENT = 24


def pressing(world):
    """Why the loop has to stop before the next event, or DONE."""
    run = world.run[0]
    if run.broken:
        return status.BROKEN
    # All stations may be told of a carrier in one event, and each fill its outbox.
    margin = BATCH * (ROWS_PER_EVENT + world.out.limit[0]) + run.stations * world.out.limit[0]
    if run.rows + margin > run.row_limit > 0 or run.sent + margin > run.sent_limit > 0:
        return status.ROWS_FULL
    if run.packets + margin > run.packet_limit > 0:
        return status.ROWS_FULL
    if run.trail + margin > run.trail_limit > 0:
        return status.ROWS_FULL
    if run.taps > run.tap_limit:
        return status.ROWS_FULL
    if world.heap.size[0] + 4 * run.stations + 8 * BATCH > len(world.heap.keys):
        return status.POOL_FULL
    return status.DONE


def drain(world, do, node, time):
    """Carry out what a handler put into the outbox; fold it into the fingerprint."""
    run, out = world.run[0], world.out
    mark = run.fingerprint
    for i in range(out.count[0]):
        act = out.action[i]
        kind, a, b, c = act.kind, act.a, act.b, act.c
        mark = mix(mark, kind ^ (a << 3) ^ (b << 20) ^ (c << 50))
        if kind == SEND and c & STOP:
            medium.break_off(world, node, time)
        elif kind == SEND:
            mark = mix(mark, do.digest(out.frame[i]))
            do.record_sent(world, node, out.frame[i], time)
            if out.frame[i].count > 0:
                do.note_sent(world, node, out.frame[i], time)
            medium.transmit(world, node, out.frame[i], time, do.copy_frame)
        elif kind == SET_TIMER:
            now = time + world.radios[node].offset
            at = time + max(0, ((b - now + (1 << 29)) & MASK30) - (1 << 29))
            if world.due[node * TIMERS + a] != at:
                world.due[node * TIMERS + a] = at
                queue.push(world.heap, queue.key_of(at, queue.TIMER, node, a))
        elif kind == REPORT:
            record_row(world, time, node, a, b, c)
            if a == access.REPORT_DELIVERED:
                for k in range(c):
                    do.note_delivered(world, node, (b + k) & MASK16, time)
                world.radios[node].noted |= 2
            elif a == access.REPORT_LEFT:
                world.radios[node].leaving = 2
        elif kind == DELIVER:
            do.note_received(world, node, out.frame[i], time)
    out.count[0] = 0
    run.fingerprint = mark
    if out.overflow[0] and run.broken == 0:
        run.broken, run.broken_node = BROKEN_OUTBOX, node


def finish(world, do, node, time, handler, port):
    """After a handler: account for it, carry out what it asked for, check."""
    run, radio = world.run[0], world.radios[node]
    run.handled += 1
    run.fingerprint = mix(run.fingerprint, (time << 26) ^ (node << 6) ^ (port << 40) ^ handler)
    if world.out.count[0] > 0:
        drain(world, do, node, time)
    if run.watchful:
        do.watch(world, node, time, handler, port)
        if run.broken and run.broken_at < 0:
            run.broken_at = time
    if radio.noted & 2:
        radio.noted &= 1
        if (run.saturated or radio.backlog > 0) and radio.leaving == 0:
            queue.push(world.heap, queue.key_of(time, queue.OFFER, node, 1))
    if radio.leaving == 2 and radio.alive and not radio.deaf:
        radio.alive = 0


def offer(world, do, node, time):
    """Hand packets down: of those that wait, and in saturation always new ones."""
    run, radio = world.run[0], world.radios[node]
    station = world.stations[node]
    most = min(access.QUEUE, 2 * run.per_turn + 1) if run.saturated else access.QUEUE
    for _ in range(access.QUEUE):
        if station.queued >= most or radio.leaving or not radio.alive:
            break
        if run.saturated:
            handle = traffic.make(world, node, time)
        elif radio.backlog > station.queued:
            handle = (radio.fresh - radio.backlog + station.queued) & MASK16
        else:
            break
        traffic.fill_item(world, node, handle)
        now = time + radio.offset
        kind = access.FORCE if run.forced else access.PACKET
        do.on_input(world, node, now & MASK30, kind)
        finish(world, do, node, time, status.ON_INPUT, kind)


def tell_clock(world, do, node, time):
    """Where stations share a clock: tell one which slot this is."""
    run, item = world.run[0], world.item[0]
    if run.period > 0:
        item.slots, item.handle = 0, time // run.period % run.stations
        item.ago = time % run.period
        now = time + world.radios[node].offset
        do.on_input(world, node, now & MASK30, access.CLOCK)
        finish(world, do, node, time, status.ON_INPUT, access.CLOCK)


def tell_outcome(world, do, node, time):
    """Tell a sender how many received its packet, 0 if it needs all; no radio could know."""
    run, radio, item = world.run[0], world.radios[node], world.item[0]
    if radio.told_at == time and radio.alive:
        item.slots, item.ago = 0, 0
        item.handle = world.got[node * RING + (radio.told & (RING - 1))]
        if run.oracle == medium.OF_ALL and traffic.lacking(world, node, radio.told) > 0:
            item.handle = 0
        now = time + radio.offset
        do.on_input(world, node, now & MASK30, access.RESULT)
        finish(world, do, node, time, status.ON_INPUT, access.RESULT)


def switch_on(world, do, node, time, cause):
    """Start a station; it learns at once whether there is a carrier."""
    radio = world.radios[node]
    radio.alive = 1
    radio.leaving = 0
    radio.candidate = NEVER
    radio.cd, radio.voc, radio.noted = 0, 0, 0
    radio.deaf = 0  # it died in mid-frame, and its radio starts anew, too
    radio.ready_at, radio.told_at = NEVER, NEVER
    now = time + radio.offset
    for timer in range(TIMERS):
        world.due[node * TIMERS + timer] = NEVER
    do.on_start(world, node, now & MASK30, cause)
    finish(world, do, node, time, status.ON_START, cause)
    tell_clock(world, do, node, time)
    medium.note_carrier(world, node)
    queue.push(world.heap, queue.key_of(time, queue.OFFER, node, 1))


def tell_carrier(world, do, node, time):
    """Tell a station what its radio hears."""
    radio = world.radios[node]
    radio.cd = 1 if radio.present > 0 else 0
    radio.voc = 1 if radio.present == 1 else 0
    now = time + radio.offset
    do.on_carrier(world, node, now & MASK30, radio.cd, radio.voc)
    finish(world, do, node, time, ON_CARRIER, radio.cd * 2 + radio.voc)


def edge(world, do, rank, node, what, time):
    """A signal arrives at a station, or ends there."""
    air, radio = world.air[what], world.radios[node]
    sender = what >> queue.AIR_BITS
    if rank == queue.STARTS:
        air.at_start += 1
        medium.go_on(world, queue.STARTS, what, air.start, air.at_start)
        medium.begin_signal(world, node, what)
    else:
        if not medium.is_end(world, sender, node, air, time):
            queue.pop(world.heap)  # its sender died before
            return
        air.at_end += 1
        medium.go_on(world, queue.ENDS, what, air.end, air.at_end)
        clear = radio.candidate == what or air.spoilt == medium.UNSENT
        received = medium.end_signal(world, node, what)
        do.record_received(world, node, what, time, clear, received)
        if received:
            run = world.run[0]
            run.decoded += 1
            now = time + radio.offset
            was = do.digest(world.frames[what]) if run.checks else 0
            do.on_frame(world, node, now & MASK30, world.frames[what])
            if run.checks and run.broken == 0 and do.digest(world.frames[what]) != was:
                run.broken, run.broken_node = BROKEN_FRAME, sender
            finish(world, do, node, time, status.ON_FRAME, world.frames[what].kind)
    medium.note_carrier(world, node)


def obey(world, do, index, time):
    """An event of the scenario."""
    command = world.commands[index]
    node = command.node
    radio, run = world.radios[node], world.run[0]
    if command.action == BEGIN:
        for i in range(run.stations):
            if world.radios[i].leaving == 0:
                switch_on(world, do, i, time, COLD)
    elif command.action == JOIN and not radio.alive:
        switch_on(world, do, node, time, LATE)
    elif command.action == KILL and radio.alive:
        radio.alive = 0
        medium.silence(world, node, time)
    elif command.action == RETIRE and radio.alive:
        radio.leaving = max(radio.leaving, 1)
        now = time + radio.offset
        do.on_input(world, node, now & MASK30, access.LEAVE)
        finish(world, do, node, time, status.ON_INPUT, access.LEAVE)
    elif command.action == GARBLE:
        radio.garble = command.value
    elif command.action == FADE:
        radio.fade = command.value


def tell_all(world, do, time):
    """Carrier notifications of this moment."""
    count = world.told[0]
    world.told[0] = 0
    for i in range(1, count + 1):
        node = world.told[i]
        radio = world.radios[node]
        radio.noted &= 2
        if radio.alive and radio.deaf != medium.SENDING:
            tell_carrier(world, do, node, time)


def dispatch(world, do, key, time):
    """Hand the first event of the queue to what it is for."""
    rank = (key >> queue.RANK_SHIFT) & 7
    node = (key >> queue.STATION_SHIFT) & (queue.STATIONS_MAX - 1)
    what = key & WHAT_MASK
    if rank <= queue.STARTS:
        edge(world, do, rank, node, what, time)
        return
    queue.pop(world.heap)
    radio = world.radios[node]
    if rank == queue.READY:
        if radio.ready_at == time:
            radio.deaf = 0
        if radio.alive and not radio.deaf:
            tell_carrier(world, do, node, time)
    elif rank == queue.TIMER:
        if world.due[node * TIMERS + what] == time and radio.alive:
            world.due[node * TIMERS + what] = NEVER
            now = time + radio.offset
            do.on_timer(world, node, now & MASK30, what)
            finish(world, do, node, time, status.ON_TIMER, what)
    elif rank == queue.OFFER:
        if what == 0:
            traffic.make(world, node, time)
            radio.next_offer += 1
            traffic.schedule(world, node)
        offer(world, do, node, time)
    elif rank == queue.OUTCOME:
        tell_outcome(world, do, node, time)
    else:
        obey(world, do, (node << queue.STATION_SHIFT) | what, time)


def run_until(world, do, until, budget):
    """Run up to, not including, time `until` (us), or `budget` events."""
    run, heap = world.run[0], world.heap
    for _ in range(0, budget, BATCH):
        run.status = pressing(world)
        if run.status != status.DONE:
            return
        for _ in range(BATCH):
            if run.broken:
                run.status = status.BROKEN
                return
            if run.completed >= run.wanted > 0:
                return
            key = heap.keys[0]
            if heap.size[0] == 0:
                key = queue.LAST
            if world.told[0] > 0 and key >= queue.key_of(run.now, queue.READY, 0, 0):
                tell_all(world, do, run.now)
                continue
            time = key >> queue.TIME_SHIFT
            if time >= until:
                return
            run.now = time
            dispatch(world, do, key, time)
    run.status = status.BUDGET


FUNCTIONS = (
    *(drain, finish, offer, tell_clock, tell_outcome, switch_on),
    *(tell_carrier, edge, obey, tell_all, dispatch, run_until),
)


def bind(do: Any) -> Callable[..., None]:
    """The loop over a network's functions (see `sim/channel`): (world, until_us, budget)."""

    def advance(world, until, budget):  # type: ignore[no-untyped-def]
        run_until(world, do, until, budget)

    return advance
