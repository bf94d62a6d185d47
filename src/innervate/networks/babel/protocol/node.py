"""A node of Babel: what it does when something happens."""

from innervate.dialect.arith import MASK16, MASK30, after
from innervate.dialect.outbox import deliver, report, send, set_timer
from innervate.networks.babel.protocol.common import arm, forget_neighbour, frame_to, own_metric
from innervate.networks.babel.protocol.constants import (
    ACK,
    ACK_REQUEST,
    DATA,
    HELLO,
    HOPS_MAX,
    IHU,
    INFINITY,
    NONE,
    PORTS,
    REPORT_DROP,
    ROUTE_REQUEST,
    SEQNO_REQUEST,
    SOON,
    TENTH_MS,
    TICK,
    UPDATE,
    WANTED_MAX,
)  # fmt: skip
from innervate.networks.babel.protocol.links import hear, hear_ihu, look_at_link, rxcost_of
from innervate.networks.babel.protocol.requests import send_request, take_request, want
from innervate.networks.babel.protocol.routes import look_at_route, select, take
from innervate.networks.babel.protocol.updates import between, fill_route, send_update, trigger

TIMERS = 3
OUTBOX = 34


def on_start(node, params, now, cause, out):
    """Switch on: only our seqno is kept, as in stable storage."""
    node.beats = 1
    for p in range(PORTS):
        forget_neighbour(node, p)
    node.parent = NONE
    node.said = INFINITY
    node.hello_no = node.soon = node.copies = node.looking = 0
    node.fd_known = node.wanted = node.wanted_tries = 0
    node.tick_at = now
    set_timer(out, TICK, now)


def on_frame(node, params, now, port, frame, out):
    """A frame came in on a port."""
    if frame.kind == HELLO:
        hear(node, params, now, port, frame, out)
        if frame.has_update:
            take(node, params, now, port, frame, out)
        select(node, params, now, out)
    elif frame.kind == UPDATE:
        take(node, params, now, port, frame, out)
        select(node, params, now, out)
    elif frame.kind == ROUTE_REQUEST:
        send_update(node, params, now, port, out)
    elif frame.kind == SEQNO_REQUEST:
        take_request(node, params, now, port, frame, out)
    elif frame.kind == DATA:
        forward(node, params, frame, out)
    elif frame.kind == IHU:
        hear_ihu(node, params, now, port, frame, out)
        select(node, params, now, out)
    elif frame.kind == ACK_REQUEST:  # "every Babel speaker MUST be able to reply" [3.3]
        frame_to(node, port, ACK, out).value = frame.value


def on_timer(node, params, now, timer, out):
    """A timer of ours is due."""
    if timer == TICK:
        tick(node, params, now, out)
    elif timer == SOON:
        node.soon = 0
        for p in range(PORTS):
            if p != node.parent:  # split horizon [3.7.4]
                send_update(node, params, now, p, out)
        node.said = own_metric(node, params)
        if node.copies > 0:
            node.copies = node.copies - 1
            trigger(node, params, now, out)
    else:
        node.looking = 0
        look(node, params, now, out)
        select(node, params, now, out)


def on_input(node, params, now, kind, item, out):
    """Our user has data for the PC."""
    if node.number == params.pc:
        return
    if node.parent == NONE:
        report(out, REPORT_DROP, 0, 0)
        return
    frame = out.frame[send(out, node.parent, 0, 0)]
    frame.kind = DATA
    frame.source = node.number
    frame.hops = 0
    frame.value = item.value
    frame.made_at = item.made_at


def forward(node, params, frame, out):
    """Pass data on toward the PC; there it is handed up."""
    if node.number == params.pc:
        onward = out.frame[deliver(out, DATA)]
    elif node.parent == NONE or frame.hops >= HOPS_MAX:
        report(out, REPORT_DROP, frame.hops, 0)
        return
    else:
        onward = out.frame[send(out, node.parent, 0, 0)]
    onward.kind = DATA
    onward.source = frame.source
    onward.hops = min(frame.hops + 1, 255)
    onward.value = frame.value
    onward.made_at = frame.made_at


def tick(node, params, now, out):
    """Hellos and IHUs on all ports [3.4]; with every `update_hellos`th an update [3.7.1]."""
    node.hello_no = (node.hello_no + 1) & MASK16
    node.beats = node.beats - 1
    has_update = node.beats <= 0 and (node.fd_known or own_metric(node, params) < INFINITY)
    if node.beats <= 0:
        node.beats = between(params)
    for p in range(PORTS):
        frame = frame_to(node, p, HELLO, out)
        frame.hello_no = node.hello_no
        frame.hello = params.hello_us // TENTH_MS
        frame.rxcost = rxcost_of(node, params, p)
        frame.has_update = 1 if has_update and p != node.parent else 0
        fill_route(node, params, now, frame, frame.has_update, out)
    if has_update:
        node.said = own_metric(node, params)
    node.tick_at = (node.tick_at + params.hello_us) & MASK30
    if after(now, node.tick_at):
        node.tick_at = (now + params.hello_us) & MASK30
    set_timer(out, TICK, node.tick_at)


def look(node, params, now, out):
    """Missing Hellos and IHUs, routes, the feasibility distance, requests; look again in time."""
    for p in range(PORTS):
        if node.neighbour[p] != NONE:
            look_at_link(node, params, now, p, out)
        if node.known[p]:
            look_at_route(node, now, p, out)
    if node.fd_known:
        if after(now, node.fd_at):
            node.fd_known = 0
            node.said = INFINITY
        else:
            arm(node, node.fd_at, out)
    if node.wanted:
        if after(now, node.wanted_at):
            if node.wanted_tries > 0:
                again = node.wanted_tries - 1
                wait = min(2 * node.wanted_us, WANTED_MAX)
                want(node, now, node.wanted_seq, wait, again, out)
                send_request(node, NONE, node.wanted_seq, HOPS_MAX, out)
            else:
                node.wanted = 0
        else:
            arm(node, node.wanted_at, out)
