"""Requests for a greater seqno, and what becomes of those of others [3.8]."""

from innervate.dialect.arith import MASK16, MASK30, later
from innervate.networks.babel.protocol.common import arm, frame_to, is_feasible, metric_over
from innervate.networks.babel.protocol.constants import (
    HOPS_MAX,
    INFINITY,
    NONE,
    PORTS,
    SEQNO_REQUEST,
    TRIES,
)
from innervate.networks.babel.protocol.updates import send_update, trigger


def ask(node, params, now, port, out):
    """Request a seqno greater than that of our feasibility distance, on a port or on all [3.8.2.1].

    Nothing is asked twice while an answer may come.
    """
    seq = (node.fd_seq + 1) & MASK16
    if node.fd_known == 0 or (node.wanted and not later(seq, node.wanted_seq)):
        return
    want(node, now, seq, params.request_us, TRIES, out)
    send_request(node, port, seq, HOPS_MAX, out)


def want(node, now, seq, wait_us, tries, out):
    """Note a request that was sent [3.2.7]."""
    node.wanted = 1
    node.wanted_seq = seq
    node.wanted_tries = tries
    node.wanted_us = wait_us
    node.wanted_at = (now + wait_us) & MASK30
    arm(node, node.wanted_at, out)


def send_request(node, port, seq, hops, out):
    """A seqno request on a port; -1 on all."""
    for p in range(PORTS):
        if port == NONE or p == port:
            frame = frame_to(node, p, SEQNO_REQUEST, out)
            frame.seq = seq
            frame.hops = hops


def take_request(node, params, now, port, frame, out):
    """A seqno request: answered, or handed on toward the source [3.8.1.2]."""
    if node.number == params.pc:
        if later(frame.seq, node.seqno):
            node.seqno = (node.seqno + 1) & MASK16
            trigger(node, params, now, out)
        send_update(node, params, now, port, out)
    elif node.parent != NONE and not later(frame.seq, node.seq[node.parent]):
        send_update(node, params, now, port, out)
    elif node.parent != NONE and frame.hops >= 2:
        if node.wanted and not later(frame.seq, node.wanted_seq):
            return
        to = onward(node, port)
        if to != NONE:
            want(node, now, frame.seq, params.request_us, 0, out)
            send_request(node, to, frame.seq, frame.hops - 1, out)


def onward(node, port):
    """Where a request goes on: the selected route, a feasible one, any; never back."""
    if node.parent != port:
        return node.parent
    found = NONE
    for p in range(PORTS):
        if p != port and metric_over(node, p) < INFINITY:
            if found == NONE or is_feasible(node, node.seq[p], node.metric[p]):
                found = p
    return found
