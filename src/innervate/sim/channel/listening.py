"""What is kept and checked of any network on a channel: frames by what became of them, deliveries.

The counters stand in `world.above.counters`.
"""

from innervate.dialect.access import PACKET as PACKET
from innervate.kernel.records import within
from innervate.sim import taps
from innervate.sim.came import note_came
from innervate.sim.channel.loop import BROKEN_FRAME, BROKEN_OUTBOX
from innervate.sim.channel.medium import BROKEN_AIR, BROKEN_DEAF, BROKEN_EMPTY, BROKEN_RANGE
from innervate.sim.heard import ARRIVED, BROKEN_OFF, COLLIDED, DELIVERED, NOISY, OFF, SENDING

WORDS = {
    BROKEN_DEAF: "{node} sent while it was sending, or before its radio heard again",
    BROKEN_AIR: "{node} has too many transmissions under way",
    BROKEN_EMPTY: "{node} sent a frame of no slots",
    BROKEN_OUTBOX: "outbox of {node} overflowed",
    BROKEN_RANGE: "a value of {node} is out of its declared range",
    BROKEN_FRAME: "a receiver changed the frame that {node} had sent",
}


def why(world, node, what, clear, received):
    """Count what became of a frame at a node, and say it as taps do."""
    counters, radio = world.above.counters, world.radios[node]
    if received:
        counters[ARRIVED] += 1
        return taps.FINE
    if not radio.alive:
        counters[OFF] += 1
        return taps.COLLISION
    if radio.deaf:
        counters[SENDING] += 1
        return taps.SENDING
    if not clear:
        counters[COLLIDED] += 1
        return taps.COLLISION
    if world.air[what].spoilt:
        counters[BROKEN_OFF] += 1
        return taps.SPOILT
    counters[NOISY] += 1
    return taps.NOISE


def keep(world, node, kind, time, latency):
    """A node's user got a frame; how long it took, us, -1 = nobody knows."""
    run = world.run[0]
    world.above.counters[DELIVERED] += 1
    if run.packet_limit > 0:
        row = world.packets[run.packets]
        run.packets += 1
        row.time, row.node, row.port, row.kind, row.latency = time, node, 0, kind, latency
    note_came(world.above.came, time, latency)


def note_sent(world, node, frame, time):
    """Frames with packets of the medium's own; there are none."""


def note_delivered(world, node, handle, time):
    """Packets of the medium's own; there are none."""


def check_range(world, node):
    """Every word of a node's record lies in its declared range."""
    run = world.run[0]
    if run.checks and run.broken == 0 and not within(world.words[node], world.low, world.high):
        run.broken = BROKEN_RANGE
        run.broken_node = node
