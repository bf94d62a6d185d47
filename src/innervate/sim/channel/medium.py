"""The shared half-duplex channel [radio 3]: who hears what, when; who receives a frame.

A transmission reaches every other station after that pair's delay and lasts as long there. A
station counts the signals that are present; it receives a frame that was the only signal from its
start to its end, while its radio listened.

Two devices for baselines, which radios do not have: with `full_duplex` a sender hears carriers and
may break off; with `oracle` it learns, when all could know, how many received its packet, or that
not all did.
"""

from innervate.dialect.rng import LOW15, step
from innervate.sim import heap
from innervate.sim.heap import key_of, pop, push, replace

NOBODY = -1
NEVER = -1
BROKEN_DEAF = 1  # a station sent while its radio could not
BROKEN_AIR = 2  # too many transmissions of one station under way
BROKEN_RANGE = 4  # a value out of its declared range
BROKEN_EMPTY = 9  # a frame of no slots

# What is wrong with a transmission: `spoilt`.
GARBLED = 1
FADED = 2  # nobody hears anything of it
UNSENT = 3  # its sender died, or stopped, in the turnaround: its edges pass, and nobody hears them

CRR = 1
OF_ALL = 2  # `oracle`: a packet is received when all have it

# A radio's `deaf`.
SENDING = 1
HEARING = 2  # it sends and yet notes carriers (full duplex)


def transmit(world, node, frame, time, copy_frame):
    """Station `node` decides at `time` to send: deaf from now, on the air after the turnaround."""
    run, radio = world.run[0], world.radios[node]
    if radio.deaf:
        run.broken, run.broken_node = BROKEN_DEAF, node
        return
    if frame.slots < 1:
        run.broken, run.broken_node = BROKEN_EMPTY, node
        return
    place = node * heap.AIRS + radio.air
    air = world.air[place]
    last = world.degree[node] - 1
    if last >= 0 and air.end > 0 and air.end + world.delay[node * run.stations + last] > time:
        run.broken, run.broken_node = BROKEN_AIR, node
    on, off = time + run.ta_us, time + run.ta_us + frame.slots * run.slot_us
    air.start, air.end, air.spoilt = on, off, 0
    air.at_start, air.at_end = 0, 0
    copy_frame(world.frames[place], frame)
    if frame.kind == CRR:
        impair(world, radio, air)
    radio.deaf = HEARING if run.full_duplex else SENDING
    radio.candidate = NOBODY
    radio.ready_at = off + run.ta_us
    what = (node << heap.AIR_BITS) | radio.air
    radio.air = (radio.air + 1) & (heap.AIRS - 1)
    push(world.heap, key_of(radio.ready_at, heap.READY, node, 0))
    if world.degree[node] > 0 and air.spoilt != FADED:
        first = node * run.stations
        push(world.heap, key_of(on + world.delay[first], heap.STARTS, world.order[first], what))
        push(world.heap, key_of(off + world.delay[first], heap.ENDS, world.order[first], what))
    if run.oracle and frame.count > 0:
        radio.told, radio.told_at = frame.handle, radio.ready_at
        if last >= 0:
            known = off + world.delay[node * run.stations + last]
            radio.told_at = max(known, radio.ready_at)
        push(world.heap, key_of(radio.told_at, heap.OUTCOME, node, 0))


def impair(world, radio, air):
    """A CR-R that a fault of the scenario garbles (1) or hides (2)."""
    if radio.garble > 0:
        radio.garble -= 1
        air.spoilt = GARBLED
    elif radio.fade > 0:
        radio.fade -= 1
        air.spoilt = FADED


def go_on(world, rank, what, since, cursor):
    """A signal's edge is first in the queue: put that edge at the next station in its place."""
    sender = what >> heap.AIR_BITS
    if cursor < world.degree[sender]:
        at = sender * world.run[0].stations + cursor
        replace(world.heap, key_of(since + world.delay[at], rank, world.order[at], what))
    else:
        pop(world.heap)


def is_end(world, sender, node, air, time):
    """1 if this is where and when the signal's end is due; not so for the end of one cut short."""
    at = sender * world.run[0].stations + air.at_end
    return (
        air.at_end < world.degree[sender]
        and world.order[at] == node
        and air.end + world.delay[at] == time
    )


def begin_signal(world, node, what):
    """A signal arrives at a station."""
    radio = world.radios[node]
    if world.air[what].spoilt == UNSENT:
        return
    radio.present += 1
    if radio.present == 1 and radio.alive and not radio.deaf:
        radio.candidate = what
    else:
        radio.candidate = NOBODY


def end_signal(world, node, what):
    """A signal ends at a station: 1 if its frame was received."""
    radio, air = world.radios[node], world.air[what]
    if air.spoilt == UNSENT:
        return False
    radio.present -= 1
    received = radio.candidate == what
    radio.candidate = NOBODY
    if not received or air.spoilt or not radio.alive:
        return False
    run = world.run[0]
    if run.loss > 0:
        run.rng = step(run.rng)
        if (run.rng & LOW15) < run.loss:
            run.garbled += 1
            return False
    return True


def note_carrier(world, node):
    """Let a station know, after all edges of this moment, if its carrier has changed.

    `told` keeps these stations in order, after their number; nearly always they are very few.
    """
    radio = world.radios[node]
    if radio.deaf == SENDING or radio.noted & 1 or not radio.alive:
        return
    cd, voc = radio.present > 0, radio.present == 1
    if cd != radio.cd or voc != radio.voc:
        radio.noted |= 1
        i = world.told[0]
        world.told[0] = i + 1
        while i > 0 and world.told[i] > node:
            world.told[i + 1] = world.told[i]
            i -= 1
        world.told[i + 1] = node


def break_off(world, node, time):
    """A station stops sending in mid-frame, and listens at once."""
    radio = world.radios[node]
    if radio.deaf:
        silence(world, node, time)
        radio.ready_at, radio.told_at = time, NEVER
        push(world.heap, key_of(time, heap.READY, node, 0))


def silence(world, node, time):
    """A station stops in mid-frame, or dies: its signal ends now, and is no frame any more."""
    stations = world.run[0].stations
    for i in range(heap.AIRS):
        place = node * heap.AIRS + i
        air = world.air[place]
        if air.end > time and world.degree[node] > 0 and air.spoilt < FADED:
            is_on_air = air.start < time or air.at_start > 0
            air.end = max(time, air.start)
            air.spoilt = GARBLED if is_on_air else UNSENT
            first = node * stations
            what = (node << heap.AIR_BITS) | i
            key = key_of(air.end + world.delay[first], heap.ENDS, world.order[first], what)
            push(world.heap, key)
