"""Packets for others: taken over, passed on, or given back [mesh 4 ROUTED]."""

from innervate.dialect.arith import MASK30
from innervate.dialect.rng import draw
from innervate.networks.mesh.protocol.constants import (
    ALARM,
    ALARMS,
    CONTROL,
    DATA,
    GRAPH,
    MESSAGES,
    PARITY,
    POSITION,
)
from innervate.networks.mesh.protocol.duplicates import (
    WANTED,
    accept,
    mark_bad,
    record_flood,
    record_packet,
    record_return,
)
from innervate.networks.mesh.protocol.frames import in_path
from innervate.networks.mesh.protocol.messages import hand_up, take
from innervate.networks.mesh.protocol.neighbours import is_strong
from innervate.networks.mesh.protocol.queue import has_room, take_over
from innervate.networks.mesh.protocol.route import learn_way
from innervate.networks.mesh.protocol.send import enter, send_on, spread

AT_EASE = 6  # places free: what is flooded leaves at once, before those who passed it on forget it


def rank_of(frame):
    """How urgent a packet is."""
    if frame.kind == ALARM or frame.kind == GRAPH:
        return ALARMS
    if frame.kind == DATA or frame.kind == POSITION:
        return MESSAGES
    return CONTROL


def relay(node, params, now, frame, out):
    """A routed packet for somebody else."""
    if in_path(frame, node.number):
        if record_return(node, frame):
            return
        mark_bad(node, frame.link_src, frame.dest)
    else:
        if record_packet(node, frame):
            return
        learn_way(node, params, frame)
    i = take_over(node, now, rank_of(frame), frame, out)
    if i < 0:
        return
    send_on(node, params, now, i, out)


def flood_wanted(node, params, now, frame, k, out):
    """A message that looks for its recipient: ours is taken, another's passed on once a parity.

    A copy from a neighbour that is heard too faintly teaches no way that an ack could go.
    """
    if not is_strong(node, params, k) or in_path(frame, node.number):
        return
    parity = (frame.flags & PARITY) >> 7
    if record_flood(node, frame.origin, frame.seq, WANTED, parity):
        return
    if frame.dest == node.number:
        take(node, params, now, frame, out)
        return
    learn_way(node, params, frame)
    if has_room(node, AT_EASE):
        i = take_over(node, now, CONTROL, frame, out)
        node.q_due[i] = (now + draw(node, params.flood_us + 1)) & MASK30
        enter(node, params, i, out)


def flood_data(node, params, now, frame, out):
    """A message to all: deliver it, pass it on once."""
    if frame.origin == node.number or record_flood(node, frame.origin, frame.seq, DATA, 0):
        return
    if not accept(node, params, frame.origin, frame.seq, 1):
        return  # passed on so long ago that it is forgotten
    hand_up(params, frame, frame.kind, out)
    spread(node, params, now, MESSAGES, frame, out)
