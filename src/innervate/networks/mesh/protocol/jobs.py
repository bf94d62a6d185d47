"""The gateway hands out what it computed: tables to each node, or the graph to all [mesh 4]."""

from innervate.dialect.arith import MASK30, after, sooner, time_left
from innervate.dialect.outbox import report, set_timer
from innervate.networks.mesh.protocol.constants import (
    ACTIVATE,
    ALL,
    CONTROL,
    CURRENT,
    GIVEN_UP,
    JOBS,
    PARTS_MAX,
    PATH_MAX,
    REPORT_TABLES,
    TABLE,
    TABLES,
    TO_SEND,
    UNDER_WAY,
    WHOLE_GRAPH,
)
from innervate.networks.mesh.protocol.frames import add8, add16, add_hop, get16
from innervate.networks.mesh.protocol.graph_jobs import TOLD, is_unasked, pump_graph
from innervate.networks.mesh.protocol.neighbours import is_suspect
from innervate.networks.mesh.protocol.pack import depth_of, pack, room_at
from innervate.networks.mesh.protocol.paths import (
    FAR,
    NONE,
    first_hop,
    hops,
    is_known,
    make_table,
    mark_table,
)
from innervate.networks.mesh.protocol.queue import compose, drop, kick, spare_places
from innervate.networks.mesh.protocol.round import SLACK
from innervate.networks.mesh.protocol.search import set_edge
from innervate.networks.mesh.protocol.send import pass_on
from innervate.networks.mesh.protocol.table import GROUP_BYTES, all_parts, put_in_force

IN_A_ROW = 3  # tries of a table, each with more patience, before it is the others' turn
PLACES_RESERVED = 3  # of the queue, for what others send through us


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
    put_in_force(node, params, node.epoch, gate.version, out)
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
                gate.open = hold_off(params) if changed else max(gate.open, 1)


def hold_off(params):
    """For how many ticks, less 1, the next round waits: no standby may take us for dead."""
    if params.standby:
        return max(1, min(params.period, params.dead - params.period - SLACK))
    return params.period


def note_lost_table(gate, s):
    """Node s says that it has no table: should it have acknowledged one, it has lost it since."""
    gate.mark_a[s] = 0
    if gate.job[s] == CURRENT:
        gate.job[s] = GIVEN_UP
    if gate.job[s] == GIVEN_UP:
        gate.job_a[s] = 0  # it has no part of it, either


def give_job(gate, params, s):
    """Node s needs its table, unless it has acknowledged the same."""
    if params.mode == WHOLE_GRAPH:
        a = gate.version
        b = gate.sum_a
    else:
        make_table(gate, params, s)
        a = mark_table(gate, params, 1) | 1  # 0: it has none
        b = mark_table(gate, params, 2)
    if a == gate.mark_a[s] and b == gate.mark_b[s]:
        gate.job[s] = CURRENT
        return
    if params.mode == TABLES or a != gate.job_a[s]:
        gate.job_parts[s] = TOLD
    gate.job_a[s] = a
    gate.job_b[s] = b
    gate.job[s] = TO_SEND
    gate.job_tries[s] = 0


def next_job(node, gate, params):
    """Who waits for its table, -1 if nobody does: who was tried least.

    Of these who has none before who has an older one, and of those the nearest.
    """
    best = -1
    least = 0
    for s in range(params.nodes):
        if gate.job[s] == TO_SEND:
            behind = 2 * gate.job_tries[s]
            if gate.mark_a[s]:
                behind = behind + 1
            order = behind << 8 | depth_of(node, gate, params, s)
            if best < 0 or order < least:
                best = s
                least = order
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
        for _ in range(params.nodes):
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


def start_job(node, gate, params, now, s):
    """Node s is next; its table is divided into parts.

    Until it acknowledges this one, nobody knows which it has: no table is its mark's.
    """
    make_table(gate, params, s)
    room = room_at(node, gate, params, s)
    count = pack(node, gate, params, s, room, -1, -1)
    gate.job_next[s] = 0
    gate.job_count[s] = min(count, PARTS_MAX)
    gate.job[s] = UNDER_WAY
    gate.mark_b[s] = gate.job_b[s]
    if count > PARTS_MAX or room <= GROUP_BYTES or depth_of(node, gate, params, s) > PATH_MAX:
        gate.job[s] = GIVEN_UP
    gate.job_due[s] = job_due(node, gate, params, now, s)


def job_due(node, gate, params, now, s):
    """When the parts for s are sent again: later at every try, and the more there is to do."""
    load = 8 + gate.job_count[s] * depth_of(node, gate, params, s)
    wait = params.job_us * (1 + gate.job_tries[s]) // 8 * load
    return (now + wait) & MASK30


def queue_parts(node, gate, params, now, s, out):
    """Queue those parts for node s that are still missing there; without room, a little later."""
    for _ in range(PARTS_MAX):
        index = gate.job_next[s]
        if index >= gate.job_count[s]:
            return
        if gate.job_parts[s] >> index & 1 == 0:
            if spare_places(node) <= PLACES_RESERVED:
                gate.job_due[s] = (now + (params.job_us >> 2)) & MASK30
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
    for hop in range(far):
        at = route_step(node, gate, params, at, s, hop)
        add8(node, i, at)
    first = node.q_body[i * node.q_room + 2]
    add8(node, i, node.epoch)
    add16(node, i, gate.version)
    add8(node, i, index << 4 | gate.job_count[s])
    make_table(gate, params, s)
    pack(node, gate, params, s, room_at(node, gate, params, s), index, i)
    if first == NONE:
        drop(node, params, i)
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


def on_ack(node, gate, params, now, frame, out):
    """A node says which parts it has."""
    s = frame.origin
    if frame.length < 5 or frame.body[0] != node.epoch:
        return
    if get16(frame, 1) != gate.version or gate.job[s] == CURRENT:
        return
    told = get16(frame, 3)
    whole = all_parts(gate.job_count[s])
    gate.job_parts[s] = told | TOLD
    if whole and told & whole == whole:
        gate.job[s] = CURRENT
        gate.mark_a[s] = gate.job_a[s]
    elif gate.job[s] == UNDER_WAY and params.mode == TABLES:
        gate.job_next[s] = 0
    pump(node, gate, params, now, out)


def retry_jobs(node, gate, params, now, out):
    """The JOBS timer: what was not acknowledged in time is sent again, or given up.

    What only waited for room goes on.
    """
    for s in range(params.nodes):
        waits = gate.job_next[s] < gate.job_count[s]
        if params.mode == WHOLE_GRAPH:
            waits = is_unasked(gate, s)
        if gate.job[s] == UNDER_WAY and after(now, gate.job_due[s]) and not waits:
            gate.job_tries[s] = gate.job_tries[s] + 1
            gate.job_next[s] = 0
            gate.job_due[s] = job_due(node, gate, params, now, s)
            if gate.job_tries[s] > params.job_tries:
                gate.job[s] = GIVEN_UP
            elif params.mode == TABLES and gate.job_tries[s] >= IN_A_ROW:
                gate.job[s] = TO_SEND  # who does not answer keeps nobody waiting
    pump(node, gate, params, now, out)


def wait_for_acks(gate, params, now, out):
    """Set the JOBS timer to the first deadline."""
    soonest = -1
    for s in range(params.nodes):
        if gate.job[s] == UNDER_WAY:
            soonest = sooner(soonest, time_left(gate.job_due[s], now))
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
