"""Messages that are kept until their recipient acknowledges them [mesh RELIABLE]."""

from innervate.dialect.arith import MASK16, MASK30, after, later, sooner, time_left
from innervate.dialect.outbox import report, set_timer
from innervate.networks.mesh.protocol.constants import (
    ALARM,
    ALARMS,
    ALL,
    CONTROL,
    CROSS,
    DATA,
    MESSAGES,
    NO_ACK,
    NO_ROUTE,
    ORDERED,
    OWN,
    PARITY,
    PRIORITY,
    REPORT_ACCEPTED,
    REPORT_ARRIVED,
    REPORT_EXPIRED,
    RETRY,
    TABLES,
)
from innervate.networks.mesh.protocol.duplicates import (
    UNREACHABLE,
    clear_skipped,
    is_unreachable,
    mark_bad,
)
from innervate.networks.mesh.protocol.frames import add8, get16, inner
from innervate.networks.mesh.protocol.queue import compose, drop, has_room, kick
from innervate.networks.mesh.protocol.search import BITS
from innervate.networks.mesh.protocol.send import send_on
from innervate.networks.mesh.protocol.timeout import (
    LONGEST_US,
    learn_round_trip,
    lifetime,
    timeout,
    timeout_min,
)

FREE = 0
SURE_AFTER = 2  # tries; after fewer in vain nothing is concluded
SEARCH_BACKOFF_MAX = 3
LIFETIME_TIMEOUTS = 48  # first waits: all tries of a message take 32
AHEAD_MAX = 64  # numbers: a packet older than that its recipient could not tell from one it had


def free_buffer(node):
    """A place for a message that is kept, or -1."""
    for w in range(node.kept):
        if node.wait_kind[w] == FREE:
            return w
    return -1


def buffer_sent(node, params, now, w, i, handle, out):
    """Keep the packet in place i of the queue until its recipient acknowledges it."""
    node.wait_kind[w] = node.q_kind[i]
    node.wait_seq[w] = node.q_seq[i]
    node.wait_dest[w] = node.q_dest[i]
    node.wait_flags[w] = node.q_flags[i]
    node.wait_length[w] = node.q_length[i]
    for k in range(node.q_length[i]):
        node.wait_body[w * node.wait_room + k] = node.q_body[i * node.q_room + k]
    begin_tries(node, now, w, 1, handle)
    node.wait_due[w] = (now + timeout(node, params, w)) & MASK30
    arm_retry(node, now, out)


def buffer_unsent(node, params, now, w, item, dest, flags, out):
    """Keep a message that finds no room in the queue: its first try comes soon."""
    node.seq = (node.seq + 1) & MASK16
    node.wait_kind[w] = DATA
    node.wait_seq[w] = node.seq
    node.wait_dest[w] = dest
    node.wait_flags[w] = flags
    node.wait_length[w] = item.length
    for k in range(item.length):
        node.wait_body[w * node.wait_room + k] = item.body[k]
    begin_tries(node, now, w, 0, item.handle)
    node.wait_due[w] = (now + (params.e2e_us >> 2)) & MASK30
    report(out, REPORT_ACCEPTED, item.handle, node.seq)
    arm_retry(node, now, out)


def begin_tries(node, now, w, tries, handle):
    """The message in place w is new, and was sent `tries` times."""
    node.wait_tries[w] = tries
    node.wait_hop[w] = 0
    node.wait_at[w] = now
    node.wait_sent[w] = now
    node.wait_handle[w] = handle


def is_ahead(node, dest):
    """1 if a new packet to `dest` would be too far ahead of one that is kept for it.

    Its recipient's window would move past the older one, which could then not come any more.
    """
    for w in range(node.kept):
        if node.wait_kind[w] != FREE and (node.wait_dest[w] == dest or dest == ALL):
            if (node.seq + 1 - node.wait_seq[w]) & MASK16 > AHEAD_MAX:
                return 1
    return 0


def arm_retry(node, now, out):
    """Set the RETRY timer to the first end-to-end timeout."""
    soonest = -1
    for w in range(node.kept):
        if node.wait_kind[w] != FREE:
            soonest = sooner(soonest, time_left(node.wait_due[w], now))
    if soonest >= 0:
        set_timer(out, RETRY, (now + soonest) & MASK30)


def due_retransmission(node, now):
    """A kept message whose time is over, or -1."""
    for w in range(node.kept):
        if node.wait_kind[w] != FREE and after(now, node.wait_due[w]):
            return w
    return -1


def is_behind(node, dest, seq):
    """1 if an older message to the same recipient is looking for a way: one at a time does."""
    for w in range(node.kept):
        if node.wait_kind[w] == DATA and node.wait_dest[w] == dest:
            if node.wait_tries[w] > SURE_AFTER and later(seq, node.wait_seq[w]):
                return 1
    return 0


def is_in_vain(node, dest, seq):
    """1 if no way is known to the recipient, or an older message to it is looking for one."""
    return is_unreachable(node, dest) or is_behind(node, dest, seq)


def send_buffered(node, params, now, i, owner, handle, out):
    """A packet of ours goes out; without a way, only one that is kept may come to one later."""
    node.q_owner[i] = owner
    sent = 0
    if node.q_kind[i] != ALARM and is_in_vain(node, node.q_dest[i], node.q_seq[i]):
        drop(node, params, i)
    else:
        sent = send_on(node, params, now, i, out)
    if not sent and owner < 0:
        report(out, REPORT_EXPIRED, handle, NO_ROUTE)
    kick(node, params, now, out)


def is_expired(node, params, now, w):
    """1 if the message in place w is sent no more, however often it was: its place is wanted."""
    most = lifetime(params)
    if not params.e2e_adapt:
        most = min(most, LIFETIME_TIMEOUTS * min(params.e2e_us, LONGEST_US // LIFETIME_TIMEOUTS))
    return (now - node.wait_at[w]) & MASK30 > most


def crowds(node, dest):
    """1 if so many messages wait for a way to this recipient that another would leave no place."""
    if not is_in_vain(node, dest, (node.seq + 1) & MASK16):
        return 0
    count = 0
    for w in range(node.kept):
        if node.wait_kind[w] == DATA and node.wait_dest[w] == dest:
            count = count + 1
    return count >= node.kept >> 1


def is_queued(node, seq):
    """1 if a copy of a message of ours has not left us yet: another would only be in its way.

    Where several are under way, one that is late can make a node take a new one for it.
    """
    for i in range(node.places):
        if node.q_state[i] != FREE and node.q_seq[i] == seq and node.q_kind[i] == DATA:
            if node.q_origin[i] == node.number:
                return 1
    return 0


def retransmit(node, params, now, w, out):
    """Send a kept message once more, or give it up: 1 if it was sent."""
    if node.wait_tries[w] > params.e2e_tries or is_expired(node, params, now, w):
        report(out, REPORT_EXPIRED, node.wait_handle[w], NO_ACK)
        pass_over(node, w, get_before(node, w), now)
        if node.wait_kind[w] == DATA and node.wait_tries[w] > SURE_AFTER:
            mark_bad(node, UNREACHABLE, node.wait_dest[w])
            node.search_backoff = min(node.search_backoff + 1, SEARCH_BACKOFF_MAX)
        node.wait_kind[w] = FREE
        return 0
    if node.wait_kind[w] == DATA and is_behind(node, node.wait_dest[w], node.wait_seq[w]):
        node.wait_due[w] = (now + timeout(node, params, w)) & MASK30
        return 0
    if node.wait_kind[w] == DATA and (is_queued(node, node.wait_seq[w]) or not has_room(node, OWN)):
        node.wait_due[w] = (now + timeout_min(node, params)) & MASK30
        return 0
    node.wait_tries[w] = node.wait_tries[w] + 1
    node.wait_sent[w] = now
    node.wait_flags[w] = node.wait_flags[w] ^ PARITY
    node.wait_due[w] = (now + timeout(node, params, w)) & MASK30
    clear_skipped(node, node.number, node.wait_seq[w])
    rank = CONTROL if node.wait_flags[w] & PRIORITY else MESSAGES
    if node.wait_kind[w] == ALARM:
        rank = ALARMS
    i = compose_kept(node, now, rank, w, out)
    if i >= 0:
        send_buffered(node, params, now, i, w, node.wait_handle[w], out)
    return 1


def compose_kept(node, now, rank, w, out):
    """The message kept in place w as a packet, under the number that it has; -1 if no place."""
    i = compose(node, now, rank, node.wait_kind[w], node.wait_dest[w], node.wait_flags[w], out)
    if i >= 0:
        node.seq = (node.seq - 1) & MASK16
        node.q_seq[i] = node.wait_seq[w]
        for k in range(node.wait_length[w]):
            add8(node, i, node.wait_body[w * node.wait_room + k])
    return i


def get_before(node, w):
    """The number of the message before the ORDERED one in place w; its own = there is none."""
    return node.wait_body[w * node.wait_room] << 8 | node.wait_body[w * node.wait_room + 1]


def pass_over(node, w, before, due):
    """The message in place w has its end: who was to come after it comes after `before` now.

    `before` = its own number: none is left. Who may have waited for it at their recipient was
    tried in vain: it has its tries again, from `due` on; -1 = it came, and nobody had to wait.
    """
    seq = node.wait_seq[w]
    if node.wait_kind[w] != DATA or node.wait_flags[w] & ORDERED == 0:
        return
    for v in range(node.kept):
        if v != w and node.wait_kind[v] == DATA and node.wait_dest[v] == node.wait_dest[w]:
            if node.wait_flags[v] & ORDERED and get_before(node, v) == seq:
                found = node.wait_seq[v] if before == seq else before
                node.wait_body[v * node.wait_room] = found >> 8
                node.wait_body[v * node.wait_room + 1] = found & 255
                if due >= 0:
                    node.wait_tries[v] = min(node.wait_tries[v], 1)
                    node.wait_due[v] = due


def on_end_ack(node, params, frame, now, out):
    """The recipient has our message."""
    at = inner(frame)
    if frame.length < at + 2:
        return
    count = 1
    if params.mode == TABLES:
        count = (frame.length - at) >> 1
    for n in range(count):
        note_arrived(node, params, now, frame.origin, get16(frame, at + 2 * n), out)
    advance_retries(node, params, now, frame.origin, out)


def note_arrived(node, params, now, who, seq, out):
    """`who` has our packet of that number, and so knows us as we are since we switched on.

    An ack that answers nothing of ours may be for who we were before: it says no such thing.
    """
    byte = who // BITS
    for w in range(node.kept):
        if node.wait_kind[w] != FREE and node.wait_seq[w] == seq:
            if node.wait_dest[w] == who or node.wait_kind[w] == ALARM:
                node.met[byte] = node.met[byte] | 1 << (who % BITS)
                learn_round_trip(node, params, w, now)
                if is_own_crossing(node, w):
                    node.heard_out = 1
                report(out, REPORT_ARRIVED, node.wait_handle[w], node.wait_seq[w])
                pass_over(node, w, node.wait_seq[w], -1)
                node.wait_kind[w] = FREE


def advance_retries(node, params, now, dest, out):
    """`dest` is there: what was tried in vain is sent again as soon as its ack is overdue.

    Who acknowledges much would else use up all tries before the first of them can arrive.
    """
    pause = timeout_min(node, params)
    for w in range(node.kept):
        if node.wait_kind[w] == DATA and node.wait_dest[w] == dest and node.wait_tries[w] > 1:
            due = (node.wait_sent[w] + pause) & MASK30
            if after(now, due):
                due = now
            if after(node.wait_due[w], due):
                node.wait_due[w] = due
    arm_retry(node, now, out)


def is_own_crossing(node, w):
    """1 if the message kept in place w is our alarm that we are outside ourselves."""
    body = w * node.wait_room
    if node.wait_kind[w] != ALARM or node.wait_body[body] != node.number:
        return 0
    return node.wait_body[body + 3] == CROSS
