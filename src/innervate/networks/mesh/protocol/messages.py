"""send_message and receive_messages: receipts, end-to-end acks and retries [mesh 1, RELIABLE]."""

from innervate.dialect.outbox import deliver, report
from innervate.networks.mesh.protocol.constants import (
    AGAIN,
    ALARM,
    ALARMS,
    ALL,
    CONTROL,
    CRC_BYTES,
    DATA,
    DETOURED,
    E2E_ACK,
    END_TO_END,
    FIRST,
    FLOOD,
    HEADER_BYTES,
    MESSAGES,
    MONITOR,
    NO_ROOM,
    NO_ROUTE,
    ORDERED,
    OWN,
    PATH_MAX,
    PRIORITY,
    REPORT_ACCEPTED,
    REPORT_FULL,
    TABLES,
)
from innervate.networks.mesh.protocol.duplicates import accept, mark_reachable
from innervate.networks.mesh.protocol.frames import add8, add16, add_hop, copy_frame, inner
from innervate.networks.mesh.protocol.queue import WAITS, compose, kick, make_room
from innervate.networks.mesh.protocol.retransmission import (
    buffer_sent,
    buffer_unsent,
    crowds,
    free_buffer,
    is_ahead,
    on_end_ack,
    send_buffered,
)
from innervate.networks.mesh.protocol.route import learn_way
from innervate.networks.mesh.protocol.search import BITS
from innervate.networks.mesh.protocol.send import send_on

END_ACKS_BYTES = 24  # of one frame: as many as fit at the smallest MTU


def resolve(node, params, dest):
    """Who an address stands for; 255 if nobody yet."""
    if dest != MONITOR:
        return dest
    if params.monitor != MONITOR:
        return params.monitor
    return node.gateway


def payload_limit(params):
    """Most bytes of a message [mesh 1]."""
    return params.mtu - HEADER_BYTES - CRC_BYTES - PATH_MAX


def first_flag(node, params, dest):
    """FIRST until `dest` has acknowledged something since we switched on: a lost one is no use."""
    if dest >= params.nodes or node.met[dest // BITS] >> (dest % BITS) & 1:
        return 0
    return FIRST


def on_message(node, params, now, item, out):
    """Send a message: never waits; what becomes of it is reported by its handle."""
    dest = resolve(node, params, item.dest)
    nobody = dest >= params.nodes and (dest != ALL or item.dest == MONITOR)
    if item.length > payload_limit(params) or nobody:
        report(out, REPORT_FULL, item.handle, NO_ROUTE)
        return
    flags = item.flags & (PRIORITY | ORDERED)
    if params.reliable:
        flags = item.flags & (END_TO_END | PRIORITY | ORDERED)
    if dest == node.number:
        hand_up_own(node, item, out)
        return
    if is_ahead(node, dest):
        report(out, REPORT_FULL, item.handle, NO_ROOM)
        return
    owner = -1
    if flags & END_TO_END and dest != ALL:
        owner = free_buffer(node)
        if owner < 0 or crowds(node, dest):
            report(out, REPORT_FULL, item.handle, NO_ROOM)
            return
    i = -1
    if flags & PRIORITY:
        i = compose(node, now, CONTROL, DATA, dest, flags, out)
    elif make_room(node, OWN if owner >= 0 else MESSAGES, out):
        i = compose(node, now, MESSAGES, DATA, dest, flags, out)
    if i < 0 and owner >= 0:
        buffer_unsent(
            node, params, now, owner, item, dest, flags | first_flag(node, params, dest), out
        )
        return
    if i < 0:
        report(out, REPORT_FULL, item.handle, NO_ROOM)
        return
    node.q_flags[i] = node.q_flags[i] | first_flag(node, params, dest)
    for k in range(item.length):
        add8(node, i, item.body[k])
    report(out, REPORT_ACCEPTED, item.handle, node.seq)
    if dest == ALL:
        flood_own(node, params, now, i, out)
        return
    if owner >= 0:
        buffer_sent(node, params, now, owner, i, item.handle, out)
    send_buffered(node, params, now, i, owner, item.handle, out)


def hand_up_own(node, item, out):
    """Deliver a message to ourselves at once; its number is its handle."""
    frame = out.frame[deliver(out, DATA)]
    head_own(node, frame, DATA, item.handle, item.length)
    for k in range(item.length):
        frame.body[k] = item.body[k]


def head_own(node, frame, kind, seq, length):
    """The header of a packet of ours for ourselves, which has no way to go."""
    frame.kind = kind
    frame.link_src = frame.link_dst = frame.origin = frame.dest = node.number
    frame.seq = seq
    frame.length = length
    frame.flags = frame.table_ver = frame.ttl = frame.path_len = frame.rssi = 0


def flood_own(node, params, now, i, out):
    """A message to all: every node passes it on once."""
    node.q_flags[i] = node.q_flags[i] | FLOOD
    node.q_copies[i] = params.copies
    add_hop(node, i)
    kick(node, params, now, out)


def waiting_ack(node, params, to, rank, flags):
    """Where an end-to-end ack to the same origin waits that has room for a number more, or -1."""
    if not params.gather or params.mode != TABLES:
        return -1
    for i in range(node.places):
        if node.q_state[i] == WAITS and node.q_kind[i] == E2E_ACK and node.q_dest[i] == to:
            if node.q_origin[i] == node.number and node.q_rank[i] == rank and node.q_tries[i] == 0:
                if (node.q_flags[i] ^ flags) & FIRST == 0 and node.q_length[i] < END_ACKS_BYTES:
                    return i
    return -1


def acknowledge_end(node, params, now, frame, out):
    """Tell the origin that its message is here."""
    if frame.flags & END_TO_END == 0 or frame.origin == node.number:
        return
    rank = ALARMS if frame.kind == ALARM else CONTROL
    tell_origin(node, params, now, rank, frame.origin, frame.seq, out)


def tell_origin(node, params, now, rank, origin, seq, out):
    """Acknowledge packet `seq` of a node, end to end."""
    flags = first_flag(node, params, origin)
    i = waiting_ack(node, params, origin, rank, flags)
    if i >= 0:
        add16(node, i, seq)
        return
    i = compose(node, now, rank, E2E_ACK, origin, flags, out)
    if i >= 0:
        add16(node, i, seq)
        send_on(node, params, now, i, out)


def on_handed_up(node, params, now, item, out):
    """The user has a message that waited for those before it."""
    if item.dest < params.nodes and item.dest != node.number:
        tell_origin(node, params, now, CONTROL, item.dest, item.handle, out)
        kick(node, params, now, out)


def is_ordered(frame):
    """1 if the user says when a message is to be acknowledged: when it was its turn."""
    return frame.kind == DATA and frame.flags & ORDERED and frame.dest != ALL


def hand_up(params, frame, kind, out):
    """Deliver a packet: its payload without what forwarding has put into it."""
    up = out.frame[deliver(out, kind)]
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
    """A packet for us: deliver it once, acknowledge it always; in order: when its turn was.

    An end-to-end ack may come twice, but does not move the window: else acks would shut out
    messages that are still tried.
    """
    first = frame.flags & FIRST
    mark_reachable(node, frame.origin)
    learn_way(node, params, frame)
    if frame.kind == E2E_ACK:
        on_end_ack(node, params, frame, now, out)
        return
    if accept(node, params, frame.origin, frame.seq, first):
        hand_up(params, frame, frame.kind, out)
        if not is_ordered(frame):
            acknowledge_end(node, params, now, frame, out)
    elif is_within(node, frame.origin, frame.seq):
        if is_ordered(frame):
            hand_up(params, frame, AGAIN, out)
        else:
            acknowledge_end(node, params, now, frame, out)


def is_within(node, origin, seq):
    """1 if the window tells that this packet was delivered; of older ones nothing is known."""
    return ((node.newest[origin] - seq) & 65_535) <= 64
