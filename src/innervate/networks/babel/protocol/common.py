"""What links, routes and requests have in common: distances, frames, the next look."""

from innervate.dialect.arith import after, later
from innervate.dialect.outbox import URGENT, send, set_timer
from innervate.networks.babel.protocol.constants import INFINITY, LOOK, NONE


def is_feasible(node, seq, metric):
    """True if a distance is better than the best we have advertised [3.5.1]."""
    if metric == INFINITY or node.fd_known == 0 or later(seq, node.fd_seq):
        return True
    return seq == node.fd_seq and metric < node.fd_metric


def metric_over(node, p):
    """The metric of a port's route [3.5.2]."""
    if node.known[p] == 0 or node.metric[p] == INFINITY or node.cost[p] == INFINITY:
        return INFINITY
    return min(node.metric[p] + node.cost[p], INFINITY)


def own_metric(node, params):
    """The metric that we advertise."""
    if node.number == params.pc:
        return 0
    if node.parent == NONE:
        return INFINITY
    return metric_over(node, node.parent)


def forget_neighbour(node, p):
    """The entries of a port, empty."""
    node.neighbour[p] = NONE
    node.history[p] = 0
    node.txcost[p] = INFINITY
    node.cost[p] = INFINITY
    node.known[p] = 0
    node.metric[p] = INFINITY
    node.asked[p] = 0


def frame_to(node, port, kind, out):
    """A frame of ours for a port, to be filled."""
    frame = out.frame[send(out, port, 0, URGENT)]
    frame.kind = kind
    frame.source = node.number
    return frame


def arm(node, at, out):
    """Look again at `at`, or before."""
    if node.looking == 0 or not after(at, node.look_at):
        node.looking = 1
        node.look_at = at
        set_timer(out, LOOK, at)
