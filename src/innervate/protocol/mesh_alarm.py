"""The virtual fence: robots, monitor and witnesses raise alarms that get through [mesh 4 ALARM]."""

from innervate.protocol.arith import MASK30
from innervate.protocol.mesh_fence import judge, margin
from innervate.protocol.mesh_fields import WAITING
from innervate.protocol.mesh_frames import add8, add16, add_hop, get16, inner, signed8, signed16
from innervate.protocol.mesh_messages import (
    first_flag,
    free_wait,
    keep,
    resolve,
    take,
)
from innervate.protocol.mesh_queue import ALARMS, MESSAGES, compose, kick, take_over
from innervate.protocol.mesh_seen import FLOODED, is_flooded
from innervate.protocol.mesh_send import send_on
from innervate.protocol.mesh_words import (
    ALARM,
    ALL,
    CLEAR,
    CROSS,
    DATA_MAX,
    END_TO_END,
    FLOOD,
    LOST,
    MONITOR,
    POSITION,
    PRIORITY,
    REPORT_ALARM,
    REPORT_EXPIRED,
    REPORT_MARGIN,
)
from innervate.protocol.outbox import deliver, report
from innervate.protocol.rng import draw

ALARM_BYTES = 16
POSITION_BYTES = 8
NEVER = 255
RAISED_LOST = 1
RAISED_OUT = 2
SAID_OUT = 1  # flags of a position: its robot has raised the alarm
SAID_HEARD = 2  # ... and the monitor has acknowledged it
NO_PUT_OUT = 3
INSIDE = 0


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
    if kind >= 0:
        sound(node, params, now, kind, node.number, node.x, node.y, node.vx, node.vy, out)


def sound(node, params, now, kind, robot, x, y, vx, vy, out):
    """Raise an alarm for a robot: on its way to the monitor, flooded besides if it must be."""
    gap = margin(params, x, y)
    node.alarm = (node.alarm + 1) & 255
    report(out, REPORT_ALARM, kind, robot)
    report(out, REPORT_MARGIN, gap, node.alarm)
    monitor = resolve(node, params, MONITOR)
    if monitor == node.number:
        tell_monitor(node, params, now, kind, robot, x, y, vx, vy, gap, out)
        return
    if monitor == ALL:
        return
    flags = END_TO_END | PRIORITY | first_flag(node, monitor)
    i = compose(node, now, ALARMS, ALARM, monitor, flags, out)
    if i < 0:
        return
    write_alarm(node, params, now, i, kind, robot, x, y, vx, vy, gap)
    w = wait_for_alarm(node, out)
    keep(node, params, now, w, i, robot, out)
    node.q_owner[i] = w
    if params.flood == 2 or (params.flood == 1 and kind == CROSS):
        flood(node, params, now, w, 1, out)
    send_on(node, params, now, i, out)
    kick(node, params, now, out)


def write_alarm(node, params, now, i, kind, robot, x, y, vx, vy, gap):
    """The 16 bytes of an alarm [mesh 2 FENCE_ALARM]."""
    tick_ms = max(1, params.tick_us // 1000)
    at_ms = node.ticks * tick_ms + ((now - node.tick_at) & MASK30) // 1000
    add8(node, i, robot)
    add8(node, i, params.fence)
    add8(node, i, node.alarm)
    add8(node, i, kind)
    add16(node, i, x)
    add16(node, i, y)
    add8(node, i, vx)
    add8(node, i, vy)
    add16(node, i, at_ms >> 16)
    add16(node, i, at_ms & 65_535)
    add16(node, i, max(-32_768, min(32_767, gap)))


def wait_for_alarm(node, out):
    """A place among the kept messages; an alarm puts out another message if it must."""
    w = free_wait(node)
    if w >= 0:
        return w
    w = 0
    for k in range(WAITING):
        if node.wait_kind[k] != ALARM:
            w = k
    report(out, REPORT_EXPIRED, node.wait_handle[w], NO_PUT_OUT)
    return w


def flood(node, params, now, w, instance, out):
    """Flood the kept alarm w: with the same number, so that the monitor takes one of all copies."""
    flags = node.wait_flags[w] | FLOOD
    i = compose(node, now, ALARMS, ALARM, node.wait_dest[w], flags, out)
    if i < 0:
        return
    node.seq = (node.seq - 1) & 65_535
    node.q_seq[i] = node.wait_seq[w]
    node.q_ttl[i] = instance
    node.q_copies[i] = 2
    for k in range(node.wait_length[w]):
        add8(node, i, node.wait_body[w * DATA_MAX + k])
    add_hop(node, i)
    is_flooded(node, node.number, node.wait_seq[w], FLOODED, instance)


def flood_again(node, params, now, w, out):
    """The kept alarm w was not acknowledged in time: another instance of the flood."""
    instance = node.wait_tries[w] - 1 + (params.flood == 2)
    body = w * DATA_MAX
    if params.flood == 1 and node.wait_body[body + 3] == CROSS:
        instance = instance + 1
    if params.flood and 0 < instance <= params.instances:
        flood(node, params, now, w, instance, out)
        kick(node, params, now, out)


def on_flood(node, params, now, frame, out):
    """A flooded alarm: the monitor takes it, everyone passes it on once per instance."""
    if is_flooded(node, frame.origin, frame.seq, FLOODED, min(frame.ttl, 3)):
        return
    if frame.dest == node.number:
        take_alarm(node, params, now, frame, out)
        kick(node, params, now, out)
        return
    i = take_over(node, now, ALARMS, frame, out)
    if i >= 0:
        node.q_link_dst[i] = ALL
        node.q_copies[i] = 2
        node.q_due[i] = (now + draw(node, (params.jitter_us >> 2) + 1)) & MASK30
        if not add_hop(node, i):
            node.q_state[i] = 0
    kick(node, params, now, out)


def take_alarm(node, params, now, frame, out):
    """An alarm has reached the monitor."""
    if frame.length >= ALARM_BYTES:
        take(node, params, now, frame, out)


def tell_monitor(node, params, now, kind, robot, x, y, vx, vy, gap, out):
    """We are the monitor, and saw it ourselves."""
    frame = out.frame[deliver(out, ALARM)]
    frame.kind = ALARM
    frame.flags = 0
    frame.link_src = node.number
    frame.link_dst = node.number
    frame.origin = node.number
    frame.dest = node.number
    frame.seq = node.alarm
    frame.table_ver = 0
    frame.ttl = 0
    frame.path_len = 0
    frame.rssi = 0
    frame.length = ALARM_BYTES
    for k in range(ALARM_BYTES):
        frame.body[k] = 0
    frame.body[0] = robot
    frame.body[1] = params.fence
    frame.body[2] = node.alarm
    frame.body[3] = kind
    frame.body[4] = x >> 8 & 255
    frame.body[5] = x & 255
    frame.body[6] = y >> 8 & 255
    frame.body[7] = y & 255
    frame.body[8] = vx & 255
    frame.body[9] = vy & 255
    frame.body[14] = gap >> 8 & 255
    frame.body[15] = gap & 255


def knows_unheard(node):
    """1 if an alarm of ours still waits for the monitor."""
    for w in range(WAITING):
        if node.wait_kind[w] == ALARM:
            return 1
    return 0


def write_position(node, i):
    """The 8 bytes of a position [mesh 2 POS_BEACON]."""
    said = 0
    if node.outside == 2:
        said = SAID_OUT
        if not knows_unheard(node):
            said = SAID_OUT | SAID_HEARD
    add8(node, i, node.number)
    add16(node, i, node.x)
    add16(node, i, node.y)
    add8(node, i, node.vx)
    add8(node, i, node.vy)
    add8(node, i, said)


def beacon(node, params, now, out):
    """Every tick of a robot: its position to whoever hears it, and to the monitor."""
    i = compose(node, now, MESSAGES, POSITION, ALL, 0, out)
    if i >= 0:
        add_hop(node, i)
        write_position(node, i)
    monitor = resolve(node, params, MONITOR)
    if params.watch and monitor < ALL and monitor != node.number:
        i = compose(node, now, MESSAGES, POSITION, monitor, first_flag(node, monitor), out)
        if i >= 0:
            write_position(node, i)
            send_on(node, params, now, i, out)


def on_position(node, params, now, frame, out):
    """A robot says where it is: the monitor notes it, a witness raises the alarm for it.

    What the robot has reported itself, and the monitor acknowledged, needs no witness; nor does
    an alarm that was raised but a moment ago.
    """
    at = inner(frame)
    if frame.length < at + POSITION_BYTES:
        return
    robot = frame.body[at]
    if robot >= params.nodes or robot == node.number:
        return
    monitor = resolve(node, params, MONITOR) == node.number
    if monitor:
        found(node, params, now, robot, frame, at, out)
    if params.points == 0:
        return
    x = signed16(get16(frame, at + 1))
    y = signed16(get16(frame, at + 3))
    gap = margin(params, x, y)
    said = frame.body[at + 7]
    if gap >= 0:
        if gap > params.clear_margin:
            node.raised[robot] = node.raised[robot] & ~(RAISED_OUT | 4)
        return
    if said == SAID_OUT and node.raised[robot] & 4 == 0:
        node.raised[robot] = node.raised[robot] | 4  # give its own alarm a beacon's time
        return
    if said & SAID_HEARD == 0 and node.raised[robot] & RAISED_OUT == 0:
        node.raised[robot] = node.raised[robot] | RAISED_OUT
        vx = signed8(frame.body[at + 5])
        vy = signed8(frame.body[at + 6])
        sound(node, params, now, CROSS, robot, x, y, vx, vy, out)


def found(node, params, now, robot, frame, at, out):
    """The monitor hears of a robot: it is not lost, or not any more."""
    node.missed[robot] = 0
    if node.raised[robot] & RAISED_LOST:
        node.raised[robot] = node.raised[robot] & ~RAISED_LOST
        x = signed16(get16(frame, at + 1))
        y = signed16(get16(frame, at + 3))
        sound(node, params, now, CLEAR, robot, x, y, 0, 0, out)


def watch(node, params, now, out):
    """Every tick of the monitor: whose beacons stayed away?"""
    if resolve(node, params, MONITOR) != node.number:
        return
    for robot in range(params.nodes):
        if node.missed[robot] != NEVER and node.raised[robot] & RAISED_LOST == 0:
            node.missed[robot] = node.missed[robot] + 1
            if node.missed[robot] > params.lost:
                node.raised[robot] = node.raised[robot] | RAISED_LOST
                sound(node, params, now, LOST, robot, 0, 0, 0, 0, out)
