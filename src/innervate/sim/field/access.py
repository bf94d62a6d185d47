"""Below a protocol in a field: a medium access like CSMA, or nothing (see `sim/field`)."""

from innervate.dialect.access import PACKET, REPORT_GAVE_UP
from innervate.dialect.arith import MASK30
from innervate.dialect.outbox import DELIVER, REPORT, SEND, SET_TIMER, URGENT
from innervate.kernel.bits import mix
from innervate.sim import rows, taps
from innervate.sim.field import calls, medium, queue
from innervate.sim.field.medium import (
    BROKEN_FRAME,
    BROKEN_HELD,
    BROKEN_OUTBOX,
    NONE,
    breaks,
    set_timer,
)
from innervate.sim.field.states import COMMITTED, FREE, HELD, ON_AIR
from innervate.sim.status import DONE, ON_FRAME, ON_INPUT, ON_START, ON_TIMER

NEVER = -1
MAC = 8  # in trails: a handler of the medium access
ATTEMPT_MAX = 14


def give_up(world, node, time):
    """The medium access returns the node's frame."""
    run, radio = world.run[0], world.radios[node]
    run.gave_up += 1
    if radio.held != NONE:
        medium.release(world, radio.held)
        radio.held = NONE
    radio.tell_at = time
    queue.push(world.heap, queue.key_of(time, queue.TELL, node, 0))


def short(_world):
    """Why the layer below has to stop before the next event: it never has."""
    return DONE


def due(_world):
    """When the layer below has something to do that is not in the field's queue: never."""
    return queue.TIME_MAX


def step(_world, _do, _time):
    """Nothing: no channel with events of its own lies below."""


def drain_mac(world, do, node, time, handler):
    """Carry out what the medium access wants: True if it hands up the frame it was given."""
    run, out, radio = world.run[0], world.mac_out, world.radios[node]
    mark = mix(run.fingerprint, (time << 26) ^ (node << 6) ^ handler)
    now = time + radio.offset
    handed_up = False
    for i in range(out.count[0]):
        act = out.action[i]
        kind, a, b, c = act.kind, act.a, act.b, act.c
        mark = mix(mark, kind ^ (a << 3) ^ (b << 20) ^ (c << 50))
        if kind == SEND:
            medium.commit(world, radio.hot if c & URGENT else radio.held, time)
        elif kind == SET_TIMER:
            set_timer(world, node, run.own_timers + a, b, time, now)
        elif kind == REPORT and a == REPORT_GAVE_UP:
            give_up(world, node, time)
        elif kind == DELIVER:
            handed_up = True
    out.count[0] = 0
    run.fingerprint = mark
    if out.overflow[0]:
        breaks(world, BROKEN_OUTBOX, node)
    if run.watchful:
        rows.record_step(world, node, time, handler, 0)
    return handed_up


def hand_down(world, do, node, frame, act, time):
    """The protocol sends a frame: put it where frames under way are; returns its digest."""
    run, radio, item = world.run[0], world.radios[node], world.mac_item[0]
    urgent = act.c & URGENT
    if radio.held != NONE and not urgent:
        breaks(world, BROKEN_HELD, node)
        return 0
    if radio.deaf and (urgent or not run.mac):
        run.blocked += 1
        if not urgent:
            give_up(world, node, time)
        return 0
    place = medium.reserve(world, node, HELD)
    if place == NONE:
        return 0
    kept = world.frames[place]
    do.copy_frame(kept, frame)
    mark = do.digest(kept)
    world.air[place].digest = mark
    if not urgent and (run.mac or run.told):
        radio.held = place
    if not run.mac:
        medium.commit(world, place, time)
        return mark
    radio.hot = place
    item.us = medium.airtime(world, do.frame_bytes(kept))
    item.urgent = 1 if urgent else 0
    item.attempt = act.b
    do.mac_on_input(world, node, (time + radio.offset) & MASK30, PACKET)
    drain_mac(world, do, node, time, MAC + ON_INPUT)
    return mark


def power_on(world, do, node, time, cause):
    """A node starts; its router does right after this."""
    medium.miss(world, node, time)
    world.radios[node].told = 0
    if world.run[0].mac:
        do.mac_on_start(world, node, (time + world.radios[node].offset) & MASK30, cause)
        drain_mac(world, do, node, time, MAC + ON_START)


def power_off(world, do, node, time):
    """A node stops, in mid-frame too."""
    for place in range(len(world.air)):
        air = world.air[place]
        if air.node == node and air.state != FREE:
            length = do.frame_bytes(world.frames[place])
            do.record_sent(world, place, time, length, 0)
            medium.abandon(world, place)


def expire_below(world, do, node, timer, time):
    """A timer of the medium access is due; before that it learns what the radio hears."""
    run, radio = world.run[0], world.radios[node]
    now = time + radio.offset
    run.handled += 1
    carrier = 1 if medium.senses(world, node) else 0
    if carrier != radio.told:
        radio.told = carrier
        do.mac_on_carrier(world, node, now & MASK30, carrier, 0)
    do.mac_on_timer(world, node, now & MASK30, timer - run.own_timers)
    drain_mac(world, do, node, time, MAC + ON_TIMER)


def arrive(world, do, node, place, time):
    """A node has received the frame at `place`."""
    run, frame = world.run[0], world.frames[place]
    do.note_heard(world, node, place)
    run.arrived += 1
    do.tap(world, place, node, time, 0, taps.FINE)
    if run.mac:
        do.mac_on_frame(world, node, (time + world.radios[node].offset) & MASK30, frame)
        if not drain_mac(world, do, node, time, MAC + ON_FRAME):
            return
    calls.take(world, do, node, frame, time)


def end(world, do, place, time):
    """A frame has left the air: receivers first, then its sender is told."""
    run, air = world.run[0], world.air[place]
    frame, node, is_whole = world.frames[place], air.node, air.state == ON_AIR
    if is_whole:
        medium.leave(world, place)
        count = medium.receivers(world, place, do.tap)
        do.record_sent(world, place, time, do.frame_bytes(frame), count)
        for i in range(count):
            arrive(world, do, world.got[i], place, time)
        if run.checks and do.digest(frame) != air.digest:
            breaks(world, BROKEN_FRAME, node)
    medium.release(world, place)
    if is_whole and world.radios[node].held == place:
        world.radios[node].held = NONE
        do.tell_sent(world, do, node, time, 1)


def dispatch_below(world, do, rank, node, what, time):
    """An event of the medium, or of the medium access."""
    if rank == queue.ENDS:
        end(world, do, what, time)
        do.note_carriers(world, do, time)
    elif rank == queue.STARTS:
        if world.air[what].state == COMMITTED:
            medium.start(world, what, time, do.frame_bytes(world.frames[what]))
            do.tap(world, what, world.air[what].node, time, 1, taps.FINE)
        else:
            medium.release(world, what)
        do.note_carriers(world, do, time)
    elif world.radios[node].tell_at == time:
        world.radios[node].tell_at = NEVER
        do.tell_sent(world, do, node, time, 0)
