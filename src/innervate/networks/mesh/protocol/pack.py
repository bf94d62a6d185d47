"""Routing tables as bytes: groups of recipients with one next hop and alternate [mesh 2]."""

from innervate.networks.mesh.protocol.constants import CRC_BYTES, HEADER_BYTES
from innervate.networks.mesh.protocol.frames import add8
from innervate.networks.mesh.protocol.paths import NONE, hops, list_neighbours
from innervate.networks.mesh.protocol.table import GROUP_BYTES, PART_HEAD


def depth_of(node, gate, params, s):
    """Hops from the gateway to node s, 255 if there is no way."""
    return hops(gate, params, node.number, s)


def room_at(node, gate, params, s):
    """Bytes of groups that a part for node s can hold: path and route have to fit, too."""
    far = depth_of(node, gate, params, s)
    return params.mtu - HEADER_BYTES - CRC_BYTES - far - (far + 2) - PART_HEAD


def pack(node, gate, params, s, room, wanted, i):
    """Divide the table in gate.next and gate.alt into parts of `room` bytes: how many.

    Part `wanted` is appended to the payload in place i.
    """
    degree = list_neighbours(gate, params, s)
    part = 0
    used = 0
    for k in range(degree):
        main = gate.neighbours[k]
        for side in range(degree + 1):
            alt = NONE
            if side < degree:
                alt = gate.neighbours[side]
            count = 0  # of the group that is being written
            start = 0
            for d in range(params.nodes):
                if gate.next[d] == main and gate.alt[d] == alt:
                    if count == 0 or used + 1 > room or count == 255:
                        if used + GROUP_BYTES + 1 > room:
                            part = part + 1
                            used = 0
                        count = 0
                        used = used + GROUP_BYTES
                        if part == wanted:
                            add8(node, i, main)
                            add8(node, i, alt)
                            start = node.q_length[i]
                            add8(node, i, 0)
                    count = count + 1
                    used = used + 1
                    if part == wanted:
                        add8(node, i, d)
                        set_count(node, i, start, count)
    return part + 1


def set_count(node, i, at, count):
    """The group that begins its recipients behind byte `at` has so many."""
    node.q_body[i * node.q_room + at] = count
