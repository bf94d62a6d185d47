"""The virtual fence: robots, monitor and witnesses raise alarms that get through [mesh 4 ALARM]."""

from innervate.dialect.arith import MASK16, MASK30
from innervate.dialect.outbox import deliver, report
from innervate.networks.mesh.protocol.constants import (
    ALARM,
    ALARMS,
    ALL,
    CROSS,
    END_TO_END,
    FIRST,
    FLOOD,
    MONITOR,
    PRIORITY,
    PUT_OUT,
    REPORT_ALARM,
    REPORT_EXPIRED,
    REPORT_MARGIN,
)
from innervate.networks.mesh.protocol.duplicates import FLOODED, record_flood
from innervate.networks.mesh.protocol.fence import OUTSIDE, judge, margin
from innervate.networks.mesh.protocol.frames import add_hop, put16
from innervate.networks.mesh.protocol.messages import first_flag, head_own, resolve, take
from innervate.networks.mesh.protocol.queue import FREE, WAITS, compose, kick
from innervate.networks.mesh.protocol.retransmission import (
    arm_retry,
    buffer_sent,
    compose_kept,
    free_buffer,
)
from innervate.networks.mesh.protocol.send import send_on, spread

ALARM_BYTES = 16
RAISED_OUT = 2


def on_sample(node, params, now, item, out):
    """A robot learns where it is; the fence is judged at every sample."""
    node.x = item.x
    node.y = item.y
    node.vx = item.vx
    node.vy = item.vy
    node.placed = 1
    if params.points == 0:
        return
    kind = judge(node, params)
    if kind == CROSS:
        node.heard_out = 0
    if kind >= 0:
        raise_own(node, params, now, kind, out)


def raise_own(node, params, now, kind, out):
    """A robot raises an alarm for itself."""
    raise_alarm(node, params, now, kind, node.number, node.x, node.y, node.vx, node.vy, out)


def repeat_alarm(node, params, now, out):
    """Every tick of a robot: outside, and nobody knows nor is being told? Once more, then.

    So it is while no gateway is known, when all tries failed, and after a change of the monitor.
    """
    if node.outside == OUTSIDE and not node.heard_out and not is_telling(node):
        raise_own(node, params, now, CROSS, out)


def raise_alarm(node, params, now, kind, robot, x, y, vx, vy, out):
    """Raise an alarm for a robot: on its way to the monitor, flooded besides if it must be.

    0 if it cannot be: nobody to tell, or no place.
    """
    gap = margin(params, x, y)
    monitor = resolve(node, params, MONITOR)
    if monitor == node.number:
        note_alarm(node, kind, robot, gap, out)
        tell_monitor(node, params, now, kind, robot, x, y, vx, vy, gap, out)
        return 1
    if monitor == ALL:
        return 0
    flags = END_TO_END | PRIORITY | first_flag(node, params, monitor)
    i = compose(node, now, ALARMS, ALARM, monitor, flags, out)
    if i < 0:
        return 0
    note_alarm(node, kind, robot, gap, out)
    write_alarm(node.q_body, i * node.q_room, node, params, now, kind, robot, x, y, vx, vy, gap)
    node.q_length[i] = ALARM_BYTES
    w = alarm_buffer(node, out)
    buffer_sent(node, params, now, w, i, robot, out)
    node.q_owner[i] = w
    if params.flood == 2 or (params.flood == 1 and kind == CROSS):
        flood(node, params, now, w, 1, out)
    send_on(node, params, now, i, out)
    kick(node, params, now, out)
    return 1


def note_alarm(node, kind, robot, gap, out):
    """An alarm gets its number, and is reported."""
    node.alarm = (node.alarm + 1) & 255
    report(out, REPORT_ALARM, kind, robot)
    report(out, REPORT_MARGIN, gap, node.alarm)


def write_alarm(body, at, node, params, now, kind, robot, x, y, vx, vy, gap):
    """The 16 bytes of an alarm from `body[at]` on, as payloads.py lays them out [mesh 2]."""
    tick_ms = max(1, params.tick_us // 1000)
    at_ms = node.ticks * tick_ms + ((now - node.tick_at) & MASK30) // 1000
    body[at] = robot
    body[at + 1] = params.fence
    body[at + 2] = node.alarm
    body[at + 3] = kind
    put16(body, at + 4, x)
    put16(body, at + 6, y)
    body[at + 8] = vx & 255
    body[at + 9] = vy & 255
    put16(body, at + 10, at_ms >> 16)
    put16(body, at + 12, at_ms)
    put16(body, at + 14, max(-32_768, min(32_767, gap)))


def alarm_buffer(node, out):
    """A place among the kept messages; an alarm puts out another message if it must."""
    w = free_buffer(node)
    if w >= 0:
        return w
    w = 0
    for k in range(node.kept):
        if node.wait_kind[k] != ALARM:
            w = k
    report(out, REPORT_EXPIRED, node.wait_handle[w], PUT_OUT)
    return w


def flood(node, params, now, w, instance, out):
    """Flood the kept alarm w: with the same number, so that the monitor takes one of all copies."""
    i = compose_kept(node, now, ALARMS, w, out)
    if i < 0:
        return
    node.q_flags[i] = node.q_flags[i] | FLOOD
    node.q_ttl[i] = instance
    node.q_copies[i] = 2
    add_hop(node, i)
    record_flood(node, node.number, node.wait_seq[w], FLOODED, instance)


def flood_again(node, params, now, w, out):
    """The kept alarm w was not acknowledged in time: another instance of the flood."""
    instance = node.wait_tries[w] - 1 + (params.flood == 2)
    body = w * node.wait_room
    if params.flood == 1 and node.wait_body[body + 3] == CROSS:
        instance = instance + 1
    if params.flood and 0 < instance <= params.instances:
        flood(node, params, now, w, instance, out)
        kick(node, params, now, out)


def on_flood(node, params, now, frame, k, out):
    """A flooded alarm of the neighbour in place k: the monitor takes it, others pass it on once.

    A copy of who is as near to the gateway as we are or nearer, heard meanwhile, stands for one of
    ours; who is nearer goes first where other alarms wait. Six robots that leave at once fill the
    channel else.
    """
    ahead = k >= 0 and node.round_depth[k] <= node.depth
    if record_flood(node, frame.origin, frame.seq, FLOODED, min(frame.ttl, 3)):
        if ahead:
            spare_copy(node, frame)
        return
    if frame.dest == node.number:
        take_alarm(node, params, now, frame, out)
        return
    crowded = yield_routed(node, params, now)
    i = spread(node, params, now, ALARMS, frame, out)
    if i >= 0:
        if ahead and crowded:
            node.q_due[i] = (node.q_due[i] + params.flood_us) & MASK30
        node.q_copies[i] = 2
        if not add_hop(node, i):
            node.q_state[i] = FREE


def yield_routed(node, params, now):
    """1 if other alarms wait here; their routed copies may not be needed, and wait longer."""
    others = False
    for i in range(node.places):
        if node.q_state[i] == WAITS and node.q_kind[i] == ALARM:
            others = True
            if node.q_link_dst[i] != ALL:
                node.q_due[i] = (now + 4 * params.flood_us) & MASK30
    return others


def spare_copy(node, frame):
    """Somebody else has passed on the flooded alarm: a copy of ours less."""
    for i in range(node.places):
        waits = node.q_state[i] == WAITS and node.q_kind[i] == ALARM and node.q_link_dst[i] == ALL
        if waits and node.q_seq[i] == frame.seq and node.q_origin[i] == frame.origin:
            node.q_copies[i] = node.q_copies[i] - 1
            if node.q_copies[i] == 0:
                node.q_state[i] = FREE


def redirect(node, params, now, old, out):
    """Alarms kept for a gateway that leads no more go to the new one, under a number of their own.

    Floods of the old number have been everywhere, and would not be passed on again.
    """
    for w in range(node.kept):
        if node.wait_kind[w] == ALARM and node.wait_dest[w] == old and params.monitor == MONITOR:
            node.seq = (node.seq + 1) & MASK16
            node.wait_seq[w] = node.seq
            node.wait_dest[w] = node.gateway
            node.wait_flags[w] = node.wait_flags[w] | FIRST
            node.wait_tries[w] = 0
            node.wait_due[w] = now
    arm_retry(node, now, out)


def take_alarm(node, params, now, frame, out):
    """An alarm has reached the monitor."""
    if frame.length >= ALARM_BYTES:
        take(node, params, now, frame, out)


def tell_monitor(node, params, now, kind, robot, x, y, vx, vy, gap, out):
    """We are the monitor, and saw it ourselves."""
    if robot == node.number and kind == CROSS:
        node.heard_out = 1
    frame = out.frame[deliver(out, ALARM)]
    head_own(node, frame, ALARM, node.alarm, ALARM_BYTES)
    write_alarm(frame.body, 0, node, params, now, kind, robot, x, y, vx, vy, gap)


def is_telling(node):
    """1 if an alarm of ours, about ourselves, still waits for the monitor."""
    for w in range(node.kept):
        if node.wait_kind[w] == ALARM and node.wait_body[w * node.wait_room] == node.number:
            return 1
    return 0


def clear_raised(node, w):
    """The alarm that was kept in place w was given up: a witness raises it anew if it must."""
    robot = node.wait_body[w * node.wait_room]
    node.raised[robot] = node.raised[robot] & ~RAISED_OUT
