"""A protocol's handlers called, and what they ask for carried out (see `sim/field`)."""

from innervate.dialect.arith import MASK30
from innervate.dialect.outbox import DELIVER, REPORT, SEND, SET_TIMER
from innervate.kernel.bits import mix
from innervate.kernel.records import within_spans
from innervate.sim import rows
from innervate.sim.field.medium import BROKEN_OUTBOX, breaks, set_timer
from innervate.sim.status import ON_FRAME, ON_INPUT


def drain(world, do, node, time):
    """Carry out what a handler put into the outbox; fold it into the fingerprint."""
    run, out = world.run[0], world.out
    now = time + world.radios[node].offset
    for i in range(out.count[0]):
        act = out.action[i]
        kind, a, b, c = act.kind, act.a, act.b, act.c
        mark = mix(run.fingerprint, kind ^ (a << 3) ^ (b << 20) ^ (c << 50))
        run.fingerprint = mark
        if kind == SEND:
            sent = do.hand_down(world, do, node, out.frame[i], act, time)
            run.fingerprint = mix(run.fingerprint, sent)
        elif kind == SET_TIMER:
            set_timer(world, node, a, b, time, now)
        elif kind == REPORT:
            rows.record_row(world, time, node, a, b, c)
            do.note_report(world, node, time, a)
        elif kind == DELIVER:
            run.fingerprint = mix(mark, do.digest(out.frame[i]))
            do.record_delivered(world, node, out.frame[i], time)
    out.count[0] = 0
    if out.overflow[0]:
        breaks(world, BROKEN_OUTBOX, node)


def finish(world, do, node, time, handler, port):
    """After a handler: account for it, carry out what it asked for, check."""
    run = world.run[0]
    run.handled += 1
    run.fingerprint = mix(run.fingerprint, (time << 26) ^ (node << 6) ^ (port << 40) ^ handler)
    if world.out.count[0] > 0:
        drain(world, do, node, time)
    if run.watchful:
        if run.checks:
            do.check(world, do, node, time)
        rows.record_step(world, node, time, handler, port)


def give(world, do, node, time, kind):
    """Hand a node's router `world.item`, or what it is told."""
    now = time + world.radios[node].offset
    do.on_input(world, node, now & MASK30, kind)
    finish(world, do, node, time, ON_INPUT, kind)


def take(world, do, node, frame, time):
    """A node's router is handed a frame that was received."""
    now = time + world.radios[node].offset
    do.on_frame(world, node, now & MASK30, frame)
    finish(world, do, node, time, ON_FRAME, frame.kind)


def is_sound(world, node):
    """True if every word of a node's record is in its range."""
    return within_spans(world.words[node], world.low, world.high, world.spans)
