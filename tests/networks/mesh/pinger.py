"""A router that routes nothing, in the protocol dialect: for tests of the mesh's simulator.

Messages go out once; whoever receives one for itself acknowledges it. Floods are passed on once.
Every tick a node broadcasts its position, if `params.period` says so.
"""

from innervate.dialect.arith import MASK30, later
from innervate.dialect.outbox import URGENT, deliver, report, send, set_timer
from innervate.dialect.rng import draw
from innervate.networks.mesh.protocol.constants import (
    ACK,
    ACK_WANTED,
    ALL,
    DATA,
    FLOOD,
    MESSAGE,
    POSITION,
    REPORT_ACCEPTED,
    REPORT_DROPPED,
    REPORT_FULL,
    REPORT_HOP,
    SAMPLE,
    SENT,
    TICK,
)
from innervate.networks.mesh.protocol.frames import copy_frame as copy

REPORT_SENT = 20
REPORT_HEARD = 21
REPORT_PLACE = 22
REPORT_SPEED = 23
REPORT_TICK = 24


def on_start(node, gate, params, now, cause, out):
    """Begin to tick; nothing is under way."""
    node.busy = -1
    node.seq = draw(node, 65536)
    for i in range(params.nodes):
        node.idle[i] = 0
    report(out, REPORT_TICK, cause, node.ticks)
    set_timer(out, TICK, (now + 1 + draw(node, params.tick_us)) & MASK30)


def on_timer(node, gate, params, now, timer, out):
    """A tick: say where we are."""
    node.ticks = node.ticks + 1
    set_timer(out, TICK, (now + params.tick_us) & MASK30)
    if params.period == 2 and node.busy < 0:
        frame = fresh(node, out, POSITION, ALL, 0)
        frame.length = 8
        for k in range(8):
            frame.body[k] = node.ticks & 255


def on_input(node, gate, params, now, kind, item, out):
    """A message, the end of our frame, or our position."""
    if kind == SENT:
        node.busy = -1
        report(out, REPORT_SENT, item.ok, now & 65535)
    elif kind == SAMPLE:
        report(out, REPORT_PLACE, item.x, item.y)
        report(out, REPORT_SPEED, item.vx, item.vy)
    elif kind == MESSAGE:
        if node.busy >= 0:
            report(out, REPORT_FULL, item.handle, 1)
            return
        flags = FLOOD if item.dest == ALL else ACK_WANTED
        frame = fresh(node, out, DATA, item.dest, flags)
        frame.length = item.length
        for k in range(item.length):
            frame.body[k] = item.body[k]
        report(out, REPORT_ACCEPTED, item.handle, frame.seq)


def on_frame(node, gate, params, now, port, frame, out):
    """A frame: acknowledge it, or pass it on, or take note."""
    report(out, REPORT_HEARD, frame.link_src, frame.rssi)
    if frame.kind == ACK:
        if frame.link_dst == node.number:
            report(out, REPORT_HOP, frame.seq, frame.rssi)
    elif frame.kind == DATA and frame.flags & FLOOD:
        pass_on(node, frame, out)
    elif frame.kind == DATA and frame.link_dst == node.number:
        ack = out.frame[send(out, 0, 0, URGENT)]
        copy(ack, frame)
        ack.kind = ACK
        ack.link_src = node.number
        ack.link_dst = frame.link_src
        ack.path_len = 0
        ack.length = 0
        if is_new(node, frame):
            copy(out.frame[deliver(out, DATA)], frame)


def fresh(node, out, kind, dest, flags):
    """A new packet of ours."""
    node.busy = 0
    node.seq = (node.seq + 1) & 65535
    frame = out.frame[send(out, 0, 0, 0)]
    frame.kind = kind
    frame.flags = flags
    frame.link_src = node.number
    frame.link_dst = dest
    frame.origin = node.number
    frame.dest = dest
    frame.seq = node.seq
    frame.table_ver = 0
    frame.ttl = 24
    frame.path_len = 1
    frame.path[0] = node.number
    frame.rssi = 0
    return frame


def is_new(node, frame):
    """1 if no newer packet of its origin was here."""
    who = frame.origin
    if who == node.number:
        return 0
    if node.idle[who] and not later(frame.seq, node.newest[who]):
        return 0
    node.idle[who] = 1
    node.newest[who] = frame.seq
    return 1


def pass_on(node, frame, out):
    """A flooded packet: deliver it, and send it on if nothing of ours is under way."""
    if not is_new(node, frame):
        return
    copy(out.frame[deliver(out, DATA)], frame)
    if node.busy >= 0 or frame.path_len >= 24:
        report(out, REPORT_DROPPED, frame.origin, frame.seq)
        return
    node.busy = 0
    onward = out.frame[send(out, 0, 0, 0)]
    copy(onward, frame)
    onward.link_src = node.number
    onward.path[onward.path_len] = node.number
    onward.path_len = onward.path_len + 1
