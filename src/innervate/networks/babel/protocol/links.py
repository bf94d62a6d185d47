"""Links: Hellos, IHUs and what a link costs [3.4, A.1, A.2]."""

from innervate.dialect.arith import MASK16, MASK30, after
from innervate.dialect.outbox import report
from innervate.networks.babel.protocol.common import arm, forget_neighbour, frame_to
from innervate.networks.babel.protocol.constants import (
    INFINITY,
    NONE,
    REPORT_LINK,
    ROUTE_REQUEST,
    TENTH_MS,
)


def hear(node, params, now, port, frame, out):
    """A Hello, perhaps with an IHU: history, txcost, cost [3.4.1, 3.4.2, A.1]."""
    ahead = ((frame.hello_no - node.hello_next[port] + 16) & MASK16) - 16
    is_new = node.neighbour[port] != frame.source or ahead > 16
    if is_new:
        if frame.hello == 0:  # nothing is promised, so that nobody could miss it
            return
        forget_neighbour(node, port)
        ahead = 0
    missed = max(ahead, 0)  # "fast-forward"
    undone = max(-ahead, 0)  # "undo history"
    node.history[port] = ((node.history[port] >> undone) & (MASK16 >> missed)) << missed
    node.history[port] = ((node.history[port] << 1) | 1) & MASK16
    node.neighbour[port] = frame.source
    node.hello_next[port] = (frame.hello_no + 1) & MASK16
    if frame.hello:
        node.hello_us[port] = frame.hello * TENTH_MS
        node.hello_at[port] = (now + node.hello_us[port] * 3 // 2) & MASK30
    if frame.rxcost:
        node.txcost[port] = frame.rxcost
        node.ihu_at[port] = (now + node.hello_us[port] * 21 // 2) & MASK30
    arm(node, node.hello_at[port], out)
    judge(node, params, port, out)
    if is_new:
        frame_to(node, port, ROUTE_REQUEST, out)


def hear_ihu(node, params, now, port, frame, out):
    """An IHU that came without a Hello [3.4.2]."""
    if node.neighbour[port] != NONE and frame.rxcost and frame.hello:
        node.txcost[port] = frame.rxcost
        node.ihu_at[port] = (now + frame.hello * TENTH_MS * 7 // 2) & MASK30
        judge(node, params, port, out)


def judge(node, params, p, out):
    """The cost of a port's link [3.4.3, A.2]."""
    was = node.cost[p]
    rxcost = rxcost_of(node, params, p)
    cost = node.txcost[p]
    if rxcost == INFINITY or cost == INFINITY:
        cost = INFINITY
    elif params.etx:
        cost = min(max(cost, 256) * rxcost // 256, INFINITY)
    node.cost[p] = cost
    if (cost == INFINITY) != (was == INFINITY):
        report(out, REPORT_LINK, p, 1 if cost < INFINITY else 0)


def rxcost_of(node, params, p):
    """What came of a neighbour's Hellos, as a cost [A.2.1, A.2.2]."""
    bits = node.history[p] & ((1 << params.up_of) - 1)
    count = 0
    while bits:
        bits = bits & (bits - 1)
        count = count + 1
    if count < params.up_least:
        return INFINITY
    if params.etx:
        return 256 * params.up_of // count
    return params.nominal


def look_at_link(node, params, now, p, out):
    """A Hello that did not come is a 0 in the history; without any 1 the entry goes [A.1]."""
    if after(now, node.hello_at[p]):
        node.history[p] = (node.history[p] << 1) & MASK16
        node.hello_next[p] = (node.hello_next[p] + 1) & MASK16
        node.hello_at[p] = (now + node.hello_us[p]) & MASK30
    if node.txcost[p] < INFINITY and after(now, node.ihu_at[p]):
        node.txcost[p] = INFINITY
    judge(node, params, p, out)
    if node.history[p] == 0:
        forget_neighbour(node, p)
    else:
        arm(node, node.hello_at[p], out)
