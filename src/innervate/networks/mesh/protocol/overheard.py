"""Frames for others that tell us something: acks get lost, but everybody hears what follows.

Who does not notice that its neighbour has a packet makes two of it by sending it another way.
"""

from innervate.networks.mesh.protocol.backoff import note_answer
from innervate.networks.mesh.protocol.constants import ALARM, ALL, E2E_ACK, PARITY
from innervate.networks.mesh.protocol.frames import get16, in_path, inner
from innervate.networks.mesh.protocol.neighbours import place_of
from innervate.networks.mesh.protocol.queue import FREE, close, tell_hop


def drop_overheard(node, params, frame, out):
    """Forget what need not be sent as this frame tells: its next hop, or its recipient, has it."""
    for i in range(node.places):
        if node.q_state[i] != FREE and (node.q_link_dst[i] != ALL or node.q_kind[i] == ALARM):
            if is_confirmed(node, i, frame) or is_passed_on(node, i, frame):
                if node.q_tries[i] > 0:
                    note_answer(node, params, place_of(node, params, node.q_link_dst[i]))
                tell_hop(node, i, out)
                close(node, params, i)


def is_passed_on(node, i, frame):
    """1 if this frame is the one in place i, sent on by the hop that it went to.

    We are on its path then, else the hop repeats what it sent us, and what we give back to it.
    """
    if node.q_seq[i] != frame.seq or node.q_origin[i] != frame.origin:
        return 0
    if (node.q_flags[i] ^ frame.flags) & PARITY:
        return 0
    return node.q_link_dst[i] == frame.link_src and in_path(frame, node.number)


def is_confirmed(node, i, frame):
    """1 if this frame is the end-to-end ack for the message in place i."""
    if frame.kind != E2E_ACK or node.q_origin[i] != frame.dest:
        return 0
    at = inner(frame)
    return frame.length >= at + 2 and get16(frame, at) == node.q_seq[i]
