"""Slotted ALOHA: a message goes out in a slot drawn from a window; its recipient acknowledges."""

from innervate.dialect.arith import MASK30
from innervate.dialect.outbox import deliver, report, send, set_timer
from innervate.dialect.rng import draw

BEACON = 1
MESSAGE = 2
ACK = 3
TRY = 0
TICK = 1
TIMERS = 2
OUTBOX = 4
TRIES = 8
REPORT_GIVEN_UP = 2


def on_start(node, params, now, cause, out):
    """Switch on; node 0 begins to send beacons."""
    node.synced = 0
    node.waiting = 0
    node.sending = 0
    for i in range(16):
        node.seen[i] = 0
    if node.number == 0:
        set_timer(out, TICK, (now + params.slot_length_us) & MASK30)


def on_frame(node, params, now, port, frame, out):
    """A beacon, a message for us, or what says that ours has come."""
    if frame.kind == BEACON:
        node.phase = now
        node.synced = 1
        if node.waiting and node.tries == 0:
            plan(node, params, now, out)
    elif frame.kind == MESSAGE and frame.to == node.number:
        if not node.sending:  # at once, in the rest of its slot
            say(node, out, ACK, 2, frame.source, frame.seq)
        if node.seen[frame.source & 15] != frame.seq + 1:
            node.seen[frame.source & 15] = frame.seq + 1
            up = out.frame[deliver(out, MESSAGE)]
            up.kind = MESSAGE
            up.slots = frame.slots
            up.source = frame.source
            up.to = frame.to
            up.seq = frame.seq
            up.value = frame.value
            up.made_at = frame.made_at
    elif frame.kind == ACK and frame.to == node.number and frame.seq == node.seq:
        node.waiting = 0


def on_carrier(node, params, now, cd, voc, out):
    """Silence, or our own frame has ended."""
    node.sending = 0


def on_timer(node, params, now, timer, out):
    """Our slot has come, or the next beacon is due."""
    if timer == TICK:
        if not node.sending:
            node.phase = now
            node.synced = 1
            say(node, out, BEACON, 1, 0, 0)
        wait = params.beacon_slots * params.slot_length_us
        set_timer(out, TICK, (now + wait) & MASK30)
    elif node.waiting:
        if node.tries == TRIES:
            node.waiting = 0
            node.given_up = min(node.given_up + 1, 65535)
            report(out, REPORT_GIVEN_UP, node.seq, node.to)
            return
        if not node.sending:
            node.tries = node.tries + 1
            say(node, out, MESSAGE, 5, node.to, node.seq)
        plan(node, params, now, out)


def say(node, out, kind, slots, to, seq):
    """Send a frame; only a message has something in it."""
    node.sending = 1
    frame = out.frame[send(out, 0, 0, 0)]
    frame.kind = kind
    frame.slots = slots
    frame.source = node.number
    frame.to = to
    frame.seq = seq
    frame.value = node.value if kind == MESSAGE else 0
    frame.made_at = node.made_at if kind == MESSAGE else 0


def plan(node, params, now, out):
    """Try again in a slot of the window."""
    length = params.slot_length_us
    into = ((now - node.phase) & MASK30) % length
    wait = length - into + draw(node, params.window_slots) * length
    set_timer(out, TRY, (now + wait) & MASK30)


def on_input(node, params, now, kind, item, out):
    """A message for somebody; one that was not acknowledged yet is forgotten."""
    node.waiting = 1
    node.tries = 0
    node.to = item.to
    node.value = item.value
    node.seq = (node.seq + 1) & 255
    node.made_at = item.made_at
    if node.synced:
        plan(node, params, now, out)
