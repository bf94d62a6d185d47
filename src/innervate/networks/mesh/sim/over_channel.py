"""Below the router: a medium access protocol of radio teams, on a channel that all share.

The channel is simulated by `sim/channel`, with its own queue of events. A frame of the router is
a packet there, kept here under the packet's handle; what becomes of it comes back as an event of
the mesh's queue, which goes first at equal times.
"""

from innervate.dialect.access import QUEUE
from innervate.dialect.outbox import URGENT
from innervate.kernel.bits import mix
from innervate.networks.mesh.protocol.constants import ACK
from innervate.networks.mesh.scenario.plan import HEADER_SLOTS
from innervate.networks.mesh.sim import recorder
from innervate.sim import heap, taps
from innervate.sim.channel import loop as radio_loop
from innervate.sim.channel import medium as channel
from innervate.sim.channel import traffic
from innervate.sim.channel.world import RING
from innervate.sim.field import calls, medium, queue
from innervate.sim.field.medium import NONE
from innervate.sim.field.states import ALIVE, HELD, VOID

KEPT = 32  # frames of a node that are kept; more than its medium access can hold


# What the channel's loop calls: its world, whose `above` is the mesh's queue.


def note_sent(world, node, frame, time):
    """A frame of the router is to go on the air: note when all have heard its end."""
    traffic.note_sent(world, node, frame, time)
    heard = world.radios[node].data_end + tail_us(world, node)
    for i in range(frame.count):
        place = place_of(node, frame.handle + i)
        queue.push(world.above, queue.key_of(heard, queue.ENDS, node, place))


def note_received(world, node, frame, time):
    """It was received; perhaps not for the first time, which the channel's header does not say."""
    traffic.note_received(world, node, frame, time)
    for i in range(frame.count):
        place = place_of(frame.source, frame.handle + i)
        queue.push(world.above, queue.key_of(time, queue.STARTS, node, place))


def note_delivered(world, node, handle, time):
    """Its sender takes it for delivered."""
    traffic.note_delivered(world, node, handle, time)
    place = place_of(node, handle)
    queue.push(world.above, queue.key_of(time, queue.TELL, node, place))


def tail_us(world, node):
    """From the end of a station's frame until it is over at all others, too."""
    count = world.degree[node]
    return 1 + (world.delay[node * world.run[0].stations + count - 1] if count > 0 else 0)


def place_of(node, handle):
    """Where the frame is that a node handed down as this packet."""
    return node * KEPT + (handle & (KEPT - 1))


def slots_of(world, length):
    """Slots of a frame of so many bytes: a slot is a byte."""
    return world.run[0].phy_bytes + HEADER_SLOTS + length


def began(world, place, length, end):
    """When the transmission that ends, or would have ended, at `end` began: so many bytes."""
    air = world.air[place]
    air.end = end
    air.start = end - slots_of(world, length) * world.below.run[0].slot_us
    return air.start


def short(world):
    """Why the channel has to stop before its next event, or DONE."""
    below = world.below
    found = radio_loop.pressing(below)
    if below.run[0].broken:
        medium.breaks(world, recorder.BROKEN_BELOW, below.run[0].broken_node)
    return found


def due(world):
    """When the channel has something to do next."""
    below = world.below
    keys, now = below.heap, below.run[0].now
    key = keys.keys[0] if keys.size[0] > 0 else heap.LAST
    if below.told[0] > 0 and key >= heap.key_of(now, heap.READY, 0, 0):
        return now
    return key >> heap.TIME_SHIFT


def step(world, do, time):
    """Handle the next event of the channel below, at `time`, us."""
    below = world.below
    handled = below.run[0].handled
    key = below.heap.keys[0] if below.heap.size[0] > 0 else heap.LAST
    if below.told[0] > 0 and key >= heap.key_of(below.run[0].now, heap.READY, 0, 0):
        radio_loop.tell_all(below, do.channel, time)
    else:
        below.run[0].now = time
        radio_loop.dispatch(below, do.channel, key, time)
    world.run[0].handled += below.run[0].handled - handled


def hand_down(world, do, node, frame, act, time):
    """The router sends a frame: it becomes a packet; returns its digest."""
    run, radio, below = world.run[0], world.radios[node], world.below
    urgent = act.c & URGENT
    if radio.held != NONE and not urgent:
        medium.breaks(world, medium.BROKEN_HELD, node)
        return 0
    if urgent and below.radios[node].backlog >= QUEUE:
        run.blocked += 1
        return 0
    handle = traffic.make(below, node, time)
    place = place_of(node, handle)
    kept, air = world.frames[place], world.air[place]
    do.copy_frame(kept, frame)
    air.node, air.state, air.receivers, air.digest = node, HELD, 0, do.digest(kept)
    if not urgent:
        radio.held = place
    at = node * RING + (handle & (RING - 1))
    below.sizes[at] = slots_of(world, do.frame_bytes(kept))
    heap.push(below.heap, heap.key_of(time, heap.OFFER, node, 1))
    return air.digest


def power_on(world, do, node, time, _cause):
    """A node starts; its station listens first, as others may be on the air."""
    radio_loop.switch_on(world.below, do.channel, node, time, radio_loop.LATE)


def cut_short(world, do, node, place, time):
    """A node stops in mid-frame, if it has begun; nobody receives that."""
    length = do.frame_bytes(world.frames[place])
    if began(world, place, length, world.below.radios[node].data_end) < time:
        recorder.record_transmission(world, place, time, length, 0)


def power_off(world, do, node, time):
    """A node stops, in mid-frame too."""
    below = world.below
    radio = below.radios[node]
    if radio.backlog > 0 and radio.data_end > time:
        cut_short(world, do, node, place_of(node, radio.fresh - radio.backlog), time)
    radio.alive, radio.backlog = 0, 0
    channel.silence(below, node, time)
    for i in range(KEPT):
        world.air[node * KEPT + i].state = VOID


def expire_below(_world, _do, _node, _timer, _time):
    """Its timers are in the channel's own queue."""


def arrive(world, do, node, place, time):
    """A node has received the frame at `place`."""
    run, frame, air = world.run[0], world.frames[place], world.air[place]
    if world.radios[node].state == ALIVE and air.state != VOID:
        air.receivers += 1
        run.arrived += 1
        recorder.tap(world, place, node, time, 0, taps.FINE)
        if frame.kind != ACK:
            frame.rssi = medium.rssi_dbm(world, air.node, node)
        calls.take(world, do, node, frame, time)


def note_end(world, do, node, place, time):
    """The frame at `place` has left the air, everywhere."""
    run, air = world.run[0], world.air[place]
    if air.state == VOID:
        return
    length = do.frame_bytes(world.frames[place])
    end = time - tail_us(world.below, node)
    began(world, place, length, end)
    run.transmissions += 1
    run.received += air.receivers
    recorder.record_transmission(world, place, end, length, air.receivers)
    recorder.tap(world, place, node, air.start, 1, taps.FINE)
    air.receivers = 0
    if run.checks and do.digest(world.frames[place]) != air.digest:
        medium.breaks(world, medium.BROKEN_FRAME, node)


def dispatch_below(world, do, rank, node, what, time):
    """What the channel's loop has noted."""
    run = world.run[0]
    run.fingerprint = mix(run.fingerprint, world.below.run[0].fingerprint)
    if rank == queue.STARTS:
        arrive(world, do, node, what, time)
    elif rank == queue.ENDS:
        note_end(world, do, node, what, time)
    elif world.radios[node].held == what:
        world.radios[node].held = NONE
        do.tell_sent(world, do, node, time, 1)
