"""A packet goes on: its next hop is chosen, and another when that does not answer."""

from innervate.dialect.arith import MASK30
from innervate.dialect.rng import draw
from innervate.networks.mesh.protocol.backoff import is_drowned, note_missed
from innervate.networks.mesh.protocol.constants import (
    ACK_WANTED,
    ALARMS,
    ALTERNATE,
    DATA,
    END_TO_END,
    NOBODY,
    RESPONSE,
    SEARCH,
    TABLE,
    TABLE_ACK,
    TABLE_FREE,
    WEAK,
)
from innervate.networks.mesh.protocol.duplicates import clear_skipped, skip
from innervate.networks.mesh.protocol.frames import add_hop, was_at
from innervate.networks.mesh.protocol.hop import (
    await_next,
    end_wait,
    narrow,
    note_failed,
    overdue,
)
from innervate.networks.mesh.protocol.link_quality import tries_for
from innervate.networks.mesh.protocol.neighbours import (
    DOUBT,
    UNHEARD,
    is_lively,
    is_silent,
    place_of,
    suspect,
    trust,
)
from innervate.networks.mesh.protocol.queue import UNACKED, WAITS, kick, put_out, take_over
from innervate.networks.mesh.protocol.route import (
    advance_route,
    choose_hop,
    is_wanted,
    learn_failure,
    planned,
    room_of,
)
from innervate.networks.mesh.protocol.upward import best_below, is_dim, uplink

FAILURES_MAX = 6
LAST_TRIES = 4  # with anybody
TIMEOUTS = 4  # in one call: the outbox has to hold what comes of them
HOPS_MAX = 40  # failures of a routed packet at a node: every neighbour once, and some to spare


def spread(node, params, now, rank, frame, out):
    """Pass a flooded packet on once; its path stays short, so that it always fits."""
    i = take_over(node, now, rank, frame, out)
    if i >= 0:
        node.q_copies[i] = params.copies
        node.q_due[i] = (now + draw(node, params.flood_us + 1)) & MASK30
    return i


def pass_on(node, params, i, who):
    """The packet in place i goes to `who` next."""
    node.q_link_dst[i] = who
    if params.hop_acks:
        node.q_flags[i] = node.q_flags[i] | ACK_WANTED
    node.q_tries[i] = 0


def enter(node, params, i, out):
    """We are the next transmitter of the packet in place i: 0 if it is too old or too long."""
    if node.q_ttl[i] > 0 and room_of(node, params, i) > node.q_length[i] and add_hop(node, i):
        node.q_ttl[i] = node.q_ttl[i] - 1
        return 1
    put_out(node, i, out)
    return 0


def aim(node, params, i, out):
    """Choose the next hop of the routed packet in place i; 0 if there is none."""
    if node.q_dest[i] == node.gone:
        return 0
    who = choose_hop(node, params, i)
    if who == NOBODY:
        return 0
    advance_route(node, i)
    pass_on(node, params, i, who)
    return 1


def resume_search(node, params, i):
    """1 if we search on for a packet that came back: its path has us already, and room for others.

    24 nodes can be searched so, not 24 hops; dead ends cost no room.
    """
    if params.mode == TABLE_FREE or params.failover != SEARCH or node.q_ttl[i] == 0:
        return 0
    if not was_at(node, i, node.number):
        return 0
    node.q_ttl[i] = node.q_ttl[i] - 1
    return 1


def send_on(node, params, now, i, out):
    """The packet in place i, ours or taken over, goes to its recipient; 0 if it cannot."""
    if not resume_search(node, params, i):
        if not enter(node, params, i, out):
            return 0
        if is_wanted(node, params, i):
            return 1
    if not aim(node, params, i, out):
        put_out(node, i, out)
        return 0
    return 1


def send_up(node, params, now, i, out):
    """The packet in place i, ours or taken over, climbs to the gateway."""
    if enter(node, params, i, out):
        climb(node, params, now, i, out)


def climb(node, params, now, i, out):
    """Choose an uplink, else who is as near to the gateway as we; while all are suspect, wait.

    In the end anybody may know a way.
    """
    who = NOBODY
    if node.q_fails[i] <= FAILURES_MAX:
        who = uplink(node, params, i)
        if who == NOBODY:
            who = beside(node, params, i, node.depth + 1)
        if who == NOBODY:
            node.q_fails[i] = node.q_fails[i] + 1
            if node.q_fails[i] <= FAILURES_MAX:
                trust(node, params)
                clear_skipped(node, node.q_origin[i], node.q_seq[i])
                who = uplink(node, params, i)
                wait = (params.jitter_us >> 1) + draw(node, params.jitter_us + 1)
                node.q_due[i] = (now + wait) & MASK30
    if who == NOBODY and node.q_fails[i] <= FAILURES_MAX + LAST_TRIES:
        who = beside(node, params, i, UNHEARD)
    if who == NOBODY:
        put_out(node, i, out)
    else:
        pass_up(node, params, i, who)


def beside(node, params, i, depth):
    """Who is less deep than that, though it may be no uplink, for the packet in place i (0080).

    So a response goes round where all uplinks hear us worse than we hear them. Who had it is on its
    path, and is not asked. A gateway in reach of which we hear nothing may be dead: NOBODY.
    """
    if not params.retry or is_silent(node, params, node.gateway):
        return NOBODY
    return best_below(node, params, i, depth)


def pass_up(node, params, i, who):
    """The packet in place i climbs by way of `who`; it says so if we hear that too faintly.

    What comes of it is luck: a response is sent so often that it crosses nearly any link.
    """
    if is_dim(node, params, place_of(node, params, who)):
        node.q_flags[i] = node.q_flags[i] | WEAK
    pass_on(node, params, i, who)


def is_upward(kind):
    """1 for packets that climb to the gateway."""
    return kind == RESPONSE or kind == TABLE_ACK


def hop_failed(node, params, now, i, out):
    """The next hop of the packet in place i did not answer: try another."""
    failed = node.q_link_dst[i]
    kind = node.q_kind[i]
    node.q_state[i] = WAITS
    node.q_due[i] = now
    node.q_fails[i] = node.q_fails[i] + 1
    suspect(node, params, now, failed, planned(node, params, node.q_dest[i]) == failed, out)
    skip(node, node.q_origin[i], node.q_seq[i], failed)
    if is_upward(kind):
        climb(node, params, now, i, out)
    else:
        learn_failure(node, params, i, failed)
        lasts = params.retry and kind != TABLE and node.q_fails[i] <= HOPS_MAX
        if not (lasts and not is_stale(node, params, now, i) and aim(node, params, i, out)):
            put_out(node, i, out)


def is_stale(node, params, now, i):
    """1 if the message in place i waits here for so long that others need its place more.

    Queues full of what has to go to others with full queues would not move on for ever. What its
    origin sends again goes soon.
    """
    if node.q_rank[i] == ALARMS:
        return 0
    limit = max(4 * params.e2e_us, params.tick_us)
    if node.q_kind[i] == DATA and node.q_flags[i] & END_TO_END == 0:
        limit = 4 * limit
    return (now - node.q_born[i]) & MASK30 > limit


def turn_away(node, params, failed, out):
    """What else waits to go to a neighbour that does not answer goes another way, if there is one.

    Else every packet in the queue would have to find out for itself, one after the other.
    """
    if not params.retry or params.failover < ALTERNATE or params.mode == TABLE_FREE:
        return
    for i in range(node.places):
        waits = node.q_state[i] == WAITS and node.q_flags[i] & ACK_WANTED
        if waits and node.q_link_dst[i] == failed:
            if is_upward(node.q_kind[i]):
                who = uplink(node, params, i)
                if who != NOBODY:
                    pass_up(node, params, i, who)
            else:
                aim(node, params, i, out)


def most_tries(node, params, i, who):
    """How often the packet in place i is sent to the neighbour in place `who` of the table.

    Once where this one was silent since it did not answer: another may be asked, and a response
    asks the same few again and again. Tables and their acks have few to choose from.
    """
    kind = node.q_kind[i]
    if who >= 0 and node.suspect[who] & DOUBT and kind != TABLE and kind != TABLE_ACK:
        return 1
    return tries_for(node, params, who)


def on_ack_timeout(node, params, now, out):
    """The hop's ack did not come in time."""
    if params.hop_frames:
        for _ in range(TIMEOUTS):
            i = overdue(node, now)
            if i >= 0:
                end_wait(node, params, i)
                unanswered(node, params, now, i, out)
        await_next(node, now, out)
        kick(node, params, now, out)
        return
    i = node.busy
    if i < 0 or node.q_state[i] != UNACKED:
        return
    node.busy = -1
    unanswered(node, params, now, i, out)
    kick(node, params, now, out)


def unanswered(node, params, now, i, out):
    """The frame in place i was not acknowledged: once more, or another way."""
    who = place_of(node, params, node.q_link_dst[i])
    if narrow(node, params, now, who, i) and (who < 0 or is_lively(node, who)):
        note_missed(node, params, now, who)
    if node.q_tries[i] < most_tries(node, params, i, who):
        node.q_state[i] = WAITS
        node.q_due[i] = now
    else:
        failed = node.q_link_dst[i]
        if params.ack_adapt:
            note_failed(node, who, i)
        if is_drowned(node, i, who):
            put_out(node, i, out)
            return
        hop_failed(node, params, now, i, out)
        turn_away(node, params, failed, out)
