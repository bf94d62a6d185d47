"""One frame after the other goes down to the medium access; hops acknowledge.

Next to go are a DIO, a DIS, a DAO, the first packet. What is for one node is transmitted until it
is acknowledged, a few times; then the link looks worse, and another way is looked for.
"""

from innervate.dialect.access import ALL
from innervate.dialect.arith import MASK30
from innervate.dialect.outbox import URGENT, report, send, set_timer
from innervate.networks.rpl.protocol import kinds, sizes, timers
from innervate.networks.rpl.protocol.constants import (
    A_DAO,
    A_DIO,
    A_DIS,
    A_PACKET,
    IDLE,
    INFINITE,
    NOBODY,
    NONE,
    REPORT_FULL,
    REPORT_NO_ROUTE,
)
from innervate.networks.rpl.protocol.counters import dag_rank, following
from innervate.networks.rpl.protocol.downward import (
    forget,
    forget_child,
    lay_route,
    pick,
    pick_left,
    schedule,
    told,
    told_left,
)
from innervate.networks.rpl.protocol.packets import clean, drop_first, fill, new_place
from innervate.networks.rpl.protocol.parents import (
    GIVEN_UP,
    choose,
    learn_etx,
    note_failure,
    place_of,
)
from innervate.networks.rpl.protocol.trickle import reset_trickle

STAY = -2  # no next hop now: there may be one later


def go(node, params, out):
    """Send what is next, if nothing is under way."""
    if node.under != IDLE:
        return
    if node.dio_due:
        node.dio_due = 0
        node.under = A_DIO
        send_dio(node, params, out)
    elif node.dis_due:
        node.dis_due = 0
        node.under = A_DIS
        blank(node, kinds.DIS, ALL, out)
    elif not node.dao_due or not send_dao(node, params, out):
        node.dao_due = 0
        go_on(node, params, out)


def send_dao(node, params, out):
    """Send what our parent is to hear, then what one that we left is; false if that is all."""
    if node.parent >= 0 and pick(node, params):
        begin(node, params, A_DAO, node.nbr[node.parent], out)
        return True
    if node.old != NOBODY and pick_left(node):
        begin(node, params, A_DAO, node.old, out)
        return True
    return False


def go_on(node, params, out):
    """Send the first packet that has somewhere to go; those before it are dropped."""
    to = NONE
    for _i in range(sizes.QUEUE):
        if node.q_count > 0 and to == NONE:
            to = next_hop(node, params, node.q_first)
            if to == NONE:
                give_up(node, out)
    if to >= 0:
        begin(node, params, A_PACKET, to, out)


def give_up(node, out):
    """The first packet cannot go on."""
    report(out, REPORT_NO_ROUTE, node.q_dest[node.q_first], node.q_count - 1)
    drop_first(node)


def next_hop(node, params, i):
    """Who the packet in a place goes to; NONE = nobody, STAY = nobody yet.

    In storing mode a packet goes up until somebody knows the way down [RFC 6550, 9.8]; who cannot
    pass it further down returns it to where it came from [11.2.2.3]. In non-storing mode it goes
    up to the root, which writes the whole way into it [9.7].
    """
    dest = node.q_dest[i]
    kind = node.q_kind[i]
    to_any = kind == kinds.DATA or kind == kinds.DAO_ACK
    if to_any and not params.storing:
        if node.number == params.root:
            node.q_down[i] = 1
            return node.q_info[i] if lay_route(node, i) else NONE
        if node.q_length[i] > 0:
            at = node.q_next[i]
            return node.q_route[i * sizes.ROUTE + at - 1] if at <= node.q_length[i] else NONE
    elif to_any:
        if dest < sizes.NODES and node.via[dest] >= 0:
            node.q_down[i] = 1
            node.q_back[i] = 0
            return node.via[dest]
        if node.q_down[i]:
            node.q_back[i] = 1
            return node.q_from[i] if node.q_from[i] != NOBODY else NONE
    if node.number == params.root:
        return NONE
    return node.nbr[node.parent] if node.parent >= 0 else STAY


def blank(node, kind, to, out):
    """A frame for the medium access, with its hop's fields."""
    frame = out.frame[send(out, 0, node.tries, 0)]
    clean(frame)
    frame.kind = kind
    frame.to = to
    frame.src = node.number
    frame.dsn = node.dsn
    return frame


def send_dio(node, params, out):
    """Say where we stand; the lowest rank that we ever said counts [RFC 6550, 8.2.2.4]."""
    node.tries = 0
    node.lowest = min(node.lowest, node.rank)
    frame = blank(node, kinds.DIO, ALL, out)
    frame.version = node.version
    frame.rank = node.rank
    frame.dtsn = node.dtsn
    frame.mop = 2 if params.storing else 1


def begin(node, params, what, to, out):
    """A frame for one node is under way."""
    node.under = what
    node.to = to
    node.tries = 0
    node.dsn = (node.dsn + 1) & 255
    transmit(node, params, out)


def transmit(node, params, out):
    """Hand down the frame that is under way."""
    node.waiting = 0
    if node.under == A_DAO:
        frame = blank(node, kinds.DAO, node.to, out)
        frame.life = node.dao_life
        for i in range(sizes.TARGETS):
            frame.targets[i] = node.dao_target[i]
            frame.paths[i] = node.dao_path[i]
        return
    i = node.q_first
    frame = blank(node, 0, node.to, out)
    fill(node, i, frame)
    if node.q_length[i] > 0:
        frame.next = node.q_next[i] + 1
    frame.sender_rank = sender_rank(node, params, i)


def sender_rank(node, params, i):
    """What the packet in a place says of us [RFC 6550, 11.2]; more than any into a new version."""
    if node.q_from[i] == NOBODY:
        return 0
    k = place_of(node, node.to)
    if k >= 0 and node.nbr_version[k] != node.version and not node.q_down[i]:
        return INFINITE
    return dag_rank(node.rank, params.step)


def sent(node, params, now, ok, out):
    """The frame that was handed down has left, or the channel stayed busy."""
    if node.under == A_DIO or node.under == A_DIS:
        node.under = IDLE
        go(node, params, out)
    elif node.under != IDLE and ok:
        node.waiting = 1
        set_timer(out, timers.ACK_WAIT, (now + params.ack_us) & MASK30)
    elif node.under != IDLE:
        missed(node, params, now, out)


def acknowledge(node, frame, out):
    """Say that a frame has come, at once and whatever is on the air."""
    answer = out.frame[send(out, 0, 0, URGENT)]
    clean(answer)
    answer.kind = kinds.ACK
    answer.to = frame.src
    answer.src = node.number
    answer.dsn = frame.dsn


def missed(node, params, now, out):
    """The frame under way was not acknowledged: once more, or no more."""
    node.waiting = 0
    node.tries += 1
    if node.tries < params.transmissions:
        transmit(node, params, out)
        return
    k = place_of(node, node.to)
    gone = k < 0
    if k >= 0:
        note_failure(node, params, k)
        gone = node.nbr_fails[k] >= GIVEN_UP
    if node.under == A_DAO and node.to == node.old:
        node.old = NOBODY
    elif node.under == A_DAO:
        node.dao_due = 0
        schedule(node, params, now, out)
    else:
        turn_back(node, params, now, gone, out)
    node.under = IDLE
    node.to = NOBODY
    choose(node, params, now, out)
    go(node, params, out)


def turn_back(node, params, now, gone, out):
    """The first packet was given to somebody in vain, who may be `gone`: another way, or none."""
    i = node.q_first
    node.rounds += 1
    routed = node.q_length[i] > 0 and node.number != params.root
    if gone and node.q_down[i] and not node.q_back[i] and not routed:
        lose_child(node, params, now, out)
    if node.rounds > params.reroutes or node.q_back[i] or (gone and routed):
        drop_first(node)
        report(out, REPORT_NO_ROUTE, node.q_dest[i], node.q_count)
        if routed:
            tell_root(node, params, node.to, out)


def lose_child(node, params, now, out):
    """A child is not reached: what leads to it is forgotten, and DAOs are asked for anew [9.6]."""
    if params.storing:
        forget_child(node, params, now, node.to, out)
    elif node.to < sizes.NODES:
        forget(node, node.to)
    node.dtsn = following(node.dtsn)
    reset_trickle(node, params, now, out)


def tell_root(node, params, missing, out):
    """Non-storing mode: the next hop of a source route does not answer [RFC 6550, 11.2.2.3]."""
    i = new_place(node)
    if i < 0:
        report(out, REPORT_FULL, params.root, 0)
        return
    node.q_kind[i] = kinds.ROUTE_ERROR
    node.q_dest[i] = params.root
    node.q_hops[i] = params.hops
    node.q_info[i] = missing


def acked(node, params, now, frame, out):
    """A hop has acknowledged: what it was is done with."""
    if not node.waiting or frame.src != node.to or frame.dsn != node.dsn:
        return
    node.waiting = 0
    k = place_of(node, node.to)
    if k >= 0:
        learn_etx(node, k, node.tries + 1)
        node.nbr_fails[k] = 0
    if node.under == A_PACKET:
        drop_first(node)
    elif node.to == node.old:
        told_left(node)
    else:
        told(node)
    node.under = IDLE
    node.to = NOBODY
    choose(node, params, now, out)
    go(node, params, out)


def new_message(node, params, dest, item, out):
    """A message of our own user."""
    i = new_place(node)
    if i < 0:
        report(out, REPORT_FULL, dest, node.q_count)
        return
    node.q_dest[i] = dest
    node.q_hops[i] = params.hops
    node.q_made[i] = item.made_at
    for j in range(sizes.BODY):
        node.q_body[i * sizes.BODY + j] = item.body[j]
