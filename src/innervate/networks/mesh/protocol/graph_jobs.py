"""The gateway floods the whole graph, and what is missing somewhere once more [mesh 2, 8.1]."""

from innervate.dialect.arith import MASK30
from innervate.networks.mesh.protocol.constants import (
    ALL,
    CONTROL,
    GIVEN_UP,
    GRAPH,
    PARTS_MAX,
    TO_SEND,
    UNDER_WAY,
)
from innervate.networks.mesh.protocol.frames import add8, add16, add_hop
from innervate.networks.mesh.protocol.paths import is_known
from innervate.networks.mesh.protocol.queue import compose
from innervate.networks.mesh.protocol.route import room_of
from innervate.networks.mesh.protocol.table import (
    CROWD,
    ends_of,
    graph_bytes,
    part_bytes,
    part_count,
    spread_of_answers,
)

TOLD = 1 << PARTS_MAX  # in job_parts, behind the bits of parts: the node has told which it has


def pump_graph(node, gate, params, now, out):
    """Flood the parts of the graph, and once more those that some node misses."""
    count = part_count(params)
    silent = 0  # who have not told what they have
    for s in range(params.nodes):
        if gate.job[s] == TO_SEND:
            gate.job[s] = GIVEN_UP
            if count <= PARTS_MAX:
                gate.job[s] = UNDER_WAY
                gate.job_count[s] = count
                gate.job_next[s] = gate.part = 0
        if gate.job[s] == UNDER_WAY and gate.job_parts[s] < TOLD:
            silent = silent + 1
    for s in range(params.nodes):
        if not silent:
            gate.job_next[s] = 0
        elif not gate.job_next[s] and silent > params.nodes >> 1:
            gate.job_parts[s] = 0  # a part was lost here, not on its way: all come again
    for s in range(params.nodes):
        if is_unasked(gate, s):
            flood_graph(node, gate, params, now, count, out)
            return


def is_unasked(gate, s):
    """1 if a flood for node s is not complete yet."""
    return gate.job[s] == UNDER_WAY and gate.job_next[s] == 0


def lacks(gate, s, bit):
    """1 if node s lacks this part; bit PARTS_MAX: if it has not told which it has."""
    return is_unasked(gate, s) and gate.job_parts[s] >> bit & 1 == 0


def is_missed(gate, params, bit):
    """1 if some node lacks this part, or has not told."""
    for s in range(params.nodes):
        if lacks(gate, s, bit):
            return 1
    return 0


def name_silent(node, gate, params, i):
    """Who has told nothing since the last flood is asked by name, as far as there is room."""
    for s in range(params.nodes):
        if lacks(gate, s, PARTS_MAX) and node.q_length[i] < room_of(node, params, i):
            add8(node, i, s)


def graph_due(params, now, count, tries):
    """When a flood of the graph is over at the latest, and its acks are in."""
    answers = spread_of_answers(params, params.nodes)
    answers = answers + (params.job_us >> 1) * (params.nodes // CROWD)
    wait = params.job_us * (1 + tries) + params.jitter_us * (count + 4) + answers
    return (now + wait) & MASK30


def flood_graph(node, gate, params, now, count, out):
    """Queue all parts that somebody misses; those who wait for them are asked no sooner.

    Where the queue has no room for all, it goes on with the others when these have left, and none
    comes sooner than the one before was passed on.
    """
    due = now
    pace = params.jitter_us
    if count <= params.queue:
        pace = pace >> 1
    i = 0
    for index in range(gate.part, count + 1):
        if is_missed(gate, params, index if index < count else PARTS_MAX):
            i = compose(node, now, CONTROL, GRAPH, ALL, 0, out)
            if i < 0:
                gate.part = index
                break
            add_hop(node, i)
            fill_graph(node, gate, params, i, index, count)
            if index == count:
                name_silent(node, gate, params, i)
            node.q_copies[i] = params.copies  # one may find the channel full of the part before
            node.q_due[i] = due & MASK30
            due = due + pace
    if i >= 0:
        gate.part = 0
    for s in range(params.nodes):
        if is_unasked(gate, s):
            if i < 0:
                gate.job_due[s] = (due + pace) & MASK30
            else:
                gate.job_next[s] = 1
                gate.job_parts[s] = TOLD - 1  # all, for all we know
                gate.job_due[s] = graph_due(params, now, count, gate.job_tries[s])


def fill_graph(node, gate, params, i, index, count):
    """Part `index` of the graph into place i; beyond the last there is nothing in it."""
    add8(node, i, node.epoch)
    add16(node, i, gate.version)
    add8(node, i, 16 * index + count)
    if index >= count:
        return
    first = index * part_bytes(params)
    last = min(graph_bytes(params), first + part_bytes(params))
    for at in range(first, last):
        byte = 0
        if at == 0:
            byte = params.nodes
        elif at <= params.nodes:
            byte = at - 1
        else:
            for bit in range(8):
                ends = ends_of(params, (at - 1 - params.nodes) * 8 + bit)
                if ends >= 0 and is_known(gate, params, ends >> 8, ends & 255):
                    byte = byte | 128 >> bit
        add8(node, i, byte)
