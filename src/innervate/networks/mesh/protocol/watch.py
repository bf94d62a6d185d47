"""Positions of robots: who hears them watches over the fence, the monitor that they go on."""

from innervate.networks.mesh.protocol.alarm import RAISED_OUT, raise_alarm
from innervate.networks.mesh.protocol.constants import (
    ALL,
    CLEAR,
    CROSS,
    LOST,
    MESSAGES,
    MONITOR,
    POSITION,
)
from innervate.networks.mesh.protocol.fence import OUTSIDE, margin
from innervate.networks.mesh.protocol.frames import (
    add8,
    add16,
    add_hop,
    get16,
    inner,
    signed8,
    signed16,
)
from innervate.networks.mesh.protocol.messages import first_flag, resolve
from innervate.networks.mesh.protocol.queue import compose
from innervate.networks.mesh.protocol.send import send_on

POSITION_BYTES = 8
NEVER = 255
RAISED_LOST = 1
SAID_OUT = 1  # flags of a position: its robot has raised the alarm
SAID_HEARD = 2  # ... and the monitor has acknowledged it
LOST_A_TICK = 4  # alarms: the outbox has to hold them; the others are a tick late


def write_position(node, i):
    """The 8 bytes of a position [mesh 2 POS_BEACON]."""
    said = 0
    if node.outside == OUTSIDE:
        said = SAID_OUT
        if node.heard_out:
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
        i = compose(node, now, MESSAGES, POSITION, monitor, first_flag(node, params, monitor), out)
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
    x = signed16(get16(frame, at + 1))
    y = signed16(get16(frame, at + 3))
    if resolve(node, params, MONITOR) == node.number:
        note_found(node, params, now, robot, x, y, out)
    if params.points == 0:
        return
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
        vx = signed8(frame.body[at + 5])
        vy = signed8(frame.body[at + 6])
        if raise_alarm(node, params, now, CROSS, robot, x, y, vx, vy, out):
            node.raised[robot] = node.raised[robot] | RAISED_OUT


def note_found(node, params, now, robot, x, y, out):
    """The monitor hears where a robot is: it is not lost, or not any more."""
    node.missed[robot] = 0
    if node.raised[robot] & RAISED_LOST:
        node.raised[robot] = node.raised[robot] & ~RAISED_LOST
        raise_alarm(node, params, now, CLEAR, robot, x, y, 0, 0, out)


def watch(node, params, now, out):
    """Every tick of the monitor: whose beacons stayed away?"""
    if resolve(node, params, MONITOR) != node.number:
        return
    left = LOST_A_TICK
    for robot in range(params.nodes):
        if node.missed[robot] != NEVER and node.raised[robot] & RAISED_LOST == 0:
            node.missed[robot] = min(node.missed[robot] + 1, NEVER - 1)
            if node.missed[robot] > params.lost and left > 0:
                left = left - 1
                node.raised[robot] = node.raised[robot] | RAISED_LOST
                raise_alarm(node, params, now, LOST, robot, 0, 0, 0, 0, out)
