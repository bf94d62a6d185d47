"""Packets that wait to be sent: a ring."""

from innervate.networks.rpl.protocol import kinds, sizes
from innervate.networks.rpl.protocol.constants import NOBODY, NONE


def new_place(node):
    """A place behind all packets, blank; -1 if there is none."""
    if node.q_count == sizes.QUEUE:
        return NONE
    i = (node.q_first + node.q_count) % sizes.QUEUE
    node.q_count += 1
    node.q_kind[i] = kinds.DATA
    node.q_origin[i] = node.number
    node.q_dest[i] = node.number
    node.q_from[i] = NOBODY
    node.q_hops[i] = node.q_down[i] = node.q_error[i] = node.q_back[i] = 0
    node.q_info[i] = node.q_path[i] = node.q_length[i] = node.q_next[i] = node.q_made[i] = 0
    for j in range(sizes.ROUTE):
        node.q_route[i * sizes.ROUTE + j] = 0
    for j in range(sizes.BODY):
        node.q_body[i * sizes.BODY + j] = 0
    return i


def drop_first(node):
    """The first packet is done with."""
    node.q_first = (node.q_first + 1) % sizes.QUEUE
    node.q_count -= 1
    node.rounds = 0


def base_of(kind):
    """A kind of frame without what a source route adds."""
    if kind >= kinds.DAO_ACK and kind < kinds.DAO_ACK + 3:
        return kinds.DAO_ACK
    return kinds.DATA if kind >= kinds.DATA and kind < kinds.DATA + 3 else kind


def keep(node, i, frame):
    """Write a frame that was received into a place."""
    node.q_kind[i] = base_of(frame.kind)
    node.q_origin[i] = frame.origin
    node.q_dest[i] = frame.dest
    node.q_from[i] = frame.src
    node.q_hops[i] = frame.hops - 1
    node.q_down[i] = frame.down
    node.q_error[i] = frame.error
    node.q_made[i] = frame.made_at
    if frame.kind > kinds.DAO_ACK + 2:
        node.q_info[i] = frame.info
    if frame.kind == kinds.DAO_UP or node.q_kind[i] == kinds.DAO_ACK:
        node.q_path[i] = frame.path
    if frame.kind != node.q_kind[i]:
        node.q_length[i] = frame.length
        node.q_next[i] = frame.next
        for j in range(min(frame.length, sizes.NEAR)):
            node.q_route[i * sizes.ROUTE + j] = frame.near[j]
        for j in range(sizes.NEAR, frame.length):
            node.q_route[i * sizes.ROUTE + j] = frame.far[j - sizes.NEAR]
    if node.q_kind[i] == kinds.DATA:
        for j in range(sizes.BODY):
            node.q_body[i * sizes.BODY + j] = frame.body[j]


def clean(frame):
    """A frame of which nothing is said yet."""
    frame.kind = frame.to = frame.src = frame.dsn = frame.rssi = frame.made_at = 0
    frame.version = frame.rank = frame.dtsn = frame.mop = frame.life = frame.path = 0
    frame.origin = frame.dest = frame.hops = frame.sender_rank = frame.info = 0
    frame.down = frame.error = frame.back = frame.length = frame.next = 0
    for i in range(sizes.TARGETS):
        frame.targets[i] = frame.paths[i] = 0
    for i in range(sizes.NEAR):
        frame.near[i] = 0
    for i in range(sizes.ROUTE - sizes.NEAR):
        frame.far[i] = 0
    for i in range(sizes.BODY):
        frame.body[i] = 0


def fill(node, i, frame):
    """Make a frame of the packet in a place; whoever sends it adds the hop's fields."""
    length = node.q_length[i]
    frame.kind = node.q_kind[i]
    if length > 0:
        frame.kind += 1 if length <= sizes.NEAR else 2
    frame.origin = node.q_origin[i]
    frame.dest = node.q_dest[i]
    frame.hops = node.q_hops[i]
    frame.down = node.q_down[i]
    frame.error = node.q_error[i]
    frame.back = node.q_back[i]
    frame.info = node.q_info[i]
    frame.path = node.q_path[i]
    frame.made_at = node.q_made[i]
    frame.length = length
    frame.next = node.q_next[i]
    for j in range(sizes.NEAR):
        frame.near[j] = node.q_route[i * sizes.ROUTE + j]
    for j in range(sizes.NEAR, sizes.ROUTE):
        frame.far[j - sizes.NEAR] = node.q_route[i * sizes.ROUTE + j]
    for j in range(sizes.BODY):
        frame.body[j] = node.q_body[i * sizes.BODY + j]
