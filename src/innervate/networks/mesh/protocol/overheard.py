"""Frames for others that tell us something: acks get lost, but everybody hears what follows.

Who does not notice that its neighbour has a packet makes two of it by sending it another way.
"""

from innervate.networks.mesh.protocol.backoff import note_answer
from innervate.networks.mesh.protocol.constants import ALARM, DATA, E2E_ACK, PARITY
from innervate.networks.mesh.protocol.frames import get16, inner
from innervate.networks.mesh.protocol.neighbours import place_of
from innervate.networks.mesh.protocol.queue import UNACKED, WAITS, drop, tell_hop


def drop_overheard(node, params, frame, out):
    """Forget what need not be sent as this frame tells: its next hop, or its recipient, has it."""
    for i in range(node.places):
        state = node.q_state[i]
        if state == UNACKED or (state == WAITS and node.q_tries[i] > 0):
            if is_passed_on(node, i, frame) or is_confirmed(node, i, frame):
                note_answer(node, params, place_of(node, params, node.q_link_dst[i]))
                tell_hop(node, i, out)
                drop(node, params, i)
        elif state == WAITS and node.q_kind[i] == ALARM and is_confirmed(node, i, frame):
            drop(node, params, i)


def is_passed_on(node, i, frame):
    """1 if this frame is the one in place i, sent on by the hop that it went to."""
    if node.q_seq[i] != frame.seq or node.q_origin[i] != frame.origin:
        return 0
    if node.q_kind[i] != frame.kind or (node.q_flags[i] ^ frame.flags) & PARITY:
        return 0
    return node.q_link_dst[i] == frame.link_src


def is_confirmed(node, i, frame):
    """1 if this frame is the end-to-end ack for the message in place i."""
    kind = node.q_kind[i]
    if frame.kind != E2E_ACK or (kind != DATA and kind != ALARM) or node.q_origin[i] != frame.dest:
        return 0
    at = inner(frame)
    return frame.length >= at + 2 and get16(frame, at) == node.q_seq[i]
