"""Towards the gateway without tables: over those who advertised less depth [mesh 4 UPWARD].

Where none of these hears us, `send.climb` asks for others (decision 0080).
"""

from innervate.networks.mesh.protocol.constants import NOBODY
from innervate.networks.mesh.protocol.duplicates import is_skipped
from innervate.networks.mesh.protocol.frames import was_at
from innervate.networks.mesh.protocol.neighbours import FREE, SUSPECT, UNHEARD

NONE = 255
FAINT_DB = 2  # below what is reported: half of what crosses such a link is lost


def is_weak(node, params, k):
    """1 if the request of the neighbour in place k came in too faint to rely on."""
    return node.round_rssi[k] < params.min_rssi


def is_dim(node, params, k):
    """1 if it came in so faint that what crosses the link by luck makes no link (0052)."""
    return node.round_rssi[k] < params.min_rssi - FAINT_DB


def is_better(node, params, a, b):
    """1 if the uplink in place a is better than that in place b: strong, near, loud."""
    weak_a = is_weak(node, params, a)
    weak_b = is_weak(node, params, b)
    if weak_a != weak_b:
        return weak_b
    if node.round_depth[a] != node.round_depth[b]:
        return node.round_depth[a] < node.round_depth[b]
    return node.round_rssi[a] > node.round_rssi[b]


def is_nearer(node, k, depth):
    """1 if the neighbour in place k advertised less than this depth in this round."""
    if node.neighbour[k] == FREE or node.round_depth[k] == UNHEARD:
        return 0
    return node.round_depth[k] < depth


def is_untried(node, i, who):
    """1 if the packet in place i was not at `who`, nor failed there, whatever we suspect."""
    if who == NONE or was_at(node, i, who):
        return 0
    return not is_skipped(node, node.q_origin[i], node.q_seq[i], who)


def uplink(node, params, i):
    """The best uplink for the packet in place i that neither had it nor failed, or NOBODY.

    Depths go down on the way, but for those of nodes that were switched on anew in this round.
    """
    return best_below(node, params, i, node.depth)


def best_below(node, params, i, depth):
    """The best of who advertised less than this depth that neither had it nor failed, or NOBODY."""
    best = -1
    for k in range(params.places):
        if is_nearer(node, k, depth) and not node.suspect[k] & SUSPECT:
            who = node.neighbour[k]
            if is_untried(node, i, who):
                if params.faint <= params.min_rssi and who == node.parent:
                    return who
                if best < 0 or is_better(node, params, k, best):
                    best = k
    if best < 0:
        return NOBODY
    return node.neighbour[best]
