"""Routes: which are feasible, which is selected, when they expire [3.5, 3.6]."""

from innervate.dialect.arith import MASK30, after, later
from innervate.dialect.outbox import report
from innervate.networks.babel.protocol.common import (
    arm,
    frame_to,
    is_feasible,
    metric_over,
    own_metric,
)
from innervate.networks.babel.protocol.constants import (
    INFINITY,
    NONE,
    PORTS,
    REPORT_ROUTE,
    ROUTE_REQUEST,
    TENTH_MS,
)
from innervate.networks.babel.protocol.requests import ask
from innervate.networks.babel.protocol.updates import trigger


def take(node, params, now, port, frame, out):
    """An update comes in on a port [3.5.3]."""
    if node.number == params.pc or node.neighbour[port] == NONE:
        return
    feasible = is_feasible(node, frame.seq, frame.metric)
    if node.known[port] == 0 and frame.metric == INFINITY:
        return
    if not feasible:
        over = min(frame.metric + node.cost[port], INFINITY)
        if port == node.parent or over < own_metric(node, params):
            ask(node, params, now, port, out)  # [3.8.2.2]
        if port == node.parent:
            return
    node.known[port] = 1
    node.seq[port] = frame.seq
    node.metric[port] = frame.metric
    if frame.metric < INFINITY:
        node.asked[port] = 0
        node.route_us[port] = frame.update * TENTH_MS
        node.route_at[port] = (now + node.route_us[port] * 7 // 2) & MASK30
        arm(node, node.route_at[port], out)


def select(node, params, now, out):
    """Choose among the feasible routes the one with the least metric [3.6]; tell what changes."""
    old = node.parent
    best = INFINITY
    if old != NONE and is_feasible(node, node.seq[old], node.metric[old]):
        best = metric_over(node, old)
    node.parent = old if best < INFINITY else NONE
    for p in range(PORTS):
        over = metric_over(node, p)
        gain = params.margin if node.parent == old and old != NONE else 0
        if over + gain < best and is_feasible(node, node.seq[p], node.metric[p]):
            node.parent = p
            best = over
    if node.parent != old:
        hop = NONE
        if node.parent != NONE:
            hop = node.neighbour[node.parent]
        report(out, REPORT_ROUTE, node.parent, hop)
    if node.number == params.pc:
        return
    if node.parent == NONE:
        if old != NONE:
            node.copies = params.copies - 1
            trigger(node, params, now, out)
            ask(node, params, now, NONE, out)
        return
    answered = node.wanted and not later(node.wanted_seq, node.seq[node.parent])
    if answered:
        node.wanted = 0
    if answered or abs(best - node.said) >= params.nominal:
        trigger(node, params, now, out)


def look_at_route(node, now, p, out):
    """A route that expires is retracted, then forgotten [3.5.3]; before, its neighbour is asked."""
    before = (node.route_at[p] - node.route_us[p] // 2) & MASK30
    if after(now, node.route_at[p]):
        if node.metric[p] == INFINITY:
            node.known[p] = 0
            return
        node.metric[p] = INFINITY
        node.route_at[p] = (now + node.route_us[p] * 7 // 2) & MASK30
    elif p == node.parent and node.asked[p] == 0:
        if not after(now, before):
            arm(node, before, out)
            return
        node.asked[p] = 1
        frame_to(node, p, ROUTE_REQUEST, out)  # [3.8.2.3]
    arm(node, node.route_at[p], out)
