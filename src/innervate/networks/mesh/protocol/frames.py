"""Packets as records: copies, lengths, numbers in a payload."""

from innervate.networks.mesh.protocol.constants import (
    ACK,
    ACK_BYTES,
    ALARM,
    ALL,
    CRC_BYTES,
    DATA,
    E2E_ACK,
    GRAPH,
    HEADER_BYTES,
    PATH_MAX,
    POSITION,
    SOURCE_ROUTE,
)


def copy_frame(to, frm):
    """Copy a frame, field by field; of path and payload what is used."""
    to.kind = frm.kind
    to.flags = frm.flags
    to.link_src = frm.link_src
    to.link_dst = frm.link_dst
    to.origin = frm.origin
    to.dest = frm.dest
    to.seq = frm.seq
    to.table_ver = frm.table_ver
    to.ttl = frm.ttl
    to.path_len = frm.path_len
    to.length = frm.length
    to.rssi = frm.rssi
    for k in range(frm.path_len):
        to.path[k] = frm.path[k]
    for k in range(frm.length):
        to.body[k] = frm.body[k]


def frame_bytes(frame):
    """Bytes of a frame on the wire, without what the radio puts in front [mesh 2]."""
    if frame.kind == ACK:
        return ACK_BYTES + frame.length
    return HEADER_BYTES + frame.path_len + frame.length + CRC_BYTES


def get16(frame, at):
    """A 16-bit number of the payload."""
    return frame.body[at] << 8 | frame.body[at + 1]


def put16(body, at, value):
    """Two bytes of a payload."""
    body[at] = value >> 8 & 255
    body[at + 1] = value & 255


def signed8(value):
    """A byte as the signed number that it stands for."""
    return value - ((value & 128) << 1)


def signed16(value):
    """Two bytes as the signed number that they stand for."""
    return value - ((value & 32768) << 1)


def inner(frame):
    """Where the payload of its origin begins: behind a source route."""
    if frame.flags & SOURCE_ROUTE and frame.length > 0:
        return min(frame.length, 1 + frame.body[0])
    return 0


def is_sound(params, frame):
    """1 if the numbers in a received frame go together; what is not is dropped silently [mesh 2].

    Nodes exist, the whole fits the MTU, a source route is as long as it says, and in front of what
    is routed; a table has its route in itself.
    """
    if frame.kind == ACK:
        return 1
    if frame.origin >= params.nodes or (frame.dest >= params.nodes and frame.dest != ALL):
        return 0
    if frame.dest == ALL and frame.link_dst != ALL:
        return 0
    if frame.path_len == 0 or frame_bytes(frame) > params.mtu:
        return 0
    for k in range(frame.path_len):
        if frame.path[k] >= params.nodes:
            return 0
    if not frame.flags & SOURCE_ROUTE:
        return 1
    return is_routed(frame.kind) and is_route(params, frame)


def is_routed(kind):
    """1 for what one node sends to another by tables, the graph or a source route."""
    return kind == DATA or kind == E2E_ACK or kind == ALARM or kind == POSITION or kind == GRAPH


def is_route(params, frame):
    """1 if the payload begins with a source route over nodes that exist."""
    if frame.length == 0 or frame.body[0] >= frame.length:
        return 0
    for k in range(frame.body[0]):
        if frame.body[1 + k] >= params.nodes:
            return 0
    return 1


def in_path(frame, who):
    """1 if `who` has transmitted the packet already."""
    for k in range(frame.path_len):
        if frame.path[k] == who:
            return 1
    return 0


def is_named(frame, first, who):
    """1 if the payload has the number `who`, from byte `first` on."""
    for k in range(first, frame.length):
        if frame.body[k] == who:
            return 1
    return 0


def store(node, i, frame):
    """A received packet into place i of the queue."""
    node.q_kind[i] = frame.kind
    node.q_flags[i] = frame.flags
    node.q_link_dst[i] = frame.link_dst
    node.q_origin[i] = frame.origin
    node.q_dest[i] = frame.dest
    node.q_seq[i] = frame.seq
    node.q_ver[i] = frame.table_ver
    node.q_ttl[i] = frame.ttl
    node.q_path_len[i] = frame.path_len
    node.q_length[i] = frame.length
    for k in range(frame.path_len):
        node.q_path[i * PATH_MAX + k] = frame.path[k]
    for k in range(frame.length):
        node.q_body[i * node.q_room + k] = frame.body[k]


def load(node, i, frame):
    """Place i of the queue as the frame to be sent."""
    frame.kind = node.q_kind[i]
    frame.flags = node.q_flags[i]
    frame.link_src = node.number
    frame.link_dst = node.q_link_dst[i]
    frame.origin = node.q_origin[i]
    frame.dest = node.q_dest[i]
    frame.seq = node.q_seq[i]
    frame.table_ver = node.q_ver[i]
    frame.ttl = node.q_ttl[i]
    frame.path_len = node.q_path_len[i]
    frame.length = node.q_length[i]
    frame.rssi = 0
    for k in range(node.q_path_len[i]):
        frame.path[k] = node.q_path[i * PATH_MAX + k]
    for k in range(node.q_length[i]):
        frame.body[k] = node.q_body[i * node.q_room + k]


def add8(node, i, value):
    """A byte more to the payload of place i."""
    node.q_body[i * node.q_room + node.q_length[i]] = value & 255
    node.q_length[i] = node.q_length[i] + 1


def add16(node, i, value):
    """Two bytes more to the payload of place i."""
    add8(node, i, value >> 8)
    add8(node, i, value)


def add_hop(node, i):
    """We transmit the packet in place i: 1, or 0 if its path is full."""
    count = node.q_path_len[i]
    if count >= PATH_MAX:
        return 0
    node.q_path[i * PATH_MAX + count] = node.number
    node.q_path_len[i] = count + 1
    return 1


def was_at(node, i, who):
    """1 if the packet in place i was transmitted by `who`."""
    for k in range(node.q_path_len[i]):
        if node.q_path[i * PATH_MAX + k] == who:
            return 1
    return 0


def clear_queue(node):
    """Empty the queue: nothing waits, nothing is under way."""
    for i in range(node.places):
        node.q_state[i] = 0
    node.busy = -1
    node.ack_at = -1
    node.acks = 0
    node.woken = 0
    node.q_next = 0
