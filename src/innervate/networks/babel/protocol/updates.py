"""Updates: what we say of our route, and when [3.7]."""

from innervate.dialect.arith import MASK30, later
from innervate.dialect.outbox import set_timer
from innervate.networks.babel.protocol.common import arm, frame_to, own_metric
from innervate.networks.babel.protocol.constants import (
    INFINITY,
    NONE,
    SAID_MAX,
    SOON,
    TENTH_MS,
    UPDATE,
)


def send_update(node, params, now, port, out):
    """An update of its own on a port."""
    fill_route(node, params, now, frame_to(node, port, UPDATE, out), 1, out)


def between(params):
    """Hellos between two updates; fewer where a frame could not say when the next one comes."""
    return min(params.update_hellos, SAID_MAX // params.hello_us)


def fill_route(node, params, now, frame, is_update, out):
    """Our distance into a frame, which first becomes part of our feasibility distance [3.7.3]."""
    metric = own_metric(node, params)
    seq = node.fd_seq
    if node.number == params.pc:
        seq = node.seqno
    elif node.parent != NONE:
        seq = node.seq[node.parent]
    frame.seq = seq
    frame.metric = metric
    frame.update = between(params) * params.hello_us // TENTH_MS
    if is_update == 0 or metric == INFINITY:
        return
    if node.fd_known == 0 or later(seq, node.fd_seq):
        node.fd_seq = seq
        node.fd_metric = metric
    elif seq == node.fd_seq:
        node.fd_metric = min(node.fd_metric, metric)
    node.fd_known = 1
    node.fd_at = (now + params.gc_us) & MASK30
    arm(node, node.fd_at, out)


def trigger(node, params, now, out):
    """Have an update sent soon [3.7.2]."""
    if node.soon == 0:
        node.soon = 1
        set_timer(out, SOON, (now + params.urgent_us) & MASK30)
