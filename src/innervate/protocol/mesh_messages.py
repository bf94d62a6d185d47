"""send_message and receive_messages: receipts, end-to-end acks and retries [mesh 1, RELIABLE]."""

from innervate.protocol.arith import MASK30, after
from innervate.protocol.mesh_fields import WAITING
from innervate.protocol.mesh_frames import add8, add16, add_hop, copy_frame, get16, inner
from innervate.protocol.mesh_queue import (
    ALARMS,
    CONTROL,
    MESSAGES,
    compose,
    kick,
)
from innervate.protocol.mesh_search import BITS
from innervate.protocol.mesh_seen import accept, unskip
from innervate.protocol.mesh_send import send_on
from innervate.protocol.mesh_words import (
    ALARM,
    ALL,
    BODY,
    CRC_BYTES,
    CROSS,
    DATA,
    DATA_MAX,
    DETOURED,
    E2E_ACK,
    END_TO_END,
    FIRST,
    FLOOD,
    HEADER_BYTES,
    MONITOR,
    NO_ACK,
    NO_ROOM,
    NO_ROUTE,
    PARITY,
    PATH_MAX,
    PRIORITY,
    REPORT_ACCEPTED,
    REPORT_ARRIVED,
    REPORT_EXPIRED,
    REPORT_FULL,
    RETRY,
    TABLES,
)
from innervate.protocol.outbox import deliver, report, set_timer

FREE = 0
LONGEST_US = 1 << 22


def resolve(node, params, dest):
    """Who an address stands for; 255 if nobody yet."""
    if dest != MONITOR:
        return dest
    if params.monitor != MONITOR:
        return params.monitor
    return node.gateway


def payload_limit(params):
    """Most bytes of a message [mesh 1]."""
    return min(DATA_MAX, params.mtu - HEADER_BYTES - CRC_BYTES - PATH_MAX)


def first_flag(node, dest):
    """FIRST until `dest` has acknowledged something since we switched on: a lost one is no use."""
    if dest >= ALL or node.met[dest // BITS] >> (dest % BITS) & 1:
        return 0
    return FIRST


def on_message(node, params, now, item, out):
    """Send a message: never waits; what becomes of it is reported by its handle."""
    dest = resolve(node, params, item.dest)
    if item.length > payload_limit(params) or (dest != ALL and dest >= params.nodes):
        report(out, REPORT_FULL, item.handle, NO_ROUTE)
        return
    flags = item.flags & PRIORITY
    if params.reliable:
        flags = item.flags & (END_TO_END | PRIORITY)
    if dest == node.number:
        hand_up_own(node, item, out)
        return
    owner = -1
    if flags & END_TO_END and dest != ALL:
        owner = free_wait(node)
        if owner < 0:
            report(out, REPORT_FULL, item.handle, NO_ROOM)
            return
    i = compose(node, now, MESSAGES if not flags & PRIORITY else CONTROL, DATA, dest, flags, out)
    if i < 0:
        report(out, REPORT_FULL, item.handle, NO_ROOM)
        return
    node.q_flags[i] = node.q_flags[i] | first_flag(node, dest)
    for k in range(item.length):
        add8(node, i, item.body[k])
    report(out, REPORT_ACCEPTED, item.handle, node.seq)
    if dest == ALL:
        flood_own(node, params, now, i, out)
        return
    if owner >= 0:
        keep(node, params, now, owner, i, item.handle, out)
    launch(node, params, now, i, owner, item.handle, out)


def hand_up_own(node, item, out):
    """A message to ourselves."""
    frame = out.frame[deliver(out, DATA)]
    frame.kind = DATA
    frame.flags = 0
    frame.link_src = node.number
    frame.link_dst = node.number
    frame.origin = node.number
    frame.dest = node.number
    frame.seq = item.handle
    frame.table_ver = 0
    frame.ttl = 0
    frame.path_len = 0
    frame.length = item.length
    frame.rssi = 0
    for k in range(item.length):
        frame.body[k] = item.body[k]


def flood_own(node, params, now, i, out):
    """A message to all: every node passes it on once."""
    node.q_flags[i] = node.q_flags[i] | FLOOD
    node.q_copies[i] = params.copies
    add_hop(node, i)
    kick(node, params, now, out)


def launch(node, params, now, i, owner, handle, out):
    """A packet of ours goes out; without a way, only one that is kept may come to one later."""
    node.q_owner[i] = owner
    if not send_on(node, params, now, i, out) and owner < 0:
        report(out, REPORT_EXPIRED, handle, NO_ROUTE)
    kick(node, params, now, out)


def free_wait(node):
    """A place for a message that is kept, or -1."""
    for w in range(WAITING):
        if node.wait_kind[w] == FREE:
            return w
    return -1


def keep(node, params, now, w, i, handle, out):
    """Keep the packet in place i of the queue until its recipient acknowledges it."""
    node.wait_kind[w] = node.q_kind[i]
    node.wait_seq[w] = node.q_seq[i]
    node.wait_dest[w] = node.q_dest[i]
    node.wait_flags[w] = node.q_flags[i]
    node.wait_tries[w] = 1
    node.wait_hop[w] = 0
    node.wait_at[w] = now
    node.wait_due[w] = (now + timeout(node, params)) & MASK30
    node.wait_handle[w] = handle
    node.wait_length[w] = node.q_length[i]
    for k in range(node.q_length[i]):
        node.wait_body[w * DATA_MAX + k] = node.q_body[i * BODY + k]
    wait_on(node, now, out)


def timeout(node, params):
    """How long to wait for an end-to-end ack, us."""
    if params.e2e_adapt:
        return max(params.e2e_us, 4 * node.round_trip)
    return params.e2e_us


def later_timeout(node, params, tries):
    """The same after so many sendings: where it adapts it doubles, so that retries of many
    messages at once do not keep a loaded network loaded.
    """
    wait = timeout(node, params)
    if params.e2e_adapt:
        for _ in range(1, tries):
            wait = min(2 * wait, LONGEST_US)
    return wait


def wait_on(node, now, out):
    """Set the RETRY timer to the first end-to-end timeout."""
    soonest = -1
    for w in range(WAITING):
        if node.wait_kind[w] != FREE:
            wait = (node.wait_due[w] - now) & MASK30
            if wait > MASK30 >> 1:
                wait = 0
            if soonest < 0 or wait < soonest:
                soonest = wait
    if soonest >= 0:
        set_timer(out, RETRY, (now + soonest) & MASK30)


def due_wait(node, now):
    """A kept message whose time is over, or -1."""
    for w in range(WAITING):
        if node.wait_kind[w] != FREE and after(now, node.wait_due[w]):
            return w
    return -1


def try_again(node, params, now, w, out):
    """Send a kept message once more, or give it up: 1 if it was sent."""
    if node.wait_tries[w] > params.e2e_tries:
        report(out, REPORT_EXPIRED, node.wait_handle[w], NO_ACK)
        node.wait_kind[w] = FREE
        return 0
    node.wait_tries[w] = node.wait_tries[w] + 1
    node.wait_flags[w] = node.wait_flags[w] ^ PARITY
    node.wait_due[w] = (now + later_timeout(node, params, node.wait_tries[w])) & MASK30
    unskip(node, node.number, node.wait_seq[w])
    rank = CONTROL if node.wait_flags[w] & PRIORITY else MESSAGES
    if node.wait_kind[w] == ALARM:
        rank = ALARMS
    i = compose(node, now, rank, node.wait_kind[w], node.wait_dest[w], node.wait_flags[w], out)
    if i >= 0:
        node.seq = (node.seq - 1) & 65_535  # it keeps its number
        node.q_seq[i] = node.wait_seq[w]
        for k in range(node.wait_length[w]):
            add8(node, i, node.wait_body[w * DATA_MAX + k])
        launch(node, params, now, i, w, node.wait_handle[w], out)
    return 1


def on_end_ack(node, params, frame, now, out):
    """The recipient has our message."""
    at = inner(frame)
    if frame.length < at + 2:
        return
    word = frame.origin // BITS
    node.met[word] = node.met[word] | 1 << (frame.origin % BITS)
    for w in range(WAITING):
        if node.wait_kind[w] != FREE and node.wait_seq[w] == get16(frame, at):
            if node.wait_dest[w] == frame.origin or node.wait_kind[w] == ALARM:
                took = (now - node.wait_at[w]) & MASK30
                # Of a retried message this is too much rather than too little: the ack may be
                # for any of its sendings, and times out of reach of the first would never count.
                if took < 16_777_216 and (node.wait_tries[w] == 1 or params.e2e_adapt):
                    if node.round_trip == 0:
                        node.round_trip = took
                    else:
                        node.round_trip = (7 * node.round_trip + took) >> 3
                if is_own_crossing(node, w):
                    node.heard_out = 1
                report(out, REPORT_ARRIVED, node.wait_handle[w], node.wait_seq[w])
                node.wait_kind[w] = FREE


def is_own_crossing(node, w):
    """1 if the message kept in place w is our alarm that we are outside ourselves."""
    body = w * DATA_MAX
    if node.wait_kind[w] != ALARM or node.wait_body[body] != node.number:
        return 0
    return node.wait_body[body + 3] == CROSS


def acknowledge_end(node, params, now, frame, out):
    """Tell the origin that its message is here."""
    if frame.flags & END_TO_END == 0 or frame.origin == node.number:
        return
    rank = ALARMS if frame.kind == ALARM else CONTROL
    flags = first_flag(node, frame.origin)
    i = compose(node, now, rank, E2E_ACK, frame.origin, flags, out)
    if i >= 0:
        add16(node, i, frame.seq)
        send_on(node, params, now, i, out)


def hand_up(params, frame, out):
    """Deliver a packet: its payload without what forwarding has put into it."""
    up = out.frame[deliver(out, frame.kind)]
    copy_frame(up, frame)
    if params.mode == TABLES:
        return
    route = inner(up)
    for k in range(up.length - route):
        up.body[k] = up.body[k + route]
    up.length = up.length - route
    if up.flags & DETOURED and up.length > 0:
        up.length = max(0, up.length - 1 - up.body[up.length - 1])


def take(node, params, now, frame, out):
    """A packet for us: deliver it once, acknowledge it always."""
    first = frame.flags & FIRST
    if frame.kind == E2E_ACK:
        if accept(node, params, frame.origin, frame.seq, first):
            on_end_ack(node, params, frame, now, out)
        return
    if accept(node, params, frame.origin, frame.seq, first):
        hand_up(params, frame, out)
        acknowledge_end(node, params, now, frame, out)
    elif is_within(node, frame.origin, frame.seq):
        acknowledge_end(node, params, now, frame, out)


def is_within(node, origin, seq):
    """1 if the window tells that this packet was delivered; of older ones nothing is known."""
    return ((node.newest[origin] - seq) & 65_535) <= 64
