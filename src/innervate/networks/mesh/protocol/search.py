"""Forwarding over the whole graph [mesh 8.1]: shortest paths computed where the packet is.

Packets carry the nodes that failed on their way: the payload ends with them, then their number.
"""

from innervate.networks.mesh.protocol.constants import DETOURED
from innervate.networks.mesh.protocol.frames import add8, was_at
from innervate.networks.mesh.protocol.neighbours import is_suspect

FAR = 255
BITS = 8  # of a byte of a row


def is_edge(node, params, a, b):
    """1 if the graph has a link a-b."""
    return node.edges[a * params.row + b // BITS] >> (b % BITS) & 1


def set_edge(node, params, a, b, there):
    """The graph has a link a-b, or not."""
    set_half(node, params, a, b, there)
    set_half(node, params, b, a, there)


def set_half(node, params, a, b, there):
    """In the row of node a."""
    at = a * params.row + b // BITS
    bit = 1 << (b % BITS)
    node.edges[at] = node.edges[at] | bit if there else node.edges[at] & ~bit


def failed_count(node, i):
    """How many failed nodes the packet in place i carries."""
    if node.q_flags[i] & DETOURED == 0 or node.q_length[i] == 0:
        return 0
    count = node.q_body[i * node.q_room + node.q_length[i] - 1]
    return min(count, node.q_length[i] - 1)


def has_failed(node, i, who):
    """1 if the packet in place i says that `who` failed."""
    count = failed_count(node, i)
    first = i * node.q_room + node.q_length[i] - 1 - count
    for k in range(count):
        if node.q_body[first + k] == who:
            return 1
    return 0


def add_failed(node, i, who, room):
    """`who` failed for the packet in place i; 0 if there is no room to say so."""
    if has_failed(node, i, who):
        return 1
    if node.q_length[i] + 2 > room:
        return 0
    count = failed_count(node, i)
    if node.q_flags[i] & DETOURED and node.q_length[i] > 0:
        node.q_length[i] = node.q_length[i] - 1
    node.q_flags[i] = node.q_flags[i] | DETOURED
    add8(node, i, who)
    add8(node, i, count + 1)
    return 1


def begin_line(far, line, count, first):
    """Of `count` nodes the first alone stands in line, 0 hops away; how many stand there."""
    for k in range(count):
        far[k] = FAR
    far[first] = 0
    line[0] = first
    return 1


def measure_distances(node, params, i, dest, here, anew):
    """Hops from everyone to `dest`, around `here` and whoever failed for the packet in place i.

    With `anew` around whoever had the packet, too.
    """
    last = begin_line(node.far, node.line, params.nodes, dest)
    for at in range(params.nodes):
        if at >= last:
            return
        a = node.line[at]
        if a == here:
            continue
        for byte in range(params.row):
            bits = node.edges[a * params.row + byte]
            if bits:
                for b in range(BITS):
                    c = byte * BITS + b
                    if bits >> b & 1 and c < params.nodes and node.far[c] == FAR:
                        if not has_failed(node, i, c) and not (anew and was_at(node, i, c)):
                            node.far[c] = node.far[a] + 1
                            node.line[last] = c
                            last = last + 1


def find_nearest(node, params, i, dest, anew):
    """The neighbour with the shortest way to `dest` for the packet in place i, or 255.

    Where the recipient itself did not answer us, somebody else may reach it.
    """
    me = node.number
    measure_distances(node, params, i, dest, me, anew)
    best = 255
    for c in range(params.nodes):
        if node.far[c] != FAR and c != me and is_edge(node, params, me, c):
            if c == dest and (has_failed(node, i, c) or is_suspect(node, params, c)):
                continue
            if best == 255 or node.far[c] < node.far[best]:
                best = c
    return best


def find_hop(node, params, i, dest, room, anew):
    """Where the packet in place i goes on a shortest path, or 255.

    Whoever would be next but does not answer is added to the failed that the packet carries.
    """
    for _ in range(params.places + 1):
        who = find_nearest(node, params, i, dest, anew)
        if who == 255 or not is_suspect(node, params, who):
            return who
        if not add_failed(node, i, who, room):
            return 255
    return 255
