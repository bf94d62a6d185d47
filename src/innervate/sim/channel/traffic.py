"""Packets: offered to stations, followed until their sender takes them for delivered."""

from innervate.dialect.access import QUEUE
from innervate.dialect.arith import HALF16, MASK16
from innervate.sim.channel.medium import NEVER
from innervate.sim.channel.world import RING
from innervate.sim.heap import OFFER, key_of, push


def schedule(world, node):
    """Queue the station's next offer, if there is one."""
    radio = world.radios[node]
    if radio.next_offer < world.radios[node + 1].first_offer:
        push(world.heap, key_of(world.arrivals[radio.next_offer], OFFER, node, 0))


def make(world, node, time):
    """A new packet of a station: its handle, or -1 if too many wait already."""
    radio = world.radios[node]
    world.run[0].offers += 1
    if radio.backlog >= RING - QUEUE:
        world.run[0].dropped += 1
        return NEVER
    handle = radio.fresh
    radio.fresh = (handle + 1) & MASK16
    radio.backlog += 1
    place = node * RING + (handle & (RING - 1))
    world.offered[place] = time
    world.got[place] = 0
    world.tries[place] = 0
    return handle


def fill_item(world, node, handle):
    """The packet that is handed down next."""
    item = world.item[0]
    item.handle = handle
    item.slots = world.sizes[node * RING + (handle & (RING - 1))]


def note_sent(world, node, frame, time):
    """A station decides to send a frame with packets: it goes on the air after the turnaround."""
    run = world.run[0]
    world.radios[node].data_end = time + run.ta_us + frame.slots * run.slot_us
    for i in range(frame.count):
        world.tries[node * RING + ((frame.handle + i) & (RING - 1))] += 1


def note_received(world, node, frame, _time):
    """A frame with packets was received."""
    run = world.run[0]
    source = frame.source
    for i in range(frame.count):
        handle = (frame.handle + i) & MASK16
        before = world.last[node * run.stations + source]
        ahead = (handle - before) & MASK16
        if before == NEVER or (ahead != 0 and ahead < HALF16):
            world.last[node * run.stations + source] = handle
            world.got[source * RING + (handle & (RING - 1))] += 1
        else:
            run.again += 1


def lacking(world, node, handle):
    """How many who are on and hear a station did not receive a packet of it."""
    run = world.run[0]
    count = 0
    for k in range(world.degree[node]):
        other = world.order[node * run.stations + k]
        newest = world.last[other * run.stations + node]
        has_it = newest != NEVER and (newest - handle) & MASK16 < HALF16
        if world.radios[other].alive and not has_it:
            count += 1
    return count


def note_delivered(world, node, handle, time):
    """A station takes a packet for delivered; was it?

    Listeners are all who received it, and who else is on by now within reach.
    """
    run, radio = world.run[0], world.radios[node]
    place = node * RING + (handle & (RING - 1))
    receivers = world.got[place]
    listeners = receivers + lacking(world, node, handle)
    if receivers == 0:
        run.silent += 1
    elif receivers < listeners:
        run.partial += 1
    run.completed += 1
    radio.backlog -= 1
    if run.packet_limit > 0:
        row = world.packets[run.packets]
        run.packets += 1
        row.offered = world.offered[place]
        row.end, row.time, row.node, row.handle = radio.data_end, time, node, handle
        row.slots = world.sizes[place]
        row.receivers = receivers
        row.listeners = listeners
        row.tries = world.tries[place]
