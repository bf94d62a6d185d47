"""The gateway hands out what it computed: tables to each node, or the graph to all [mesh 4]."""

from innervate.protocol.arith import MASK30, after
from innervate.protocol.mesh_fields import NEIGHBOURS
from innervate.protocol.mesh_frames import add8, add16, add_hop, get16
from innervate.protocol.mesh_near import is_suspect
from innervate.protocol.mesh_paths import (
    FAR,
    NONE,
    first_hop,
    hops,
    is_known,
    make_table,
    mark_table,
)
from innervate.protocol.mesh_queue import CONTROL, compose, drop, free_places, kick
from innervate.protocol.mesh_search import set_edge
from innervate.protocol.mesh_send import pass_on
from innervate.protocol.mesh_table import (
    GROUP_BYTES,
    PART_HEAD,
    all_parts,
    graph_bytes,
    in_force,
    part_bytes,
)
from innervate.protocol.mesh_words import (
    ACTIVATE,
    ALL,
    BODY,
    CRC_BYTES,
    GRAPH,
    HEADER_BYTES,
    JOBS,
    PATH_MAX,
    REPORT_TABLES,
    TABLE,
    TABLES,
    WHOLE_GRAPH,
)
from innervate.protocol.outbox import report, set_timer

CURRENT = 0
TO_SEND = 1
UNDER_WAY = 2
GIVEN_UP = 3
PARTS_MAX = 15
PLACES_KEPT = 3  # of the queue, for what others send through us


def install_own(node, gate, params, out):
    """The gateway's own table, or graph."""
    if params.mode != TABLES:
        for a in range(params.nodes):
            for b in range(a + 1, params.nodes):
                set_edge(node, params, a, b, is_known(gate, params, a, b))
    else:
        make_table(gate, params, node.number)
        node.bank = 1 - node.bank
        for d in range(params.nodes):
            node.next[node.bank * params.width + d] = gate.next[d]
            node.alt[node.bank * params.width + d] = gate.alt[d]
    in_force(node, node.epoch, gate.version, out)
    if not params.activation:
        node.active = gate.version


def give_jobs(node, gate, params, changed, out):
    """Who needs something new: a changed table, or one that was given up before."""
    for s in range(params.nodes):
        if s == node.number or hops(gate, params, node.number, s) == FAR:
            gate.job[s] = CURRENT
        elif changed or gate.job[s] == GIVEN_UP:
            give_job(gate, params, s)
            if gate.job[s] == TO_SEND:
                gate.open = 1


def miss_table(gate, s):
    """Node s says that it has no table, perhaps any more: it was switched off."""
    if gate.job[s] == CURRENT:
        gate.mark_a[s] = 0
        gate.mark_b[s] = 0
        gate.job[s] = GIVEN_UP


def give_job(gate, params, s):
    """Node s needs its table, unless it has acknowledged the same."""
    if params.mode == WHOLE_GRAPH:
        a = gate.version
        b = gate.sum_a
    else:
        make_table(gate, params, s)
        a = mark_table(gate, params, 1)
        b = mark_table(gate, params, 2)
    if a == gate.mark_a[s] and b == gate.mark_b[s]:
        gate.job[s] = CURRENT
        return
    gate.job_a[s] = a
    gate.job_b[s] = b
    gate.job[s] = TO_SEND
    gate.job_tries[s] = 0
    gate.job_parts[s] = 0


def depth_of(node, gate, params, s):
    """Hops to s."""
    return hops(gate, params, node.number, s)


def next_job(node, gate, params):
    """The nearest node that waits for its table, or -1."""
    best = -1
    for s in range(params.nodes):
        if gate.job[s] == TO_SEND:
            if best < 0 or depth_of(node, gate, params, s) < depth_of(node, gate, params, best):
                best = s
    return best


def count_jobs(gate, params, state):
    """How many nodes' jobs are in this state."""
    count = 0
    for s in range(params.nodes):
        if gate.job[s] == state:
            count = count + 1
    return count


def pump(node, gate, params, now, out):
    """Start as many jobs as may be under way, queue their parts, and wait for acks."""
    if params.mode == WHOLE_GRAPH:
        pump_graph(node, gate, params, now, out)
    else:
        for _ in range(params.jobs):
            s = next_job(node, gate, params)
            if s >= 0 and count_jobs(gate, params, UNDER_WAY) < params.jobs:
                start_job(node, gate, params, now, s)
        for s in range(params.nodes):
            if gate.job[s] == UNDER_WAY:
                queue_parts(node, gate, params, now, s, out)
    kick(node, params, now, out)
    if gate.open and not count_jobs(gate, params, UNDER_WAY):
        if not count_jobs(gate, params, TO_SEND):
            finish(node, gate, params, now, out)
    wait_for_acks(gate, params, now, out)


def room_at(node, gate, params, s):
    """Bytes of groups that a part for node s can hold: path and route have to fit, too."""
    far = depth_of(node, gate, params, s)
    return params.mtu - HEADER_BYTES - CRC_BYTES - far - (far + 2) - PART_HEAD


def start_job(node, gate, params, now, s):
    """Node s is next; its table is divided into parts."""
    make_table(gate, params, s)
    room = room_at(node, gate, params, s)
    count = pack(node, gate, params, s, room, -1, -1)
    gate.job_next[s] = 0
    gate.job_count[s] = min(count, PARTS_MAX)
    gate.job[s] = UNDER_WAY
    if count > PARTS_MAX or room <= GROUP_BYTES or depth_of(node, gate, params, s) > PATH_MAX:
        gate.job[s] = GIVEN_UP
    gate.job_due[s] = job_due(node, gate, params, now, s)


def job_due(node, gate, params, now, s):
    """When the parts for s are sent again: later at every try, and the more there is to do."""
    load = 8 + gate.job_count[s] * depth_of(node, gate, params, s)
    wait = params.job_us * (1 + gate.job_tries[s]) // 8 * load
    return (now + wait) & MASK30


def queue_parts(node, gate, params, now, s, out):
    """Queue those parts for node s that are still missing there, as far as there is room."""
    for _ in range(PARTS_MAX):
        index = gate.job_next[s]
        if index >= gate.job_count[s]:
            return
        if gate.job_parts[s] >> index & 1 == 0:
            if free_places(node) <= PLACES_KEPT:
                return
            queue_part(node, gate, params, now, s, index, out)
            gate.job_due[s] = job_due(node, gate, params, now, s)
        gate.job_next[s] = index + 1


def queue_part(node, gate, params, now, s, index, out):
    """One part of the table of s, with its route [mesh 2 ROUTE_TABLE]."""
    i = compose(node, now, CONTROL, TABLE, s, 0, out)
    if i < 0:
        return
    far = depth_of(node, gate, params, s)
    add8(node, i, far + 1)
    at = node.number
    add8(node, i, at)
    first = NONE
    for hop in range(far):
        at = route_step(node, gate, params, at, s, hop)
        add8(node, i, at)
        if hop == 0:
            first = at
    add8(node, i, node.epoch)
    add16(node, i, gate.version)
    add8(node, i, index << 4 | gate.job_count[s])
    make_table(gate, params, s)
    pack(node, gate, params, s, room_at(node, gate, params, s), index, i)
    if first == NONE:
        drop(node, i)
        return
    add_hop(node, i)
    pass_on(node, params, i, first)


def route_step(node, gate, params, at, s, hop):
    """The next node on the way to s: another shortest path at every try, around suspects."""
    pick = gate.job_tries[s]
    who = first_hop(gate, params, at, s, pick)
    if hop == 0:
        for more in range(4):
            if is_suspect(node, params, who):
                who = first_hop(gate, params, at, s, pick + more + 1)
    return who


def pack(node, gate, params, s, room, wanted, i):
    """Divide the table in gate.next and gate.alt into parts of `room` bytes: how many.

    Part `wanted` is appended to the payload in place i.
    """
    part = 0
    used = 0
    for k in range(gate.degree[s]):
        main = gate.list[s * NEIGHBOURS + k]
        for side in range(gate.degree[s] + 1):
            alt = NONE
            if side < gate.degree[s]:
                alt = gate.list[s * NEIGHBOURS + side]
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
    node.q_body[i * BODY + at] = count


def on_ack(node, gate, params, now, frame, out):
    """A node says which parts it has."""
    s = frame.origin
    if frame.length < 5 or frame.body[0] != node.epoch or s >= params.nodes:
        return
    if get16(frame, 1) != gate.version or gate.job[s] == CURRENT:
        return
    gate.job_parts[s] = gate.job_parts[s] | get16(frame, 3)
    if gate.job_count[s] and gate.job_parts[s] & all_parts(gate.job_count[s]) == all_parts(
        gate.job_count[s]
    ):
        gate.job[s] = CURRENT
        gate.mark_a[s] = gate.job_a[s]
        gate.mark_b[s] = gate.job_b[s]
    elif gate.job[s] == UNDER_WAY:
        gate.job_next[s] = 0
    pump(node, gate, params, now, out)


def retry_jobs(node, gate, params, now, out):
    """The JOBS timer: what was not acknowledged in time is sent again, or given up."""
    for s in range(params.nodes):
        if gate.job[s] == UNDER_WAY and after(now, gate.job_due[s]):
            gate.job_tries[s] = gate.job_tries[s] + 1
            gate.job_next[s] = 0
            gate.job_due[s] = job_due(node, gate, params, now, s)
            if gate.job_tries[s] > params.job_tries:
                gate.job[s] = GIVEN_UP
    pump(node, gate, params, now, out)


def wait_for_acks(gate, params, now, out):
    """Set the JOBS timer to the first deadline."""
    soonest = -1
    for s in range(params.nodes):
        if gate.job[s] == UNDER_WAY:
            wait = (gate.job_due[s] - now) & MASK30
            if wait > MASK30 >> 1:
                wait = 0
            if soonest < 0 or wait < soonest:
                soonest = wait
    if soonest >= 0:
        set_timer(out, JOBS, (now + soonest) & MASK30)


def finish(node, gate, params, now, out):
    """Nothing of this version is under way any more."""
    gate.open = 0
    report(out, REPORT_TABLES, gate.version, count_jobs(gate, params, GIVEN_UP))
    if params.activation:
        node.active = gate.version
        i = compose(node, now, CONTROL, ACTIVATE, ALL, 0, out)
        if i >= 0:
            add_hop(node, i)
            add8(node, i, node.epoch)
            add16(node, i, gate.version)
            node.q_copies[i] = params.copies
        kick(node, params, now, out)


def pump_graph(node, gate, params, now, out):
    """Flood the parts of the graph, and once more those that some node misses."""
    count = (graph_bytes(params) + part_bytes(params) - 1) // part_bytes(params)
    fresh = 0
    for s in range(params.nodes):
        if gate.job[s] == TO_SEND:
            gate.job[s] = UNDER_WAY if count <= PARTS_MAX else GIVEN_UP
            gate.job_count[s] = min(count, PARTS_MAX)
            gate.job_next[s] = 0
            gate.job_due[s] = graph_due(params, now, count, 0)
            fresh = 1
    if fresh:
        gate.part = 0
    again = 0
    for s in range(params.nodes):
        if gate.job[s] == UNDER_WAY and gate.job_next[s] == 0:
            again = 1
    if again:
        flood_graph(node, gate, params, now, count, out)


def graph_due(params, now, count, tries):
    """When a flood of the graph is over at the latest, and its acks are in."""
    wait = params.job_us * (1 + tries) + params.jitter_us * (count + 4) + params.spread_us
    return (now + wait) & MASK30


def flood_graph(node, gate, params, now, count, out):
    """Queue all parts that somebody misses; those who wait for them are asked no sooner."""
    due = now
    for index in range(min(count, PARTS_MAX)):
        missing = 0
        for s in range(params.nodes):
            if gate.job[s] == UNDER_WAY and gate.job_parts[s] >> index & 1 == 0:
                missing = 1
        if missing:
            i = compose(node, now, CONTROL, GRAPH, ALL, 0, out)
            if i < 0:
                return
            fill_graph(node, gate, params, i, index, count)
            node.q_due[i] = due & MASK30
            due = due + (params.jitter_us >> 1)
    for s in range(params.nodes):
        if gate.job[s] == UNDER_WAY and gate.job_next[s] == 0:
            gate.job_next[s] = 1
            gate.job_due[s] = graph_due(params, now, count, gate.job_tries[s])


def fill_graph(node, gate, params, i, index, count):
    """Part `index` of the graph into place i."""
    add_hop(node, i)
    add8(node, i, node.epoch)
    add16(node, i, gate.version)
    add8(node, i, index << 4 | count)
    first = index * part_bytes(params)
    last = min(graph_bytes(params), first + part_bytes(params))
    pairs = params.nodes * (params.nodes - 1) // 2
    for at in range(first, last):
        byte = 0
        if at == 0:
            byte = params.nodes
        elif at <= params.nodes:
            byte = at - 1
        else:
            for bit in range(8):
                pair = (at - 1 - params.nodes) * 8 + bit
                if pair < pairs and is_pair(gate, params, pair):
                    byte = byte | 128 >> bit
        add8(node, i, byte)


def is_pair(gate, params, pair):
    """1 if the graph has the link that is the pair-th of (0, 1), (0, 2) .. (n - 2, n - 1)."""
    a = 0
    for _ in range(params.nodes):
        row = params.nodes - 1 - a
        if pair < row:
            return is_known(gate, params, a, a + 1 + pair)
        pair = pair - row
        a = a + 1
    return 0
