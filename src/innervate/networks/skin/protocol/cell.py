"""One cell of a robot's skin: finds its way to the PC, mends it, balances it, forwards touch.

Spec: the dynamic distance-vector protocol of Bader, Bergner and Cheng [skin II-B], with the
readings E1-E34. The paper's master port is called parent here, its slave ports children.
How the parent is chosen stands in route.py.
"""

from innervate.dialect.arith import MASK30, after, later
from innervate.dialect.outbox import FLUSH, URGENT, deliver, report, send, set_timer
from innervate.dialect.rng import draw
from innervate.networks.skin.protocol.command_window import accept_command
from innervate.networks.skin.protocol.constants import (
    BEACON,
    COMMAND,
    DATA,
    DROP_AGAIN,
    DROP_LOOP,
    DROP_NO_ROUTE,
    DROP_TOO_FAR,
    EVERYBODY,
    INFINITY,
    LOAD_MAX,
    MEMORY_LOST,
    NONE,
    ONE,
    PERIODIC,
    PORTS,
    REPORT_BROKEN,
    REPORT_DROP,
    REPORT_FORGET,
    SOON,
    TICK,
    WAVE,
)
from innervate.networks.skin.protocol.route import distance, react, select


def copy_frame(to, frm):
    """Copy a frame, field by field; a beacon has no more than its first six."""
    kind = frm.kind
    dist = frm.dist
    sq = frm.sq
    load = frm.load
    size = frm.size
    parent = frm.parent
    to.kind = kind
    to.dist = dist
    to.sq = sq
    to.load = load
    to.size = size
    to.parent = parent
    if kind == DATA or kind == COMMAND:
        to.cell = frm.cell
        to.hops = frm.hops
        to.seq = frm.seq
        copy_sample(to, frm)


def copy_sample(to, frm):
    """Copy what the sensors say, and what a simulation notes of it."""
    to.made_at = frm.made_at
    to.proximity = frm.proximity
    to.temperature = frm.temperature
    for i in range(3):
        to.force[i] = frm.force[i]
        to.accel[i] = frm.accel[i]


def on_start(cell, params, now, cause, out):
    """Switch on with nothing known; number, rng and choice are the driver's and stay."""
    for p in range(PORTS):
        cell.dist[p] = INFINITY
        cell.sq[p] = cell.load[p] = cell.size[p] = 0
        cell.child[p] = cell.heard[p] = cell.pf[p] = 0
    cell.parent = cell.sent_parent = NONE
    cell.sq_known = cell.sq_own = cell.hold = 0
    cell.fd_known = cell.fd_sq = 0
    cell.fd_dist = INFINITY
    cell.own_load = 1
    cell.sent_dist = -1
    cell.sent_at = (now - params.gap_us) & MASK30
    cell.sent_sq = cell.soon = cell.seq = 0
    cell.last_command = cell.commands = 0
    # Children of our former life give us up within k + 1 of their periods: they hear that we have
    # no route, or nothing. Only then may we take one, or it could lead through them. The tick of
    # now is one of ours, and with clocks 5 % off theirs can be k/9 longer than as many of ours.
    cell.wait = 0
    if cause == MEMORY_LOST:
        cell.wait = params.k + 3 + params.k // 8
    cell.countdown = 0
    if params.balance_periods > 0:
        cell.countdown = 1 + draw(cell, params.balance_periods)
    cell.tick_at = now
    set_timer(out, TICK, now)


def on_frame(cell, params, now, port, frame, out):
    """A frame with a good CRC came in on a port."""
    if frame.kind == BEACON:
        if hear(cell, params, port, frame, out):
            announce_soon(cell, params, now, out)
    elif frame.kind == DATA:
        forward(cell, params, frame, out)
    elif frame.kind == COMMAND:
        hand_down(cell, params, port, frame, out)


def on_timer(cell, params, now, timer, out):
    """TICK: our beacon period. SOON: a triggered beacon that had to keep the gap."""
    if timer == TICK:
        tick(cell, params, now, out)
    else:
        cell.soon = 0
        if is_news(cell, params):
            announce(cell, now, out)


def on_input(cell, params, now, kind, item, out):
    """SAMPLE: our own sensors were read; `item` carries them."""
    if cell.parent == NONE:
        report(out, REPORT_DROP, DROP_NO_ROUTE, 0)
    else:
        frame = out.frame[send(out, cell.parent, 0, 0)]
        frame.kind = DATA
        frame.cell = cell.number
        frame.seq = cell.seq
        frame.hops = 0
        copy_sample(frame, item)
    cell.seq = (cell.seq + 1) & 255


def forward(cell, params, frame, out):
    """Pass a data frame on toward the PC."""
    if frame.hops >= params.max_depth:
        report(out, REPORT_DROP, DROP_LOOP, 0)
    elif cell.parent == NONE:
        report(out, REPORT_DROP, DROP_NO_ROUTE, 0)
    else:
        onward = out.frame[send(out, cell.parent, 0, 0)]
        copy_frame(onward, frame)
        onward.hops = frame.hops + 1


def hand_down(cell, params, port, frame, out):
    """A command: for us, for our children, or for both [skin II-A].

    A cell knows its children, and not who is behind them: a command for one cell goes to all of
    them as well, and ends where it is for.
    """
    if not accept_command(cell, frame.sq):
        report(out, REPORT_DROP, DROP_AGAIN, 0)
        return
    if frame.cell == EVERYBODY or frame.cell == cell.number:
        copy_frame(out.frame[deliver(out, COMMAND)], frame)
    if frame.hops >= params.max_depth:
        report(out, REPORT_DROP, DROP_TOO_FAR, 0)
    elif frame.cell != cell.number:
        for p in range(PORTS):
            if p != port and cell.child[p] and cell.pf[p] < ONE:
                onward = out.frame[send(out, p, 0, 0)]
                copy_frame(onward, frame)
                onward.hops = frame.hops + 1


def hear(cell, params, port, beacon, out):
    """Store what a neighbour says; triggered modes act on it at once [skin II-B.1].

    1 if our own neighbours should hear of it. Asks for no clock: most beacons are no news.
    """
    dist = beacon.dist
    sq = beacon.sq
    load = beacon.load
    size = beacon.size
    child = beacon.parent
    worse = dist > cell.dist[port] or later(cell.sq[port], sq)
    cell.dist[port] = dist
    cell.sq[port] = sq
    cell.load[port] = load
    cell.size[port] = size
    cell.child[port] = child
    cell.heard[port] = 1
    if params.updates != PERIODIC and react(cell, params, port, worse, out):
        return is_news(cell, params)
    return False


def tick(cell, params, now, out):
    """Supervise the links, choose the parent, add up the load, send a beacon on every port."""
    changed = supervise(cell, params, out)
    may_balance = 0
    if params.balance_periods > 0:
        cell.countdown = cell.countdown - 1
        if cell.countdown <= 0:
            may_balance = 1
            cell.countdown = params.balance_periods
    if cell.parent == NONE:
        hold_feasible(cell, params, out)
    # Between ticks `react` keeps the choice up to date, except in periodic mode.
    if changed or may_balance or params.updates == PERIODIC or cell.parent == NONE:
        before = cell.parent
        select(cell, params, may_balance, out)
        # Another cell may have moved in this same turn: do not stay in step with it [skin E14].
        if may_balance and cell.parent != before:
            cell.countdown = 1 + draw(cell, params.balance_periods)
    cell.own_load = sum_load(cell)
    silent = (
        params.updates == WAVE
        and ((now - cell.sent_at) & MASK30) < params.skip_us
        and not is_news(cell, params)
    )
    if not silent:
        announce(cell, now, out)
    cell.tick_at = (cell.tick_at + params.beacon_us) & MASK30
    if after(now, cell.tick_at):
        cell.tick_at = (now + params.beacon_us) & MASK30
    set_timer(out, TICK, cell.tick_at)


def supervise(cell, params, out):
    """Failure penalty of every port, within [0, 2] in units of 1/ONE [skin II-B.3, E16-E19].

    1 if a port broke or works again.
    """
    change = False
    for p in range(PORTS):
        penalty = cell.pf[p]
        if cell.heard[p]:
            after_tick = max(0, penalty - params.r_r)
        else:
            after_tick = min(2 * ONE, penalty + params.r_f)
        cell.heard[p] = 0
        cell.pf[p] = after_tick
        if (after_tick >= ONE) != (penalty >= ONE):
            change = True
            report(out, REPORT_BROKEN, p, 1 if after_tick >= ONE else 0)
    return change


def hold_feasible(cell, params, out):
    """Forget fd after FD_HOLD periods without a route: a restarted PC may count from anew [E27]."""
    cell.wait = max(0, cell.wait - 1)
    cell.hold = cell.hold + 1
    if cell.hold >= params.hold_periods:
        cell.hold = 0
        if cell.fd_known or cell.sq_known:
            report(out, REPORT_FORGET, 0, 0)
        cell.fd_known = 0
        cell.fd_dist = INFINITY
        cell.sq_known = 0


def sum_load(cell):
    """L: ourselves and the load of our children [skin Eq. 1]; saturates."""
    load = 1
    for p in range(PORTS):
        if cell.pf[p] < ONE:
            load = load + cell.child[p] * cell.load[p]
    return min(load, LOAD_MAX)


def is_news(cell, params):
    """1 if our neighbours should hear from us before the next tick."""
    if distance(cell) != cell.sent_dist or cell.parent != cell.sent_parent:
        return True
    return (
        params.updates == WAVE and cell.parent != NONE and later(cell.sq[cell.parent], cell.sent_sq)
    )


def announce_soon(cell, params, now, out):
    """Send at once, or, within GAP of the last beacon, set the send-soon timer."""
    if cell.soon:
        return
    at = (cell.sent_at + params.gap_us) & MASK30
    if after(now, at):
        announce(cell, now, out)
    else:
        cell.soon = 1
        set_timer(out, SOON, at)


def announce(cell, now, out):
    """Send our beacon on every port and remember what we said."""
    size = 0
    if cell.parent != NONE:
        size = cell.size[cell.parent]
    cell.sent_dist = distance(cell)
    cell.sent_parent = cell.parent
    cell.sent_sq = cell.sq_own
    cell.sent_at = now
    send_beacons(cell, size, out)


def send_beacons(cell, size, out):
    """What we said last, on every port, broken ones included; a broken port's queue is given up."""
    load = cell.own_load
    if cell.sq_known == 0:
        load = 0
    dist = cell.sent_dist
    sq = cell.sent_sq
    parent = cell.parent
    for p in range(PORTS):
        flags = URGENT
        if cell.pf[p] >= ONE:
            flags = URGENT | FLUSH
        frame = out.frame[send(out, p, 0, flags)]
        frame.kind = BEACON
        frame.dist = dist
        frame.sq = sq
        frame.load = load
        frame.size = size
        frame.parent = 1 if p == parent else 0
