"""How long a hop's ack is waited for, by the round trips of that neighbour [RFC 6298].

An ack does not say which transmission it is for, so retried frames tell no round trip (Karn); they
make for longer waits, until a frame that was sent once is acknowledged. Only who answers is given
more time: who is silent is found out as soon as ever.
"""

from innervate.dialect.arith import MASK30
from innervate.networks.mesh.protocol.neighbours import place_of

NONE = -1
LONGEST_US = 1 << 20  # of a round trip, and of a wait
DOUBLED_MAX = 2  # a wait four times as long is longer than three transmissions took


def hop_wait(node, params, i):
    """How long to wait for the ack of the frame in place i, us."""
    if not params.ack_adapt:
        return params.ack_us
    k = place_of(node, params, node.q_link_dst[i])
    if k < 0:
        return params.ack_us
    wait = node.hop_trip[k] + max(params.ack_us, 4 * node.hop_spread[k])
    return min(min(wait, LONGEST_US) << node.hop_doubled[k], max(LONGEST_US, params.ack_us))


def note_trip(node, k, took):
    """A round trip to the neighbour in place k took so long."""
    if node.hop_trip[k] == 0:
        node.hop_trip[k] = took
        node.hop_spread[k] = took >> 1
    else:
        off = abs(took - node.hop_trip[k])
        node.hop_spread[k] = (3 * node.hop_spread[k] + off) >> 2
        node.hop_trip[k] = (7 * node.hop_trip[k] + took) >> 3
    node.hop_doubled[k] = 0
    node.hop_failed[k] = NONE


def learn_trip(node, now, i, k):
    """The neighbour in place k has acknowledged the frame in place i."""
    if k < 0:
        return
    if node.q_tries[i] > 1:
        node.hop_doubled[k] = min(node.hop_doubled[k] + 1, DOUBLED_MAX)
    else:
        note_trip(node, k, min(max((now - node.q_sent[i]) & MASK30, 1), LONGEST_US))


def note_failed(node, k, i):
    """The neighbour in place k did not acknowledge the frame in place i in time, or never will."""
    if k >= 0 and node.hop_failed[k] == NONE:
        node.hop_failed[k] = node.q_begun[i]


def learn_late(node, now, k):
    """An ack of the neighbour in place k for what we no longer wait for.

    If nothing else came since, it took longer than all transmissions of the frame that we gave up.
    """
    if k < 0 or node.hop_failed[k] == NONE:
        return
    took = (now - node.hop_failed[k]) & MASK30
    node.hop_failed[k] = NONE
    if node.hop_trip[k] < took <= LONGEST_US:
        node.hop_trip[k] = took
        node.hop_spread[k] = max(node.hop_spread[k], took >> 2)
        node.hop_doubled[k] = 0
