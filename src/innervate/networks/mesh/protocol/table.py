"""Tables and graphs at a node: parts come in, the whole is put into force [mesh 4 TABLE]."""

from innervate.dialect.arith import MASK30
from innervate.dialect.outbox import report
from innervate.dialect.rng import draw
from innervate.networks.mesh.protocol.constants import (
    ACTIVATE,
    ALL,
    CONTROL,
    CRC_BYTES,
    GRAPH,
    HEADER_BYTES,
    PATH_MAX,
    REPORT_TABLE,
    TABLE_ACK,
    TABLES,
)
from innervate.networks.mesh.protocol.duplicates import clear_bad, record_flood
from innervate.networks.mesh.protocol.frames import add8, add16, get16, is_named, is_route
from innervate.networks.mesh.protocol.queue import compose, take_over
from innervate.networks.mesh.protocol.search import set_edge
from innervate.networks.mesh.protocol.send import enter, pass_on, send_on, send_up, spread

NONE = 255
GROUP_BYTES = 3
PART_HEAD = 4  # epoch, version, fragment
CROWD = 32  # nodes whose answers find their way in a spread_us


def all_parts(count):
    """The bits of `count` fragments."""
    return (1 << count) - 1


def tell_parts(node, params, now, epoch, version, parts, wait, out):
    """Tell the gateway which fragments are here."""
    i = compose(node, (now + wait) & MASK30, CONTROL, TABLE_ACK, node.gateway, 0, out)
    if i >= 0:
        add8(node, i, epoch)
        add16(node, i, version)
        add16(node, i, parts)
        send_up(node, params, now, i, out)


def is_current(node, epoch, version):
    """1 if this is what is in force, or waits to be."""
    if epoch != node.table_epoch or version != node.version:
        return node.ready and epoch == node.new_epoch and version == node.new_version
    return version != 0


def expect(node, epoch, version, count):
    """A fragment of something new: begin anew with it."""
    if epoch != node.new_epoch or version != node.new_version or count != node.part_count:
        node.new_epoch = epoch
        node.new_version = version
        node.part_count = count
        node.parts = 0
        node.ready = 0
        return 1
    return 0


def put_in_force(node, params, epoch, version, out):
    """What came in is in force from now on; whoever it leads to is there."""
    if node.gone != ALL and node.next[node.bank * params.width + node.gone] != NONE:
        node.gone = ALL
    node.version = version
    node.table_epoch = epoch
    node.new_version = 0
    node.ready = 0
    clear_bad(node, params)
    report(out, REPORT_TABLE, version, epoch)


def keep_table(node, params, before, out):
    """A standby took over: our table is its own, if it is of the epoch `before`; else we have none.

    It leads no more to who was gateway.
    """
    if node.version and node.table_epoch == before:
        if node.gone != ALL:
            node.next[node.bank * params.width + node.gone] = NONE
        put_in_force(node, params, node.epoch, node.active, out)
    else:
        node.version = 0


def on_table(node, params, now, frame, out):
    """A part of a routing table: ours, or somebody's further along the route."""
    count = frame.body[0]
    if count + 1 + PART_HEAD > frame.length or not is_route(params, frame):
        return
    at = -1
    for k in range(count):
        if frame.body[1 + k] == node.number:
            at = k
    if at == count - 1:
        take_part(node, params, now, frame, count + 1, out)
        return
    i = take_over(node, now, CONTROL, frame, out)
    if i >= 0 and at < 0:
        send_on(node, params, now, i, out)
    elif i >= 0 and enter(node, params, i, out):
        pass_on(node, params, i, frame.body[2 + at])


def take_part(node, params, now, frame, at, out):
    """A part of our table, its head at byte `at` of the payload."""
    epoch = frame.body[at]
    version = get16(frame, at + 1)
    index = frame.body[at + 3] >> 4
    count = frame.body[at + 3] & 15
    if epoch != node.epoch or index >= count:
        return
    if is_current(node, epoch, version):
        tell_parts(node, params, now, epoch, version, all_parts(count), 0, out)
        return
    bank = (1 - node.bank) * params.width
    if expect(node, epoch, version, count):
        for k in range(params.width):
            node.next[bank + k] = NONE
            node.alt[bank + k] = NONE
    node.parts = node.parts | 1 << index
    read_groups(node, params, frame, at + PART_HEAD, bank)
    whole = node.parts == all_parts(count)
    if whole or index == count - 1:
        tell_parts(node, params, now, epoch, version, node.parts, 0, out)
    if whole:
        finish_table(node, params, out)


def read_groups(node, params, frame, at, bank):
    """Groups of (next, alternate, how many, recipients) up to the payload's end."""
    for _ in range(frame.length):
        if at + GROUP_BYTES > frame.length:
            return
        count = frame.body[at + 2]
        for k in range(min(count, frame.length - at - GROUP_BYTES)):
            dest = frame.body[at + GROUP_BYTES + k]
            if dest < params.nodes:
                node.next[bank + dest] = frame.body[at]
                node.alt[bank + dest] = frame.body[at + 1]
        at = at + GROUP_BYTES + count


def finish_table(node, params, out):
    """Our table is whole: use it at once, or when all have theirs [mesh A10]."""
    if params.activation:
        node.ready = 1
    else:
        node.bank = 1 - node.bank
        put_in_force(node, params, node.new_epoch, node.new_version, out)


def activate(node, params, epoch, version, out):
    """The gateway says that these tables are in force."""
    if node.ready and epoch == node.new_epoch and version == node.new_version:
        node.bank = 1 - node.bank
        put_in_force(node, params, epoch, version, out)


def on_activate(node, params, now, frame, out):
    """Flooded: put the new tables into force."""
    activate(node, params, frame.body[0], get16(frame, 1), out)
    if not record_flood(node, frame.origin, frame.seq, ACTIVATE, 0):
        spread(node, params, now, CONTROL, frame, out)


def part_bytes(params):
    """How much of the graph a fragment carries: flooded, its path is short; a standby's is not."""
    path = PATH_MAX if params.mode == TABLES else 1
    return params.mtu - HEADER_BYTES - CRC_BYTES - path - PART_HEAD


def part_count(params):
    """How many fragments the graph has."""
    return (graph_bytes(params) + part_bytes(params) - 1) // part_bytes(params)


def graph_bytes(params):
    """Length of the graph: the number of nodes, their ids, a bit for every pair [mesh 2]."""
    return 1 + params.nodes + (params.nodes * (params.nodes - 1) // 2 + 7) // 8


def on_graph(node, params, now, frame, out):
    """A part of the flooded graph; behind the last part it is asked who has which, by name."""
    if frame.length <= PART_HEAD or node.leading:
        return
    epoch = frame.body[0]
    version = get16(frame, 1)
    index = frame.body[3] >> 4
    count = frame.body[3] & 15
    if epoch != node.epoch or index > count:
        return
    if record_flood(node, frame.origin, frame.seq, GRAPH, 0):
        return
    parts = all_parts(count)
    asked = params.nodes
    tells = 0
    if index >= count:
        asked = frame.length - PART_HEAD
        tells = is_named(frame, PART_HEAD, node.number)
    if not is_current(node, epoch, version):
        expect(node, epoch, version, count)
        if index < count:
            read_edges(node, params, frame, index)
            node.parts = node.parts | 1 << index
            tells = index == count - 1
            if node.parts == parts:
                tells = 1
                put_in_force(node, params, epoch, version, out)
        parts = node.parts
    if tells:  # but not when all others do
        wait = draw(node, spread_of_answers(params, asked) + 1)
        tell_parts(node, params, now, epoch, version, parts, wait, out)
    spread(node, params, now, CONTROL, frame, out)


def spread_of_answers(params, count):
    """Within what time so many say which parts they have: their acks meet near the gateway."""
    return params.spread_us * (1 + count // CROWD)


def ends_of(params, pair):
    """Of (0, 1), (0, 2) .. (n - 2, n - 1) the pair-th, as 256 a + b; -1 beyond the last."""
    for a in range(params.nodes):
        row = params.nodes - 1 - a
        if pair < row:
            return a << 8 | a + 1 + pair
        pair = pair - row
    return -1


def read_edges(node, params, frame, index):
    """The pairs a < b of a fragment, row by row, most significant bit first."""
    first = index * part_bytes(params) - 1 - params.nodes
    for k in range(frame.length - PART_HEAD):
        for bit in range(8):
            if first + k >= 0:
                ends = ends_of(params, (first + k) * 8 + bit)
                if ends >= 0:
                    there = frame.body[PART_HEAD + k] >> (7 - bit) & 1
                    set_edge(node, params, ends >> 8, ends & 255, there)
