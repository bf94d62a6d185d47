"""Cables: 4 Mbit/s each way, a queue per port, latency, loss, loose and cut connections.

A frame occupies its wire for `wire_us` and arrives `latency` after its start. Urgent frames
(beacons) take the wire as soon as the frame on it is out; others wait in the port's drop-tail
queue.
A cable's `epoch` is odd while it is down; a frame arrives only if the epoch did not change.
`do` are the network's functions (see `sim/cables`).
"""

from innervate.dialect.outbox import FLUSH, URGENT
from innervate.dialect.rng import LOW15, step
from innervate.sim import taps
from innervate.sim import wheel as queue
from innervate.sim.cables.world import ALIVE, DEAD

# Kinds of pool slots; an arrival is marked by the block of counters its frame belongs to.
DELAYED = 1

# Words of `world.counters`; in blocks: data, urgent frames, and others: those that the network's
# `block_of` says. From OWN on, and behind the last block, words are the network's.
SENT = 0
ARRIVED = 1
LOST_CUT = 2
LOST_NOISE = 3
LOST_OFF = 4
LOST_QUEUE = 5
LOST_BROKEN = 6
URGENT_BLOCK = 8
# The user's side.
OFFERED = 16
DELIVERED = 17
OWN = 18
OTHER_BLOCK = 24
OWN_TOO = 32
COUNTERS = 40
BLOCKS = (0, URGENT_BLOCK, OTHER_BLOCK)

# Why frames are lost.
REASONS = {
    "cut": LOST_CUT,
    "noise": LOST_NOISE,
    "off": LOST_OFF,
    "queue_full": LOST_QUEUE,
    "broken_link": LOST_BROKEN,
}

# Bits of `end.impaired`.
DOWN = 1
LOSSY = 2

# `epoch` of a delayed frame: its flags, and from this bit on in which life its node sent it.
LIFE = 3
FLAGS = (1 << LIFE) - 1


def tap_out(world, do, end, frame, time, why):
    """Keep a copy of a frame that leaves at this end of a cable, if a capture is wanted."""
    if world.run[0].tap_limit > 0:
        do.copy_frame(world.tapped[world.run[0].taps], frame)
        taps.record_frame(world, time, end, 1, why)


def tap_in(world, do, end, frame, time, why):
    """Keep a copy of a frame that comes in at this end of a cable, if a capture is wanted."""
    if world.run[0].tap_limit > 0:
        do.copy_frame(world.tapped[world.run[0].taps], frame)
        taps.record_frame(world, time, end, 0, why)


def transmit(world, do, end, frame, time, flags):
    """A node hands a frame to its port at true time `time` (us)."""
    wire = world.ends[end]
    if wire.peer < 0:
        return
    if flags & FLUSH and world.buffers[end].queued > 0:
        give_up_queue(world, do, end, time, LOST_BROKEN, taps.BROKEN)
    if flags & URGENT:
        launch(world, do, end, frame, max(time, wire.busy), URGENT_BLOCK)
    elif wire.waiting == 0 and time >= wire.busy:
        launch(world, do, end, frame, time, do.block_of(frame))
    else:
        enqueue(world, do, end, frame, time)


def enqueue(world, do, end, frame, time):
    """Put a frame into its port's drop-tail queue."""
    buffer = world.buffers[end]
    room = world.run[0].queue_frames
    block = do.block_of(frame)
    world.counters[SENT + block] += 1
    if buffer.queued >= room:
        world.counters[LOST_QUEUE + block] += 1
        tap_out(world, do, end, frame, time, taps.QUEUE)
        return
    place = (buffer.first + buffer.queued) % room
    do.copy_frame(world.queue[end * room + place], frame)
    buffer.queued += 1
    wire = world.ends[end]
    if wire.waiting == 0:
        wire.waiting = 1
        queue.insert(world.wheel, world.run[0].tx_slots + end, wire.busy)


def wire_free(world, do, end, time):
    """The frame on the wire is out: start the next of the queue."""
    wire = world.ends[end]
    buffer = world.buffers[end]
    slot = world.run[0].tx_slots + end
    if buffer.queued == 0:
        wire.waiting = 0
    elif time < wire.busy:
        queue.insert(world.wheel, slot, wire.busy)
    else:
        room = world.run[0].queue_frames
        frame = world.queue[end * room + buffer.first]
        block = do.block_of(frame)
        world.counters[SENT + block] -= 1  # launch counts it again
        launch(world, do, end, frame, time, block)
        buffer.first = (buffer.first + 1) % room
        buffer.queued -= 1
        if buffer.queued == 0:
            wire.waiting = 0
        else:
            queue.insert(world.wheel, slot, wire.busy)


def launch(world, do, end, frame, start, block):
    """Put a frame on the wire at `start`; a queue slot brings it to the other side."""
    run = world.run[0]
    wire = world.ends[end]
    peer = wire.peer
    latency = wire.latency
    epoch = world.epoch[end]
    wire.busy = start + run.wire_us
    world.counters[SENT + block] += 1
    if wire.impaired and is_lost(world, do, end, block):
        tap_out(world, do, end, frame, start, why_lost(world, do, end))
        return
    tap_out(world, do, end, frame, start, taps.FINE)
    if run.latency_per_frame:
        latency = run.latency_low + chance(run, run.latency_high - run.latency_low + 1)
    slot = queue.take(world.wheel)
    event = world.wheel.events[slot]
    event.kind = block
    event.target = peer
    event.epoch = epoch
    do.copy_frame(world.frames[slot - run.pool_slots], frame)
    queue.insert(world.wheel, slot, start + latency)


def is_lost(world, do, end, block):
    """True if a cut or loose cable, or a planned loss, takes the frame; counts it."""
    wire = world.ends[end]
    if wire.impaired & DOWN:
        world.counters[(LOST_OFF if do.is_off(world, end) else LOST_CUT) + block] += 1
        return True
    buffer = world.buffers[end]
    if buffer.lose > 0:
        buffer.lose -= 1
        if buffer.lose == 0 and buffer.loss == 0:
            wire.impaired &= ~LOSSY
        world.counters[LOST_NOISE + block] += 1
        return True
    if buffer.loss > 0 and chance(world.run[0], 32768) < buffer.loss:
        world.counters[LOST_NOISE + block] += 1
        return True
    return False


def is_cut(world, end):
    """True if a cable is down for more reasons than that a node at it is dead."""
    reasons = world.ends[end].impaired >> 2
    for own in (end, world.ends[end].peer):
        if world.alive[min(own >> 2, world.run[0].cells)] == DEAD:
            reasons -= 1
    return reasons > 0


def why_lost(world, do, end):
    """What took a frame that left at this end, as taps say it."""
    if world.ends[end].impaired & DOWN:
        return taps.OFF if do.is_off(world, end) else taps.CUT
    return taps.NOISE


def chance(run, n):
    """A uniform integer 0 <= result < n <= 2^15 from the medium's own stream."""
    run.rng = step(run.rng)
    return ((run.rng & LOW15) * n) >> 15


def lands(world, do, event, node, frame, time):
    """True if a frame gets through to the node at the end of its cable; counts it either way."""
    end = event.target
    if event.epoch == world.epoch[end]:
        if world.alive[node] == ALIVE:
            tap_in(world, do, end, frame, time, taps.FINE)
            return True
        world.counters[LOST_OFF + event.kind] += 1
        tap_in(world, do, end, frame, time, taps.OFF)
    elif world.ends[end].impaired & DOWN and do.is_off(world, end):
        world.counters[LOST_OFF + event.kind] += 1
        tap_in(world, do, end, frame, time, taps.OFF)
    else:
        world.counters[LOST_CUT + event.kind] += 1
        tap_in(world, do, end, frame, time, taps.CUT)
    return False


def drop_queue(world, do, end, time):
    """Empty a port's queue because its node loses its memory, and with it what is delayed."""
    world.buffers[end].life += 1
    give_up_queue(world, do, end, time, LOST_OFF, taps.OFF)


def give_up_queue(world, do, end, time, reason, why):
    """Lose all that waits at a port."""
    buffer = world.buffers[end]
    room = world.run[0].queue_frames
    for i in range(buffer.queued):
        frame = world.queue[end * room + (buffer.first + i) % room]
        world.counters[reason + do.block_of(frame)] += 1
    taps.record_queue(world, end, time, why, do.copy_frame)
    buffer.queued = 0


def delay(world, do, end, frame, at, flags):
    """Hand a frame to its port later, at true time `at` (us)."""
    slot = queue.take(world.wheel)
    event = world.wheel.events[slot]
    event.kind = DELAYED
    event.target = end
    event.epoch = (flags & FLAGS) | (world.buffers[end].life << LIFE)
    do.copy_frame(world.frames[slot - world.run[0].pool_slots], frame)
    queue.insert(world.wheel, slot, at)


def release(world, do, slot, time):
    """The delay of a frame is over; a node that has lost its memory since does not send it."""
    event = world.wheel.events[slot]
    end = event.target
    flags = event.epoch & FLAGS
    frame = world.frames[slot - world.run[0].pool_slots]
    if event.epoch >> LIFE == world.buffers[end].life:
        transmit(world, do, end, frame, time, flags)
    elif world.ends[end].peer >= 0:
        block = URGENT_BLOCK if flags & URGENT else do.block_of(frame)
        world.counters[SENT + block] += 1
        world.counters[LOST_OFF + block] += 1
        tap_out(world, do, end, frame, time, taps.OFF)
    queue.give(world.wheel, slot)
