"""How long a hop's ack is waited for, by the round trips of that neighbour [RFC 6298], and how many
frames may be under way to it.

An ack does not say which transmission it is for, so retried frames tell no round trip (Karn); they
make for longer waits, until a frame that was sent once is acknowledged. Only who answers is given
more time: who is silent is found out as soon as ever.

With `hop_frames` every neighbour has frames under way of its own: one more with each ack, half as
many after a missing one.
"""

from innervate.dialect.arith import MASK30, after, sooner, time_left
from innervate.dialect.outbox import set_timer
from innervate.networks.mesh.protocol.constants import ACK_WAIT, ALARMS, ALL
from innervate.networks.mesh.protocol.neighbours import place_of

NONE = -1
NOBODY_GAVE = 255
UNACKED = 3  # in q_state
LONGEST_US = 1 << 20  # of a round trip, and of a wait
DOUBLED_MAX = 2  # a wait four times as long is longer than three transmissions took


def hop_wait(node, params, i):
    """How long to wait for the ack of the frame in place i, us."""
    if not params.ack_adapt:
        return params.ack_us
    k = place_of(node, params, node.q_link_dst[i])
    if k < 0:
        return params.ack_us
    spare = max(params.ack_us >> 1, 4 * node.hop_spread[k])
    wait = max(params.ack_us, node.hop_trip[k] + spare)
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


def is_full(node, params, i):
    """1 if the frame in place i waits until another one to its neighbour is acknowledged."""
    if not params.hop_frames or node.q_rank[i] == ALARMS or node.q_link_dst[i] == ALL:
        return 0
    k = place_of(node, params, node.q_link_dst[i])
    return k >= 0 and node.hop_under[k] >= node.hop_most[k]


def begin_wait(node, params, now, wait, i, out):
    """The frame in place i is under way; its ack is overdue after `wait` us."""
    node.q_due[i] = (now + wait) & MASK30
    k = place_of(node, params, node.q_link_dst[i])
    if k >= 0:
        node.hop_under[k] = node.hop_under[k] + 1
    if node.ack_at == NONE or not after(node.q_due[i], node.ack_at):
        node.ack_at = node.q_due[i]
        set_timer(out, ACK_WAIT, node.ack_at)


def end_wait(node, params, i):
    """The frame in place i is under way no more."""
    if params.hop_frames:
        k = place_of(node, params, node.q_link_dst[i])
        if k >= 0:
            node.hop_under[k] = max(node.hop_under[k] - 1, 0)


def overdue(node, now):
    """The place of a frame whose ack is overdue, or -1."""
    for i in range(node.places):
        if node.q_state[i] == UNACKED and after(now, node.q_due[i]):
            return i
    return NONE


def await_next(node, now, out):
    """Set the timer to when the next ack is overdue."""
    node.ack_at = NONE
    soonest = -1
    for i in range(node.places):
        if node.q_state[i] == UNACKED:
            soonest = sooner(soonest, time_left(node.q_due[i], now))
    if soonest >= 0:
        node.ack_at = (now + soonest) & MASK30
        set_timer(out, ACK_WAIT, node.ack_at)


def widen(node, params, k):
    """The neighbour in place k has acknowledged: it may have a frame more."""
    if params.hop_frames and k >= 0:
        node.hop_most[k] = min(node.hop_most[k] + 1, params.hop_frames)
        node.hop_cut[k] = NONE


def narrow(node, params, now, k, i):
    """The neighbour in place k did not acknowledge the frame in place i in time: half as many.

    0 if the frame was under way already when another went unanswered: that is the same news.
    """
    if not params.hop_frames or k < 0:
        return 1
    if node.hop_cut[k] != NONE and not after(node.q_sent[i], node.hop_cut[k]):
        return 0
    node.hop_most[k] = max(node.hop_most[k] >> 1, 1)
    node.hop_cut[k] = now
    return 1
