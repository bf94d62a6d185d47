"""What must hold of Babel [RFC 8966, 2.4 and 3.6]."""

from innervate.dialect.arith import later
from innervate.networks.babel.protocol.constants import INFINITY


def is_better(seq, metric, other_seq, other_metric):
    """True if the first distance is strictly better than the other [3.5.1]."""
    return later(seq, other_seq) or (seq == other_seq and metric < other_metric)


def node_selects_feasible_routes(node, params, now):
    """A route is selected that is retracted, without a link, or not feasible"""
    p = node.parent
    if p < 0:
        return 1
    if node.known[p] == 0 or node.metric[p] == INFINITY or node.cost[p] == INFINITY:
        return 0
    if node.fd_known == 0:
        return 1
    return is_better(node.seq[p], node.metric[p], node.fd_seq, node.fd_metric)


def node_advertises_nothing_nearer(node, params, now):
    """A finite metric was advertised that is no part of the feasibility distance"""
    return node.said == INFINITY or node.fd_known == 1


def network_feasibility_distances_fall(nodes, count, params):
    """The feasibility distance of a next hop is not strictly better than our own"""
    for i in range(count):
        p = nodes[i].parent
        if p >= 0:
            own = nodes[i]
            hop = nodes[own.neighbour[p]]
            better = is_better(hop.fd_seq, hop.fd_metric, own.fd_seq, own.fd_metric)
            if own.fd_known and hop.fd_known and not better:
                return 0
    return 1


def network_has_no_loop(nodes, count, params):
    """Next hops form a loop"""
    for i in range(count):
        at = i
        steps = 0
        while steps <= count and nodes[at].parent >= 0:
            at = nodes[at].neighbour[nodes[at].parent]
            steps = steps + 1
        if steps > count:
            return 0
    return 1
