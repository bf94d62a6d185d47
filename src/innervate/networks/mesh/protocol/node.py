"""The mesh: routed messages between any two nodes, tables made by a gateway, a virtual fence.

The router's five functions [mesh 4]. `gate` is the record that only a gateway or standby has.
Rounds stand in round.py (nodes) and gateway.py, tables in table.py and jobs.py,
the choice of a hop in route.py, messages in messages.py, the fence in alarm.py.
"""

from innervate.dialect.arith import MASK30
from innervate.dialect.outbox import report, set_timer
from innervate.dialect.rng import draw
from innervate.networks.mesh.protocol.alarm import (
    clear_raised,
    flood_again,
    on_flood,
    on_sample,
    repeat_alarm,
    take_alarm,
)
from innervate.networks.mesh.protocol.backoff import NO_BACKOFF, end_backoff
from innervate.networks.mesh.protocol.constants import (
    ACK,
    ACK_MORE_BYTES,
    ACK_WAIT,
    ACK_WANTED,
    ACTIVATE,
    ALARM,
    ALL,
    BODY,
    CONTROL,
    CRC_BYTES,
    DATA,
    DATA_MAX,
    DETOURED,
    E2E_ACK,
    FLOOD,
    GRAPH,
    HANDED_UP,
    HEADER_BYTES,
    MESSAGE,
    POSITION,
    REPORT_UNKEYED,
    REQUEST,
    RESPONSE,
    RETRY,
    ROUND,
    SAMPLE,
    SENT,
    SOURCE_ROUTE,
    TABLE,
    TABLE_FREE,
    TICK,
    TX,
    WEAK,
)
from innervate.networks.mesh.protocol.duplicates import (
    age,
    clear_duplicates,
    forgive,
    mark_reachable,
    record_packet,
    retry_unreachable,
)
from innervate.networks.mesh.protocol.frames import clear_queue, get16, is_routed, is_sound
from innervate.networks.mesh.protocol.gateway import (
    collect,
    is_faint,
    lead,
    on_response,
    reset,
    tick,
)
from innervate.networks.mesh.protocol.hop import learn_late, learn_trip, widen
from innervate.networks.mesh.protocol.jobs import on_ack, retry_jobs
from innervate.networks.mesh.protocol.messages import (
    on_handed_up,
    on_message,
    payload_limit,
    take,
)
from innervate.networks.mesh.protocol.neighbours import clear_neighbours, hear, hear_again, sweep
from innervate.networks.mesh.protocol.overheard import drop_overheard
from innervate.networks.mesh.protocol.queue import (
    acknowledge,
    has_room,
    kick,
    make_room,
    send_all,
    take_ack,
    take_over,
    take_sent,
    tell_hop,
)
from innervate.networks.mesh.protocol.relay import flood_data, flood_wanted, rank_of, relay
from innervate.networks.mesh.protocol.retransmission import (
    arm_retry,
    due_retransmission,
    retransmit,
)
from innervate.networks.mesh.protocol.round import (
    REQUEST_BYTES,
    ask_round,
    on_request,
    step,
    tell_round,
)
from innervate.networks.mesh.protocol.route import learn_way
from innervate.networks.mesh.protocol.send import is_upward, on_ack_timeout, send_up
from innervate.networks.mesh.protocol.standby import TOLERANCE, guard, hear_of_gateway, on_guard
from innervate.networks.mesh.protocol.table import on_activate, on_graph, on_table
from innervate.networks.mesh.protocol.watch import NEVER, beacon, on_position, watch

NONE = 255
UNREACHABLE_TICKS = 4  # whoever could not be reached is tried again after at most so long
FOR_WHAT_COMES_DOWN = 3  # places, without tables: queues full of what climbs would block each other
RETRIES = 4  # of kept messages in one go: the outbox has to hold them


def on_start(node, gate, params, now, cause, out):
    """Switch on: nothing known. A gateway begins at once, one that had been on waits first."""
    node.places = params.queue
    node.kept = params.kept
    node.q_room = max(BODY, params.mtu - HEADER_BYTES - CRC_BYTES)
    node.wait_room = max(DATA_MAX, payload_limit(params))
    node.seq = draw(node, 65_536)
    node.ticks = node.epoch = node.round = node.known = node.active = 0
    node.tick_at = now
    node.gateway = node.gone = node.parent = ALL
    node.depth = NONE
    node.due = node.quiet = node.leading = 0
    node.tolerance = TOLERANCE
    node.round_trip = node.strain = node.search_backoff = 0
    node.pause = NO_BACKOFF
    node.version = node.table_epoch = node.new_version = node.new_epoch = 0
    node.part_count = node.ready = 0
    node.placed = node.outside = node.heard_out = 0
    clear_neighbours(node, params)
    clear_duplicates(node, params)
    clear_queue(node)
    clear_arrays(node, params)
    set_timer(out, TICK, (now + draw(node, params.tick_us) + 1) & MASK30)
    if node.rank >= 0:
        reset(gate, params)
        if node.rank == 0 and cause == 0:
            lead(node, gate, params, now, out)


def clear_arrays(node, params):
    """No tables, no graph, no message kept, no robot known."""
    for k in range(2 * params.width):
        node.next[k] = NONE
        node.alt[k] = NONE
    for k in range(params.width * params.row):
        node.edges[k] = 0
    for k in range(params.row):
        node.met[k] = 0
    for w in range(node.kept):
        node.wait_kind[w] = 0
    for k in range(params.width):
        node.missed[k] = NEVER
        node.raised[k] = 0


def on_frame(node, gate, params, now, port, frame, out):
    """A frame was received, perhaps for somebody else [mesh 4]."""
    if frame.link_src >= params.nodes or frame.link_src == node.number:
        return
    if not is_sound(params, frame):
        return
    if frame.kind == ACK and frame.link_dst != node.number:
        hear_again(node, params, frame.link_src)
        return
    k = hear(node, params, frame.link_src, frame.rssi)
    hear_of_gateway(node, frame)
    if frame.kind == ACK:
        on_hop_ack(node, params, now, frame, k, out)
    elif frame.link_dst == ALL:
        on_broadcast(node, params, now, frame, k, out)
    else:
        drop_overheard(node, params, frame, out)
        if frame.kind == E2E_ACK:
            mark_reachable(node, frame.origin)
        if frame.link_dst == node.number:
            on_unicast(node, gate, params, now, frame, out)
        else:
            kick(node, params, now, out)


def on_hop_ack(node, params, now, frame, k, out):
    """A hop, the neighbour in place k, has taken over what we sent."""
    took = note_ack(node, params, now, frame.origin, frame.seq, frame.link_src, k, out)
    for n in range(frame.length // ACK_MORE_BYTES):
        at = n * ACK_MORE_BYTES
        seq = get16(frame, at + 1)
        took = took + note_ack(node, params, now, frame.body[at], seq, frame.link_src, k, out)
    if took:
        kick(node, params, now, out)


def note_ack(node, params, now, origin, seq, who, k, out):
    """`who`, in place k, has taken over a packet: 1 if we waited for that."""
    i = take_ack(node, params, origin, seq, who, k)
    if i < 0:
        if params.ack_adapt:
            learn_late(node, now, k)
        return 0
    if params.ack_adapt:
        learn_trip(node, now, i, k)
    widen(node, params, k)
    tell_hop(node, i, out)
    return 1


def on_broadcast(node, params, now, frame, k, out):
    """A frame for everyone in reach."""
    kind = frame.kind
    if kind == REQUEST:
        if frame.length >= REQUEST_BYTES:
            if frame.body[0] < params.nodes:
                on_request(node, params, now, frame, k, out)
            elif frame.body[0] == ALL:
                tell_round(node, params, now, out)
    elif kind == ALARM:
        if frame.flags & FLOOD:
            on_flood(node, params, now, frame, k, out)
    elif kind == POSITION:
        on_position(node, params, now, frame, out)
    elif kind == GRAPH:
        on_graph(node, params, now, frame, out)
    elif kind == ACTIVATE:
        if frame.length >= 3:
            on_activate(node, params, now, frame, out)
    elif kind == DATA:
        if params.on_demand and frame.dest != ALL:
            flood_wanted(node, params, now, frame, k, out)
        elif frame.flags & FLOOD:
            flood_data(node, params, now, frame, out)
    else:
        report(out, REPORT_UNKEYED, kind, 0)
    kick(node, params, now, out)


def on_unicast(node, gate, params, now, frame, out):
    """A frame for us: acknowledge it if we can take it over, then handle it."""
    here = frame.dest == node.number
    rank = rank_of(frame)
    if (
        rank
        and params.mode == TABLE_FREE
        and is_routed(frame.kind)
        and not frame.flags & SOURCE_ROUTE
    ):
        rank = rank + FOR_WHAT_COMES_DOWN
    if not here and not has_room(node, rank):
        if frame.flags & DETOURED or not make_room(node, rank, out):
            return
    if frame.flags & ACK_WANTED:
        acknowledge(node, params, frame, out)
    kind = frame.kind
    if is_upward(kind):
        on_upward(node, gate, params, now, frame, out)
    elif kind == TABLE:
        if not record_packet(node, frame):
            on_table(node, params, now, frame, out)
    elif kind == ALARM and here:
        take_alarm(node, params, now, frame, out)
    elif kind == POSITION and here:
        on_position(node, params, now, frame, out)
    elif is_routed(kind):
        if here and kind == GRAPH:
            on_guard(node, gate, params, now, frame, out)
        elif here:
            take(node, params, now, frame, out)
        else:
            relay(node, params, now, frame, out)
    else:
        report(out, REPORT_UNKEYED, kind, 0)
    kick(node, params, now, out)


def on_upward(node, gate, params, now, frame, out):
    """A response or a table's ack: for us if we are the gateway, else it climbs on."""
    if record_packet(node, frame):
        return
    learn_way(node, params, frame)
    if not node.leading:
        i = take_over(node, now, CONTROL, frame, out)
        if i >= 0:
            if is_faint(params, frame):
                node.q_flags[i] = node.q_flags[i] | WEAK
            send_up(node, params, now, i, out)
    elif frame.kind == RESPONSE:
        on_response(node, gate, params, now, frame, out)
    else:
        on_ack(node, gate, params, now, frame, out)


def on_input(node, gate, params, now, kind, item, out):
    """MESSAGE: send it. SENT: the frame below has left. SAMPLE: where a robot is.

    HANDED_UP: the user has a message that waited for its turn.
    """
    if kind == SENT:
        take_sent(node, params, now, item.ok, out)
    elif kind == MESSAGE:
        on_message(node, params, now, item, out)
    elif kind == SAMPLE:
        on_sample(node, params, now, item, out)
    elif kind == HANDED_UP:
        on_handed_up(node, params, now, item, out)


def on_timer(node, gate, params, now, timer, out):
    """One of six waits is over; the last of them is JOBS."""
    if timer == TX:
        send_all(node, params, now, out)
    elif timer == ACK_WAIT:
        on_ack_timeout(node, params, now, out)
    elif timer == ROUND:
        if node.leading:
            collect(node, gate, params, now, out)
        else:
            step(node, params, now, out)
    elif timer == TICK:
        on_tick(node, gate, params, now, out)
    elif timer == RETRY:
        on_retry(node, params, now, out)
    elif node.leading:
        retry_jobs(node, gate, params, now, out)
    elif node.rank >= 0:
        guard(node, gate, params, now, out)


def on_tick(node, gate, params, now, out):
    """The beat of all slow things."""
    node.ticks = (node.ticks + 1) & 65_535
    node.tick_at = now
    set_timer(out, TICK, (now + params.tick_us) & MASK30)
    sweep(node, params)
    end_backoff(node, now)
    age(node, params)
    if node.ticks & ((UNREACHABLE_TICKS << node.search_backoff) - 1) == 0:
        retry_unreachable(node)
        forgive(node)
    watch(node, params, now, out)
    if node.robot and node.placed:
        repeat_alarm(node, params, now, out)
        beacon(node, params, now, out)
    if not node.leading:
        node.quiet = min(node.quiet + 1, 65_535)
        # The first round is on its way at the first beat, but for who has led it.
        late = node.quiet > 1 or node.rank == 0
        if not node.known and late and node.quiet & (node.quiet - 1) == 0:
            ask_round(node, params, now, out)
    if node.rank >= 0:
        tick(node, gate, params, now, out)
    kick(node, params, now, out)


def on_retry(node, params, now, out):
    """An end-to-end ack is overdue: once more, for alarms as a flood besides."""
    for _ in range(RETRIES):
        w = due_retransmission(node, now)
        if w >= 0:
            alarm = node.wait_kind[w] == ALARM
            if not retransmit(node, params, now, w, out):
                if alarm:
                    clear_raised(node, w)
            elif alarm:
                flood_again(node, params, now, w, out)
    arm_retry(node, now, out)
