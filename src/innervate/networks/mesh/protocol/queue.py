"""Frames that wait, and those under way; alarms go before control, control before data."""

from innervate.dialect.arith import MASK16, MASK30, after, sooner, time_left
from innervate.dialect.outbox import URGENT, report, send, set_timer
from innervate.dialect.rng import draw
from innervate.networks.mesh.protocol.backoff import NO_BACKOFF, end_backoff, is_held, note_answer
from innervate.networks.mesh.protocol.constants import (
    ACK,
    ACK_MORE_BYTES,
    ACK_WAIT,
    ACK_WANTED,
    ALARM,
    ALARMS,
    ALL,
    CONTROL,
    DETOURED,
    END_TO_END,
    MESSAGES,
    REPORT_DROPPED,
    REPORT_HOP,
    TTL,
    TX,
)
from innervate.networks.mesh.protocol.fields import GATHERED
from innervate.networks.mesh.protocol.frames import load, put16, store
from innervate.networks.mesh.protocol.hop import (
    NOBODY_GAVE,
    begin_wait,
    end_wait,
    hop_wait,
    is_full,
)
from innervate.networks.mesh.protocol.neighbours import ask

FREE = 0
WAITS = 1
DOWN = 2
UNACKED = 3

NO_OWNER = -1


def free_places(node):
    """How many more frames fit."""
    count = 0
    for i in range(node.places):
        if node.q_state[i] == FREE:
            count = count + 1
    return count


def has_room(node, rank):
    """1 if a frame of this rank may still be taken over: the last places are for better ones.

    An alarm may take the place of a frame that is less urgent and not under way.
    """
    if free_places(node) > rank:
        return 1
    if rank == ALARMS:
        for i in range(node.places):
            if node.q_state[i] == WAITS and node.q_rank[i] > ALARMS:
                return 1
    return 0


def make_room(node, rank, out):
    """As has_room; what looks for a way, and will be sent again, makes room for what knows its."""
    if has_room(node, rank):
        return 1
    newest = -1
    for i in range(node.places):
        if is_searching(node, i):
            if newest < 0 or came_after(node, i, newest):
                newest = i
    if newest < 0 or free_places(node) < rank:
        return 0
    put_out(node, newest, out)
    return 1


def put_out(node, i, out):
    """The frame that waits in place i has to go, and what it brings does not arrive by it."""
    report(out, REPORT_DROPPED, node.q_origin[i], node.q_seq[i])
    node.q_state[i] = FREE


def came_after(node, i, j):
    """1 if the frame in place i came after that in place j."""
    return (node.q_order[i] - node.q_order[j]) & MASK30 < MASK30 >> 1


def is_searching(node, i):
    """1 if a message waits in place i that looks for a way, and its origin sends it again."""
    if node.q_state[i] != WAITS or node.q_rank[i] != MESSAGES:
        return 0
    return node.q_flags[i] & DETOURED and node.q_flags[i] & END_TO_END


def spare_places(node):
    """How many more frames fit where what looks for a way, and will be sent again, makes room."""
    count = free_places(node)
    for i in range(node.places):
        if is_searching(node, i):
            count = count + 1
    return count


def take_place(node, rank, out):
    """A place for a frame, or -1. Alarms and control put out the newest of what is less urgent."""
    worst = -1
    for i in range(node.places):
        if node.q_state[i] == FREE:
            return i
        if node.q_state[i] == WAITS and node.q_rank[i] > rank:
            if worst < 0 or is_before(node, worst, i):
                worst = i
    if rank > CONTROL or worst < 0:
        return -1
    put_out(node, worst, out)
    return worst


def enqueue(node, now, rank, giver, out):
    """A place in the queue, due at once, as yet without frame; -1 if there is none."""
    i = take_place(node, rank, out)
    if i >= 0:
        node.q_state[i] = WAITS
        node.q_rank[i] = rank
        node.q_order[i] = node.q_next
        node.q_next = (node.q_next + 1) & MASK30
        node.q_due[i] = now
        node.q_born[i] = now
        node.q_tries[i] = 0
        node.q_fails[i] = 0
        node.q_copies[i] = 1
        node.q_from[i] = giver
        node.q_owner[i] = NO_OWNER
    return i


def compose(node, now, rank, kind, dest, flags, out):
    """A packet of our own, empty, its path still to be begun; -1 if there is no place."""
    i = enqueue(node, now, rank, NOBODY_GAVE, out)
    if i >= 0:
        node.seq = (node.seq + 1) & MASK16
        node.q_kind[i] = kind
        node.q_flags[i] = flags
        node.q_link_dst[i] = ALL
        node.q_origin[i] = node.number
        node.q_dest[i] = dest
        node.q_seq[i] = node.seq
        node.q_ver[i] = node.version & 255
        node.q_ttl[i] = TTL
        node.q_path_len[i] = 0
        node.q_length[i] = 0
    return i


def take_over(node, now, rank, frame, out):
    """A received packet that is to go on; -1 if there is no place."""
    i = enqueue(node, now, rank, frame.link_src, out)
    if i >= 0:
        store(node, i, frame)
    return i


def drop(node, params, i):
    """Forget the frame in place i."""
    if node.q_state[i] == UNACKED:
        end_wait(node, params, i)
    node.q_state[i] = FREE
    if node.busy == i:
        node.busy = -1


def close(node, params, i):
    """The hop of the frame in place i has it: forget it.

    One that waits for its backoff below goes out once more, as what nobody acknowledges.
    """
    if node.q_state[i] == DOWN:
        node.q_link_dst[i] = ALL
    else:
        drop(node, params, i)


def is_before(node, i, j):
    """1 if the frame in place i goes before that in place j.

    Of alarms the flooded ones go first: they take one transmission, whoever is dead, and need not
    wait until a hop has failed three times and the next three times more.
    """
    if node.q_rank[i] != node.q_rank[j]:
        return node.q_rank[i] < node.q_rank[j]
    if node.q_rank[i] == ALARMS and (node.q_link_dst[i] == ALL) != (node.q_link_dst[j] == ALL):
        return node.q_link_dst[i] == ALL
    return came_after(node, j, i)


def pick_due(node, params, now):
    """Which frame goes next, or -1."""
    best = -1
    end_backoff(node, now)
    for i in range(node.places):
        if node.pause != NO_BACKOFF and is_held(node, i):
            continue
        if node.q_state[i] == WAITS and after(now, node.q_due[i]):
            if best < 0 or is_before(node, i, best):
                if not is_full(node, params, i):
                    best = i
    return best


def wake(node, params, now, out):
    """Nothing is due, or may go: come back when something is; an ack calls what waits for it."""
    soonest = -1
    for i in range(node.places):
        if node.q_state[i] == WAITS and not is_full(node, params, i):
            wait = time_left(node.q_due[i], now)
            if node.pause != NO_BACKOFF and is_held(node, i):
                wait = max(wait, (node.pause - now) & MASK30)
            soonest = sooner(soonest, wait)
    if soonest >= 0:
        set_timer(out, TX, (now + soonest) & MASK30)


def note_sent(node, now, i):
    """The frame in place i has left, perhaps not for the first time."""
    node.q_sent[i] = now
    if node.q_tries[i] == 1:
        node.q_begun[i] = now


def settle(node, params, now, sent, out):
    """The frame under way has left, or could not (sent = 0)."""
    i = node.busy
    if node.q_link_dst[i] == ALL:
        node.busy = -1
        node.q_copies[i] = node.q_copies[i] - 1
        if node.q_copies[i] > 0:
            span = params.jitter_us
            if node.q_kind[i] == ALARM:
                span = params.flood_us
            node.q_state[i] = WAITS
            node.q_due[i] = (now + draw(node, span + 1)) & MASK30
        else:
            node.q_state[i] = FREE
    elif node.q_flags[i] & ACK_WANTED or not sent:
        node.q_state[i] = UNACKED
        if node.q_tries[i] == 0:
            ask(node, params, node.q_link_dst[i])
        node.q_tries[i] = node.q_tries[i] + 1
        wait = 0
        if sent:
            wait = hop_wait(node, params, i)
            if params.ack_adapt or params.hop_frames:
                note_sent(node, now, i)
        if params.hop_frames:
            node.busy = -1
            begin_wait(node, params, now, wait, i, out)
            return
        set_timer(out, ACK_WAIT, (now + wait) & MASK30)
    else:
        node.q_state[i] = FREE
        node.busy = -1
        tell_hop(node, i, out)


def kick(node, params, now, out):
    """Send what is due; with `gather` as soon as all that has come was handled."""
    if not params.gather:
        send_due(node, params, now, out)
    elif not node.woken:
        node.woken = 1
        set_timer(out, TX, now)


def send_all(node, params, now, out):
    """The acks that we owe, then what is due."""
    node.woken = 0
    send_acks(node, out)
    send_due(node, params, now, out)


def send_due(node, params, now, out):
    """Send what is due, if nothing is under way that it would wait for."""
    for _ in range(node.places + 1):
        if node.busy != -1:
            return
        i = pick_due(node, params, now)
        if i < 0:
            wake(node, params, now, out)
            return
        node.busy = i
        node.q_state[i] = DOWN
        load(node, i, out.frame[send(out, 0, attempt(node, params, i), 0)])
        if not params.told:
            settle(node, params, now, 1, out)


def attempt(node, params, i):
    """How much the frame in place i yields to others' frames: as after so many attempts.

    Packets that look for a way yield to those that know theirs. What a poor link takes more (see
    link_quality.py) says nothing of a full channel.
    """
    tries = min(node.q_tries[i], params.transmissions - 1)
    if node.q_flags[i] & DETOURED and node.q_rank[i] == MESSAGES:
        return tries + 2
    return tries


def take_sent(node, params, now, sent, out):
    """The layer below says that the frame has left."""
    if node.busy >= 0 and node.q_state[node.busy] == DOWN:
        settle(node, params, now, sent, out)
        kick(node, params, now, out)


def acknowledge(node, params, frame, out):
    """Send the hop's ack for a received frame at once [mesh 1]; with `gather` they go together."""
    if not params.gather:
        send_ack(node, frame.link_src, frame.origin, frame.seq, frame.rssi, out)
        return
    if node.acks == GATHERED:
        send_acks(node, out)
    a = node.acks
    node.acks = a + 1
    node.ack_to[a] = frame.link_src
    node.ack_origin[a] = frame.origin
    node.ack_seq[a] = frame.seq
    node.ack_rssi[a] = frame.rssi


def send_ack(node, to, origin, seq, rssi, out):
    """An ack of one packet to the hop that it came from; where it stands in the outbox."""
    at = send(out, 0, 0, URGENT)
    ack = out.frame[at]
    ack.kind = ACK
    ack.link_src = node.number
    ack.link_dst = ack.dest = to
    ack.origin = origin
    ack.seq = seq
    ack.rssi = rssi
    ack.flags = ack.table_ver = ack.ttl = ack.path_len = ack.length = 0
    return at


def send_acks(node, out):
    """All acks that we owe: a frame to each neighbour, its first packet as in a single ack."""
    for a in range(node.acks):
        to = node.ack_to[a]
        if to != ALL:
            at = send_ack(node, to, node.ack_origin[a], node.ack_seq[a], node.ack_rssi[a], out)
            ack = out.frame[at]
            for b in range(a + 1, node.acks):
                if node.ack_to[b] == to:
                    ack.body[ack.length] = node.ack_origin[b]
                    put16(ack.body, ack.length + 1, node.ack_seq[b])
                    ack.length = ack.length + ACK_MORE_BYTES
                    node.ack_to[b] = ALL
    node.acks = 0


def take_ack(node, params, origin, seq, who, k):
    """The place of the frame that `who`, in place k, acknowledges so: free now; -1 if for none."""
    for i in range(node.places):
        if node.q_state[i] >= DOWN and node.q_seq[i] == seq and node.q_origin[i] == origin:
            if node.q_link_dst[i] == who:
                note_answer(node, params, k)
                close(node, params, i)
                return i
    return -1


def tell_hop(node, i, out):
    """The owner of a message hears, once, that its first hop has it."""
    owner = node.q_owner[i]
    if owner == NO_OWNER or node.wait_hop[owner]:
        return
    if node.wait_kind[owner] and node.wait_seq[owner] == node.q_seq[i]:
        node.wait_hop[owner] = 1
        report(out, REPORT_HOP, node.wait_handle[owner], 0)
