"""How a cell chooses its parent: which ports it may take, and which of them it takes.

A route is safe to take when (sequence number, distance) is nearer than fd, the nearest this cell
has ever announced: fd of a cell is then always worse than its parent's, so parents never close
a ring, whatever is lost or late (rule `feasible`). `strict`, `paper` and `paper-lax` are kept for
comparison. [skin II-B.1, II-B.2, II-B.4, Alg. 2 and 3, E5-E13, E25]
"""

from innervate.protocol.arith import later
from innervate.protocol.outbox import report
from innervate.protocol.rng import draw
from innervate.protocol.skin_words import (
    BALANCE_PAPER,
    INFINITY,
    NONE,
    ONE,
    PORTS,
    REPORT_BALANCE,
    REPORT_PARENT,
    RULE_FEASIBLE,
    RULE_PAPER,
    RULE_STRICT,
)


def is_usable(cell, params, p):
    """1 if the neighbour on p has a route, the cable works and its route is not through us."""
    return cell.dist[p] < params.max_depth and cell.pf[p] < ONE and cell.child[p] == 0


def is_allowed(cell, params, p):
    """1 if a usable port may become the parent under the rule [skin II-B.2, E25, F1, F2]."""
    if params.rule == RULE_FEASIBLE:
        return nearer_than_fd(cell, cell.sq[p], cell.dist[p])
    if cell.sq_known == 0:
        return True
    least = cell.sq_own
    if params.rule == RULE_PAPER and cell.parent != NONE:
        least = cell.sq[cell.parent]  # as last heard; sq_own is that of the last choice
    if later(cell.sq[p], least):
        return True
    return params.rule != RULE_STRICT and cell.sq[p] == least


def nearer_than_fd(cell, sq, dist):
    """1 if (sq, dist) is newer, or as new and nearer, than the best this cell ever announced."""
    if cell.fd_known == 0 or later(sq, cell.fd_sq):
        return True
    return sq == cell.fd_sq and dist < cell.fd_dist


def distance(cell):
    """D: our own hops to the PC; 255 without a route."""
    if cell.parent == NONE:
        return INFINITY
    return min(cell.dist[cell.parent] + 1, INFINITY)


def select(cell, params, may_balance, out):
    """Choose the parent among all ports [skin Alg. 2 and 3, E5-E13]."""
    if cell.wait > 0:
        return
    old = cell.parent
    if old != NONE and not is_usable(cell, params, old):
        cell.parent = NONE
    current = INFINITY
    if cell.parent != NONE:
        current = cell.dist[cell.parent]
    limit = current + may_balance  # a port that is not nearer than this changes nothing
    best = INFINITY
    count = 0
    lightest = NONE
    for p in range(PORTS):
        if cell.dist[p] < limit and p != cell.parent and is_usable(cell, params, p):
            if is_allowed(cell, params, p):
                if cell.dist[p] < best:
                    best = cell.dist[p]
                    count = 1
                    lightest = p
                elif cell.dist[p] == best:
                    count = count + 1
                    if cell.size[p] < cell.size[lightest]:
                        lightest = p
    if best < current:
        cell.parent = pick(cell, params, best, count)
    elif lightest != NONE:
        if is_worth_moving(cell, params, lightest):
            cell.parent = lightest
            report(out, REPORT_BALANCE, old, lightest)
            old = lightest
    if cell.parent != old:
        report(out, REPORT_PARENT, old, cell.parent)
    adopt(cell)


def is_worth_moving(cell, params, p):
    """1 if a port as near as the parent is to take over our data, to balance [skin II-B.4, E12].

    Moving our load from a port with a to one with b lowers the sum of squares if a - b exceeds it.
    Alg. 3 has the sign reversed; its L(q) are loads of subnetworks, as Eq. 2 says.
    """
    more = cell.size[p] - cell.size[cell.parent]
    if params.balance_rule == BALANCE_PAPER:
        return more > cell.own_load
    return -more > cell.own_load


def pick(cell, params, best, count):
    """One of the `count` allowed ports at distance `best`, at random."""
    skip = 0
    if count > 1:
        skip = draw(cell, count)
    chosen = NONE
    for p in range(PORTS):
        if p != cell.parent and is_usable(cell, params, p) and is_allowed(cell, params, p):
            if cell.dist[p] == best and chosen == NONE:
                if skip == 0:
                    chosen = p
                skip = skip - 1
    return chosen


def adopt(cell):
    """Take over the parent's sequence number; fd only ever gets nearer."""
    if cell.parent == NONE:
        return
    cell.hold = 0
    cell.sq_own = cell.sq[cell.parent]
    cell.sq_known = 1
    dist = distance(cell)
    if nearer_than_fd(cell, cell.sq_own, dist):
        cell.fd_known = 1
        cell.fd_sq = cell.sq_own
        cell.fd_dist = dist


def react(cell, params, port, worse, out):
    """select(0) when only `port` changed since the last one; 1 if our own beacon may change.

    No other port was nearer than the parent before. So all need a look only if the parent got
    worse; and a port that is not nearer than the parent changes nothing.
    """
    parent = cell.parent
    if port == parent:
        if worse or not is_usable(cell, params, port):
            select(cell, params, 0, out)
        else:
            adopt(cell)
        return True
    if parent != NONE and cell.dist[port] >= cell.dist[parent]:
        return False
    if cell.wait > 0 or not (is_usable(cell, params, port) and is_allowed(cell, params, port)):
        return False
    report(out, REPORT_PARENT, parent, port)
    cell.parent = port
    adopt(cell)
    return True
