"""A node of RPL: what it does when something happens."""

from innervate.dialect.access import ALL
from innervate.dialect.arith import MASK16, MASK30
from innervate.dialect.outbox import deliver, report, set_timer
from innervate.dialect.rng import draw
from innervate.networks.rpl.protocol import kinds, sizes, timers
from innervate.networks.rpl.protocol.constants import (
    IDLE,
    INFINITE,
    INITIAL,
    NOBODY,
    NONE,
    REPORT_FULL,
    REPORT_HOPS,
    REPORT_LOOP,
)
from innervate.networks.rpl.protocol.counters import dag_rank, following
from innervate.networks.rpl.protocol.downward import (
    AGAIN,
    DAO_TRIES,
    announce,
    forget,
    grow_older,
    schedule,
    take_dao,
    take_report,
)
from innervate.networks.rpl.protocol.packets import base_of, clean, keep, new_place
from innervate.networks.rpl.protocol.parents import choose, hear_dio, meet, new_version
from innervate.networks.rpl.protocol.sending import (
    acked,
    acknowledge,
    give_up,
    go,
    missed,
    new_message,
    sent,
)
from innervate.networks.rpl.protocol.trickle import begin_interval, interval_point, reset_trickle

TIMERS = 4
OUTBOX = 55

MESSAGE = 1  # inputs: to item.dest
ALARM = 2  # to the root
RARELY = 63  # ticks: at last one more between two solicitations
LONELY_MAX = 255  # ticks that are counted


def on_start(node, params, now, cause, out):
    """The node is switched on, or has lost its memory; the root says so in DIOs."""
    for k in range(sizes.NEIGHBOURS):
        node.nbr[k] = NONE
        node.nbr_rank[k] = INFINITE
        node.nbr_etx[k] = 0
    for i in range(sizes.NODES):
        node.via[i] = NONE
        node.owed[i] = 0
        node.left[i] = 0
    begin(node)
    node.dsn = draw(node, 256)
    if node.number == params.root:
        node.known = 1
        node.fresh = 1 if cause else 0
        node.rank = params.step
        begin_interval(node, params, now, out)
    set_timer(out, timers.TICK, (now + 1 + draw(node, params.tick_us)) & MASK30)


def begin(node):
    """Nothing is known, nothing is under way."""
    node.version = node.dtsn = node.path_seq = INITIAL
    node.rank = node.lowest = node.floor = INFINITE
    node.parent = NONE
    node.under = IDLE
    node.to = node.old = NOBODY
    node.known = node.hold = node.lonely = node.fresh = node.interval = node.rounds = 0
    node.waiting = node.q_count = 0
    node.dio_due = node.dis_due = node.dao_due = node.dao_armed = node.dao_wait = 0


def on_frame(node, params, now, port, frame, out):
    """A frame was received: acknowledge it if it is for us alone, once if it came before."""
    if frame.kind == kinds.ACK:
        acked(node, params, now, frame, out)
        return
    k = meet(node, params, frame.src, frame.rssi)
    if frame.to != ALL:
        acknowledge(node, frame, out)
        if k >= 0:
            if node.nbr_dsn[k] == frame.dsn:
                return
            node.nbr_dsn[k] = frame.dsn
    if frame.kind == kinds.DIO:
        if k >= 0:
            hear_dio(node, params, now, k, frame, out)
    elif frame.kind == kinds.DIS:
        if node.known:
            reset_trickle(node, params, now, out)
    elif frame.kind == kinds.DAO:
        if node.parent < 0 or node.nbr[node.parent] != frame.src:
            take_dao(node, params, now, frame, out)
    else:
        take_packet(node, params, now, frame, out)
    go(node, params, out)


def on_sent(node, params, now, ok, out):
    """The medium access says that our frame has left the air, or that it has given it up."""
    sent(node, params, now, ok, out)


def on_timer(node, params, now, timer, out):
    """Trickle, a missing acknowledgement, DelayDAO, a tick."""
    if timer == timers.ACK_WAIT:
        if node.waiting:
            missed(node, params, now, out)
        return
    if timer == timers.TRICKLE:
        if interval_point(node, params, now, out):
            node.dio_due = 1
    elif timer == timers.TICK:
        set_timer(out, timers.TICK, (now + params.tick_us) & MASK30)
        tick(node, params, now, out)
    else:
        node.dao_armed = 0
        delay_over(node, params, now, out)
    go(node, params, out)


def on_input(node, params, now, kind, item, out):
    """Our user has a message for somebody, or an alarm for the root."""
    dest = params.root if kind == ALARM else item.dest
    if dest != node.number:
        new_message(node, params, dest, item, out)
        go(node, params, out)


def tick(node, params, now, out):
    """Ways grow older; the root may begin anew; who has no parent asks for one."""
    node.lived = (node.lived + 1) & MASK16
    grow_older(node, params, now, out)
    if node.number == params.root:
        if params.repair and node.lived % params.repair == 0:
            new_version(node, params, now, following(node.version), out)
        return
    if node.rank != INFINITE:
        if node.lived % params.refresh == 0:
            announce(node, params, now, out)
        return
    node.lonely = node.lonely + 1 if node.lonely < LONELY_MAX else LONELY_MAX - RARELY
    node.hold = max(node.hold - 1, 0)
    if node.hold == 0:
        node.floor = INFINITE
        choose(node, params, now, out)
    if node.rank == INFINITE:
        if (node.lonely & (node.lonely - 1)) == 0 or (node.lonely & RARELY) == 0:  # ever rarer
            node.dis_due = 1
        if node.lonely >= params.patience:
            flush(node, out)


def flush(node, out):
    """Nobody has come who could take our packets."""
    for _i in range(sizes.QUEUE):
        if node.q_count > 0 and node.under == IDLE:
            give_up(node, out)


def delay_over(node, params, now, out):
    """DelayDAO is over. To the root the DAO goes as a packet, again until it is acknowledged."""
    if params.storing:
        node.dao_due = 1
        return
    if not node.owed[node.number] or node.parent < 0 or node.dao_wait >= DAO_TRIES:
        return
    node.dao_wait += 1
    node.dao_armed = 1
    set_timer(out, timers.DAO_DELAY, (now + AGAIN * params.dao_us) & MASK30)
    i = new_place(node)
    if i >= 0:
        node.q_kind[i] = kinds.DAO_UP
        node.q_dest[i] = params.root
        node.q_hops[i] = params.hops
        node.q_info[i] = node.nbr[node.parent]
        node.q_path[i] = node.path_seq


def take_packet(node, params, now, frame, out):
    """A packet came: for us, or to be passed on; its ranks may say that it goes in circles."""
    error = frame.error
    if frame.back:
        if frame.dest < sizes.NODES and node.via[frame.dest] == frame.src:
            forget(node, frame.dest)
            schedule(node, params, now, out)
    elif is_astray(node, params, frame):
        if frame.error:
            report(out, REPORT_LOOP, frame.dest, frame.origin)
            reset_trickle(node, params, now, out)
            return
        error = 1
    if frame.dest == node.number:
        consume(node, params, frame, out)
        return
    if frame.hops <= 1:
        report(out, REPORT_HOPS, frame.dest, frame.origin)
        return
    i = new_place(node)
    if i < 0:
        report(out, REPORT_FULL, frame.dest, node.q_count)
        return
    keep(node, i, frame)
    node.q_error[i] = error
    if frame.back:
        node.q_from[i] = node.nbr[node.parent] if node.parent >= 0 else NOBODY


def is_astray(node, params, frame):
    """True if a packet's direction does not match the ranks of its sender and us [11.2.2.2]."""
    if frame.sender_rank == 0:
        return False
    mine = dag_rank(node.rank, params.step)
    return frame.sender_rank > mine if frame.down else frame.sender_rank < mine


def consume(node, params, frame, out):
    """A packet is for us."""
    kind = base_of(frame.kind)
    if kind == kinds.DATA:
        hand_up(node, frame, out)
    elif kind == kinds.DAO_ACK:
        if frame.path == node.path_seq:
            node.owed[node.number] = 0
    elif kind == kinds.DAO_UP:
        if take_report(node, params, frame.origin, frame.info, frame.path):
            answer(node, params, frame, out)
    elif kind == kinds.ROUTE_ERROR:
        if frame.info < sizes.NODES and node.via[frame.info] == frame.origin:
            forget(node, frame.info)


def answer(node, params, frame, out):
    """Non-storing mode, the root: acknowledge a DAO."""
    i = new_place(node)
    if i < 0:
        report(out, REPORT_FULL, frame.origin, node.q_count)
        return
    node.q_kind[i] = kinds.DAO_ACK
    node.q_dest[i] = frame.origin
    node.q_hops[i] = params.hops
    node.q_path[i] = frame.path


def hand_up(node, frame, out):
    """A message is for our user."""
    copy = out.frame[deliver(out, kinds.DATA)]
    clean(copy)
    copy.kind = kinds.DATA
    copy.to = node.number
    copy.src = frame.src
    copy.origin = frame.origin
    copy.dest = frame.dest
    copy.hops = frame.hops
    copy.made_at = frame.made_at
    for j in range(sizes.BODY):
        copy.body[j] = frame.body[j]
