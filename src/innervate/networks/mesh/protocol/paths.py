"""The gateway's arithmetic: links, distances, next hops, alternates, tables as bytes [mesh 4].

Dijkstra's algorithm over hop counts is a breadth-first search; among equals the lowest id wins.
"""

from innervate.dialect.arith import MASK30
from innervate.dialect.rng import LOW15
from innervate.networks.mesh.protocol.constants import LIST, TABLE_FREE
from innervate.networks.mesh.protocol.search import BITS, begin_line

FAR = 255
NONE = 255
ROUNDS_VALID = 3
LOW_BITS = 85  # of each of four pairs of bits


def note_heard(gate, params, who, by):
    """`by` heard `who` in this round."""
    at = who * params.width + by
    gate.heard[at >> 2] = gate.heard[at >> 2] | ROUNDS_VALID << 2 * (at & 3)


def forget_heard(gate, params, who, by):
    """It counts no more that `by` heard `who`."""
    at = who * params.width + by
    gate.heard[at >> 2] = gate.heard[at >> 2] & ~(ROUNDS_VALID << 2 * (at & 3))


def is_heard(gate, params, who, by):
    """1 if `by` heard `who` in one of the last rounds."""
    at = who * params.width + by
    return gate.heard[at >> 2] >> 2 * (at & 3) & 3 != 0


def is_fresh(gate, params, who, by):
    """1 if `by` heard `who` in this round; of one node: it has responded."""
    at = who * params.width + by
    return gate.heard[at >> 2] >> 2 * (at & 3) & 3 == ROUNDS_VALID


def pair_bytes(params):
    """Bytes of all pairs, of two bits each: for how many rounds it counts that one was heard."""
    return (params.width * params.width + 3) >> 2


def begin_round(gate, params):
    """What was heard counts for one round less: 3 becomes 2, 2 becomes 1, 1 becomes 0."""
    for k in range(pair_bytes(params)):
        high = gate.heard[k] >> 1 & LOW_BITS
        low = gate.heard[k] & LOW_BITS
        gate.heard[k] = (high & low) << 1 | high & ~low


def is_link(gate, params, a, b):
    """1 if packets can go between a and b, both ways."""
    there = is_heard(gate, params, a, b)
    back = is_heard(gate, params, b, a)
    if params.mode == TABLE_FREE:
        return there or back
    return there and back


def is_known(gate, params, a, b):
    """1 if the newest graph has the link a-b."""
    return gate.known[a * params.row + b // BITS] >> (b % BITS) & 1


def build_graph(gate, params):
    """Links from reports; how many, and a mark that tells graphs apart in gate.sum_a."""
    links = 0
    mark = 1
    gate.neighbours_of = NONE
    for k in range(params.width * params.row):
        gate.known[k] = 0
    for a in range(params.nodes):
        degree = 0
        for b in range(params.nodes):
            if a != b and is_link(gate, params, a, b) and degree < params.places:
                at = a * params.row + b // BITS
                gate.known[at] = gate.known[at] | 1 << (b % BITS)
                degree = degree + 1
                if a < b:
                    links = links + 1
                mark = fold(mark, a * 256 + b)
    gate.links = links
    return mark


def fold(mark, value):
    """A mark of a sequence of numbers, below 2^30."""
    x = (mark ^ value) & MASK30
    low = (x & LOW15) * 25_173 + 13_849  # in two halves: a product of both would not stay small
    high = ((x >> 15) * 25_173) & LOW15
    x = (low + (high << 15)) & MASK30
    return x ^ (x >> 13)


def list_neighbours(gate, params, a):
    """Neighbours of node a into gate.neighbours, lowest first, if they are not there; how many."""
    if gate.neighbours_of != a:
        gate.neighbours_of = a
        gate.neighbour_count = 0
        for byte in range(params.row):
            bits = gate.known[a * params.row + byte]
            b = byte * BITS
            while bits:
                if bits & 1:
                    gate.neighbours[gate.neighbour_count] = b
                    gate.neighbour_count = gate.neighbour_count + 1
                bits = bits >> 1
                b = b + 1
    return gate.neighbour_count


def measure(gate, params, source, without):
    """Hops from `source` to everyone into gate.far, not through `without` (255: all may be)."""
    last = begin_line(gate.far, gate.line, params.nodes, source)
    for at in range(params.nodes):
        if at >= last:
            return
        a = gate.line[at]
        for k in range(list_neighbours(gate, params, a)):
            b = gate.neighbours[k]
            if gate.far[b] == FAR and b != without:
                gate.far[b] = gate.far[a] + 1
                gate.line[last] = b
                last = last + 1


def measure_all(gate, params):
    """Hops from everyone to everyone."""
    for a in range(params.nodes):
        measure(gate, params, a, NONE)
        for b in range(params.nodes):
            gate.dist[a * params.width + b] = gate.far[b]


def hops(gate, params, a, b):
    """Hops from a to b, 255 if there is no way."""
    return gate.dist[a * params.width + b]


def first_hop(gate, params, s, d, pick):
    """A first hop of a shortest path from s to d: of several the pick-th, from the lowest id on."""
    degree = list_neighbours(gate, params, s)
    count = 0
    for k in range(degree):
        if hops(gate, params, gate.neighbours[k], d) + 1 == hops(gate, params, s, d):
            count = count + 1
    if count == 0:
        return NONE
    left = pick % count
    for k in range(degree):
        who = gate.neighbours[k]
        if hops(gate, params, who, d) + 1 == hops(gate, params, s, d):
            if left == 0:
                return who
            left = left - 1
    return NONE


def alternate_of(gate, params, s, d, main):
    """A neighbour of s that leads to d without coming back [RFC 5286], around `main` if it can.

    None such: NONE; `around` may find the first hop of a longer way then.
    """
    best = NONE
    best_protects = 0
    for k in range(list_neighbours(gate, params, s)):
        who = gate.neighbours[k]
        far = hops(gate, params, who, d)
        if (
            who != main
            and far != FAR
            and far < hops(gate, params, who, s) + hops(gate, params, s, d)
        ):
            through = hops(gate, params, who, main) + hops(gate, params, main, d)
            protects = main == d or far < through
            if best == NONE or protects > best_protects:
                best = who
                best_protects = protects
            elif protects == best_protects and far < hops(gate, params, best, d):
                best = who
    return best


def fill_around(gate, params, s, main):
    """For recipients without alternate: first hops of the shortest paths that avoid `main`.

    Safe only because packets carry their path.
    """
    measured = 0
    for d in range(params.nodes):
        if gate.next[d] == main and gate.alt[d] == NONE and d != main:
            if not measured:
                measure(gate, params, s, main)
                measured = 1
            if gate.far[d] != FAR:
                gate.alt[d] = walk_back(gate, params, s, d, main)


def walk_back(gate, params, s, d, without):
    """The neighbour of s through which the path of gate.far leads to d."""
    at = d
    for _ in range(params.nodes):
        if gate.far[at] == 1:
            return at
        nearer = NONE
        for k in range(list_neighbours(gate, params, at)):
            who = gate.neighbours[k]
            if nearer == NONE and who != without and gate.far[who] + 1 == gate.far[at]:
                nearer = who
        if nearer == NONE:
            return NONE
        at = nearer
    return NONE


def make_table(gate, params, s):
    """Next hops and alternates of node s into gate.next and gate.alt."""
    for d in range(params.nodes):
        gate.next[d] = NONE
        gate.alt[d] = NONE
        if d != s and hops(gate, params, s, d) != FAR:
            gate.next[d] = first_hop(gate, params, s, d, 0)
            gate.alt[d] = alternate_of(gate, params, s, d, gate.next[d])
    for main in range(params.nodes):
        if is_known(gate, params, s, main):
            fill_around(gate, params, s, main)


def mark_table(gate, params, start):
    """A mark that tells tables apart; two with different starts make a pair that does."""
    mark = start
    for d in range(params.nodes):
        mark = fold(mark, gate.next[d] * 256 + gate.alt[d])
    return mark


def note_path(gate, params, frame, me):
    """What a packet that climbed with acknowledgements proves: links both ways."""
    b = me
    for k in range(frame.path_len):
        a = frame.path[frame.path_len - 1 - k]
        note_heard(gate, params, a, b)
        note_heard(gate, params, b, a)
        b = a


def note_list(gate, params, frame, at):
    """The neighbours that a response lists, from byte `at` on."""
    for k in range((frame.length - at) >> 1):
        who = frame.body[at + 2 * k]
        if who < params.nodes:
            note_heard(gate, params, who, frame.origin)


def trusts_lists(params):
    """1 if responses list who was heard; else only the path that they took counts."""
    return params.discovery == LIST
