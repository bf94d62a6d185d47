"""The gateway: discovery rounds, the graph, who leads when it dies [mesh 4, 8.1]."""

from innervate.dialect.arith import MASK16, MASK30
from innervate.dialect.outbox import report, set_timer
from innervate.dialect.rng import draw
from innervate.networks.mesh.protocol.constants import (
    ALARMS,
    PRIORITY,
    REPORT_GRAPH,
    REPORT_ROUND,
    ROUND,
    TABLE_FREE,
    WEAK,
)
from innervate.networks.mesh.protocol.frames import add8, get16, signed8
from innervate.networks.mesh.protocol.jobs import give_jobs, install_own, note_lost_table, pump
from innervate.networks.mesh.protocol.neighbours import FREE, UNHEARD
from innervate.networks.mesh.protocol.paths import (
    FAR,
    begin_round,
    build_graph,
    forget_heard,
    hops,
    is_fresh,
    is_heard,
    measure_all,
    note_heard,
    note_list,
    note_path,
    pair_bytes,
    trusts_lists,
)
from innervate.networks.mesh.protocol.queue import kick
from innervate.networks.mesh.protocol.round import (
    REQUEST_BYTES,
    begin,
    begin_anew,
    compose_request,
)
from innervate.networks.mesh.protocol.search import is_edge
from innervate.networks.mesh.protocol.table import keep_table
from innervate.networks.mesh.protocol.upward import FAINT_DB

IDLE = 0
COLLECTING = 1
ASKED = 2
ASKED_MAX = 20  # by name: as many fit into a request at an MTU of 64
COPIES_MORE = 4  # of the request of who takes over: the channel is full of what looks for the dead


def reset(gate, params):
    """A gateway that knows nothing."""
    for k in range(pair_bytes(params)):
        gate.heard[k] = 0
    for k in range(params.width):
        gate.mark_a[k] = 0
        gate.job[k] = 0
    gate.step = IDLE
    gate.period = params.period
    gate.wait = gate.links = gate.version = gate.open = gate.sum_a = gate.part = gate.taken = 0


def lead(node, gate, params, now, out):
    """Be the gateway from now on, with an epoch that nobody has had.

    Who knows of none draws it, and the version of its tables: it may have been gateway before, and
    a table of the same epoch and version would be taken for the one that is there. Tables are kept
    if all had theirs: a gateway says so in its second round, and gives no graph away before.
    """
    keeps = node.version and (node.active or gate.part) and params.mode != TABLE_FREE
    reset(gate, params)
    epoch = (node.epoch + 1) & 255 if node.known else draw(node, 256)
    begin(node, params, node.number, epoch, node.round, out)
    node.leading = 1
    gate.version = next_version(node.version) if node.version else draw(node, 65_536)
    if keeps:
        inherit(node, gate, params, out)
    start_round(node, gate, params, now, out)


def inherit(node, gate, params, out):
    """All keep their tables, and links count as just reported, but for those of who led before."""
    for a in range(params.nodes):
        for b in range(params.nodes):
            if a != node.gone and b != node.gone and is_edge(node, params, a, b):
                note_heard(gate, params, a, b)
    gate.taken = 1
    node.active = gate.version
    keep_table(node, params, node.table_epoch, out)


def start_round(node, gate, params, now, out):
    """A discovery round: whoever is there responds."""
    begin_round(gate, params)
    gate.wait = gate.period
    report(out, REPORT_ROUND, (node.round + 1) & MASK16, node.epoch)
    request(node, gate, params, now, COLLECTING, out)
    kick(node, params, now, out)


def request(node, gate, params, now, step, out):
    """Broadcast a discovery request, and collect what comes back; its place, -1 if none."""
    flags = 0
    copies = params.copies
    if gate.taken:
        flags = PRIORITY
        copies = copies + COPIES_MORE
    node.round = (node.round + 1) & MASK16
    node.depth = 1
    begin_anew(node, params)
    gate.step = step
    i = compose_request(node, params, now, ALARMS, flags, out)  # a place, whatever waits
    if i >= 0:
        node.q_copies[i] = copies
    set_timer(out, ROUND, (now + params.collect_us) & MASK30)
    return i


def is_missing(gate, params, s):
    """1 if somebody heard node s in this round, and it did not respond."""
    if is_fresh(gate, params, s, s):
        return 0
    for a in range(params.nodes):
        if is_fresh(gate, params, s, a):
            return 1
    return 0


def forget_gone(node, gate, params):
    """Whom nobody heard in this round, of two at least that did before and responded, is gone.

    Kept for three rounds, it would be in everybody's tables for minutes.
    """
    for s in range(params.nodes):
        missed = 0
        for a in range(params.nodes):
            if is_fresh(gate, params, s, a):
                missed = -params.nodes
            elif is_heard(gate, params, s, a):
                missed = missed + is_fresh(gate, params, a, a)
        if missed > 1 and s != node.number:
            for a in range(params.nodes):
                forget_heard(gate, params, s, a)


def ask_again(node, gate, params, now, out):
    """Who did not respond is asked by name: 0 if there is nobody."""
    i = -1
    for s in range(params.nodes):
        if s != node.number and is_missing(gate, params, s):
            if gate.step == COLLECTING:
                i = request(node, gate, params, now, ASKED, out)
            if i >= 0 and node.q_length[i] < REQUEST_BYTES + ASKED_MAX:
                add8(node, i, s)
    return gate.step == ASKED


def is_faint(params, frame):
    """1 if a link that a response came by is too faint to rely on."""
    return frame.flags & WEAK != 0 or frame.rssi < params.min_rssi - FAINT_DB


def on_response(node, gate, params, now, frame, out):
    """A discovery response has reached us."""
    if frame.length < 4 or frame.body[0] != node.epoch:
        return
    if (node.round - get16(frame, 1)) & MASK16 > (gate.step == ASKED):
        return  # what is late is welcome while others are asked once more
    if frame.table_ver == 0:
        note_lost_table(gate, frame.origin)
    loudest = params.min_rssi - 1
    if frame.length > 5:
        note_list(gate, params, frame, 4)
        loudest = signed8(frame.body[5])
        note_heard(gate, params, frame.origin, frame.origin)
    # A faint way counts for who hears nobody well, and tells of one that it hears as faintly.
    if loudest < params.min_rssi or not is_faint(params, frame):
        note_path(gate, params, frame, node.number)
    if gate.step == IDLE and frame.table_ver == 0:
        admit(node, gate, params, now, frame, out)


def admit(node, gate, params, now, frame, out):
    """Somebody came between two rounds: if the graph has it, it is sent its table now.

    Else the next round is as soon as after a change.
    """
    if hops(gate, params, node.number, frame.origin) == FAR:
        stretch(gate, params, 1)
    elif params.mode != TABLE_FREE:
        give_jobs(node, gate, params, 0, out)
        pump(node, gate, params, now, out)


def collect(node, gate, params, now, out):
    """The ROUND timer of a gateway: the graph, the paths, the tables."""
    if gate.step == IDLE:
        return
    for k in range(params.places):
        if node.neighbour[k] != FREE and node.round_depth[k] != UNHEARD and trusts_lists(params):
            if node.round_rssi[k] >= params.min_rssi:
                note_heard(gate, params, node.neighbour[k], node.number)
    if params.asks and gate.step == COLLECTING and not gate.taken:
        if ask_again(node, gate, params, now, out):
            kick(node, params, now, out)
            return
    gate.step = IDLE
    if trusts_lists(params) and not gate.taken:
        forget_gone(node, gate, params)
    mark = build_graph(gate, params)
    changed = mark != gate.sum_a
    report(out, REPORT_GRAPH, gate.links, changed)
    stretch(gate, params, changed)
    if changed:
        measure_all(gate, params)
        if gate.taken:  # all keep the tables that they have until the next round
            mark = 0
            changed = 0
        else:
            gate.version = next_version(gate.version)
            install_own(node, gate, params, out)
    gate.sum_a = mark
    gate.taken = 0
    if params.mode != TABLE_FREE:
        give_jobs(node, gate, params, changed, out)
        pump(node, gate, params, now, out)


def next_version(version):
    """The version after this one: its low byte is not 0, which says in a header: no table."""
    version = (version + 1) & MASK16
    return version if version & 255 else version + 1


def stretch(gate, params, changed):
    """The period doubles while nothing changes, but not where a standby waits for requests."""
    gone = gate.period - gate.wait  # ticks since the round began
    if changed or params.standby:
        gate.period = params.period
    else:
        gate.period = min(2 * gate.period, params.period_max)
    gate.wait = max(1, gate.period - gone)


def tick(node, gate, params, now, out):
    """Every tick of a gateway or standby."""
    if node.leading:
        if gate.wait > 0:
            gate.wait = gate.wait - 1
        elif gate.open > 1:
            gate.open = gate.open - 1
        if gate.wait == 0 and gate.open <= 1:
            start_round(node, gate, params, now, out)
        return
    silence = params.dead + max(0, node.rank - 1) * params.dead_step
    if node.quiet >= silence or node.gateway == node.number:  # we led, neighbours say
        lead(node, gate, params, now, out)
