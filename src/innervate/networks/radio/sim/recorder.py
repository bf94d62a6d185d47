"""What a run of a radio channel leaves behind: rows, and what is checked on the way."""

from innervate.networks.radio.protocol.constants import DATA
from innervate.networks.radio.protocol.station import copy_frame
from innervate.sim import taps
from innervate.sim.channel.listening import check_range
from innervate.sim.heap import AIR_BITS
from innervate.sim.rows import record_step

BROKEN_TURNS = 5


def record_sent(world, node, frame, time):
    """A row of what goes on the air."""
    run = world.run[0]
    start = time + run.ta_us
    end = start + frame.slots * run.slot_us
    if run.tap_limit > 0:
        copy_frame(world.tapped[run.taps], frame)
        taps.record_frame(world, start, node, 1, taps.FINE).sender = node
    if run.exclusive and frame.kind == DATA:
        if start < run.data_until and run.broken == 0:
            run.broken, run.broken_node = BROKEN_TURNS, node
        run.data_until = end
    if run.sent_limit > 0:
        row = world.sent[run.sent]
        run.sent += 1
        row.time, row.end, row.node, row.kind = start, end, node, frame.kind
        row.slots, row.pos, row.next, row.handle = frame.slots, frame.pos, frame.next, frame.handle
        row.count, row.more = frame.count, frame.more


def record_received(world, node, what, time, clear, received):
    """A signal has ended at a station: a capture says if its frame was received, or why not.

    `clear` = it was alone, and heard from its start.
    """
    run, radio, air = world.run[0], world.radios[node], world.air[what]
    if run.tap_limit > 0 and radio.alive:
        why = taps.FINE
        if not received:
            why = taps.SENDING if radio.deaf else taps.COLLISION
            if clear:
                why = taps.SPOILT if air.spoilt else taps.NOISE
        copy_frame(world.tapped[run.taps], world.frames[what])
        row = taps.record_frame(world, time, node, 0, why)
        row.start, row.sender = air.start, what >> AIR_BITS


def watch(world, node, time, handler, port):
    """Checkers, and the trail of all handler calls."""
    check_range(world, node)
    record_step(world, node, time, handler, port)
