"""What a run leaves behind: rows, and what is checked on the way."""

from innervate.kernel.bits import mix
from innervate.networks.mesh.protocol.frames import copy_frame
from innervate.networks.mesh.protocol.search import BITS
from innervate.sim import taps
from innervate.sim.field.medium import breaks
from innervate.sim.field.states import ON_AIR

BROKEN_TWICE = 4  # a packet was delivered twice
BROKEN_BELOW = 7  # the channel below says what

DUPLICATES_HASH = 0x5EE


def record_sent(world, place, time, length, receivers):
    """A row of what was on the air until now, if it was."""
    if world.air[place].state == ON_AIR:
        record_transmission(world, place, time, length, receivers)


def record_transmission(world, place, time, length, receivers):
    """A row of what was on the air until now."""
    run, air, frame = world.run[0], world.air[place], world.frames[place]
    if run.sent_limit > 0:
        row = world.sent[run.sent]
        run.sent += 1
        row.time, row.end, row.node = air.start, time, air.node
        row.kind, row.flags, row.link_dst = frame.kind, frame.flags, frame.link_dst
        row.origin, row.dest, row.seq = frame.origin, frame.dest, frame.seq
        row.path_len, row.bytes, row.receivers = frame.path_len, length, receivers


def tap(world, place, at, time, out, why):
    """Keep a copy of the frame at `place`, as at node `at`, if a capture is wanted."""
    run, air = world.run[0], world.air[place]
    if run.tap_limit > 0:
        copy_frame(world.tapped[run.taps], world.frames[place])
        row = taps.record_frame(world, time, at, out, why)
        row.start, row.sender = air.start, air.node


def record_delivered(world, node, frame, time):
    """A row of what a node's user was given, and: never the same twice.

    What a node says to itself is on no path, and has its handle for a number.
    """
    run = world.run[0]
    if run.checks and frame.origin < run.nodes and frame.path_len > 0:
        check_once(world, node, frame, time)
    if run.delivered_limit > 0:
        row = world.delivered[run.delivered]
        run.delivered += 1
        row.time, row.node, row.kind = time, node, frame.kind
        row.flags, row.origin, row.dest = frame.flags, frame.origin, frame.dest
        row.seq, row.path_len = frame.seq, frame.path_len
        row.looped = is_looped(frame)
        row.body0 = frame.body[0] if frame.length > 0 else 0
        row.body1 = frame.body[1] if frame.length > 1 else 0
        row.body2 = frame.body[2] if frame.length > 2 else 0
        row.body3 = frame.body[3] if frame.length > 3 else 0


def is_looped(frame):
    """1 if a node transmitted the packet twice."""
    for i in range(1, frame.path_len):
        for k in range(i):
            if frame.path[i] == frame.path[k]:
                return 1
    return 0


def check_once(world, node, frame, time):
    """At most one delivery per receiver, origin, seq, and since each of them was switched on.

    Receivers may forget silent origins after some time, so only that long.
    """
    run = world.run[0]
    key = 1 | node << 1 | frame.origin << 9 | frame.seq << 17
    key |= (world.radios[node].boots & 1023) << 33
    key |= (world.radios[frame.origin].boots & 1023) << 43
    at = place_of(world.duplicate_key, key)
    if world.duplicate_key[at] == key:
        if time - world.duplicate_at[at] < run.forget:
            breaks(world, BROKEN_TWICE, node)
    else:
        world.duplicate_key[at] = key
        run.duplicates += 1
    world.duplicate_at[at] = time


def place_of(keys, key):
    """Where a key is, or belongs, in a hash table whose length is a power of two."""
    mask = len(keys) - 1
    at = mix(DUPLICATES_HASH, key) & mask
    for _ in range(mask):
        if keys[at] == 0 or keys[at] == key:
            break
        at = (at + 1) & mask
    return at


def record_round(world, node, time):
    """A row of what a gateway knows after a round, against the links that are good."""
    run = world.run[0]
    if run.round_limit == 0:
        return
    gate = world.gates[world.radios[node].gate]
    links = both = 0
    for a in range(run.nodes):
        for b in range(a + 1, run.nodes):
            bit = gate.known[a * run.row + b // BITS] >> (b % BITS) & 1
            links += bit
            both += bit & world.good[a * run.nodes + b]
    row = world.rounds[run.rounds]
    run.rounds += 1
    row.time = time
    row.node = node
    row.round = world.nodes[node].round
    row.links = links
    row.good = run.good
    row.both = both
