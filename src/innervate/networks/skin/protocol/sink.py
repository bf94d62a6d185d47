"""The PC end of a skin: one logical node with an interface port per cable [skin 4, E27].

It starts every route (distance 0), counts the sequence number up every M periods, tells each
port how many cells it serves, delivers the touch that arrives, and sends commands down.
State: `pc.own[0]` (declared as SINK) and `pc.size[port]` (SINK_PORT).
"""

from innervate.dialect.arith import MASK16, MASK30, after, later
from innervate.dialect.outbox import URGENT, deliver, send, set_timer
from innervate.networks.skin.protocol.cell import copy_frame
from innervate.networks.skin.protocol.constants import BEACON, COMMAND, DATA, GIVE, TICK


def on_start(pc, params, now, cause, out):
    """Listen for k periods before the first beacon: a restarted PC learns the newest number."""
    own = pc.own[0]
    own.sq = 0
    own.sq_known = 0
    own.periods = 0
    own.listen = params.k
    own.repair = 0
    # Cells still know our last numbers: begin where they do not end.
    own.command = (now >> 8) & MASK16
    for p in range(own.ports):
        pc.size[p] = 0
    own.tick_at = now
    set_timer(out, TICK, now)


def on_frame(pc, params, now, port, frame, out):
    """A beacon tells the load of the port, and perhaps a number newer than ours."""
    if frame.kind == DATA:
        copy_frame(out.frame[deliver(out, DATA)], frame)
        return
    if frame.kind != BEACON:
        return
    pc.size[port] = frame.load if frame.parent else 0
    own = pc.own[0]
    # load 0 marks a cell that never had a route: its number means nothing.
    if frame.load > 0 and (own.sq_known == 0 or later(frame.sq, own.sq)):
        own.sq = frame.sq
        own.sq_known = 1


def on_timer(pc, params, now, timer, out):
    """Every T_b: a beacon on every port, with a new number every M periods."""
    own = pc.own[0]
    if own.listen > 0:
        own.listen = own.listen - 1
    else:
        own.periods = own.periods + 1
        if own.periods >= params.seq_every:
            own.periods = 0
            own.sq = (own.sq + 1) & MASK16
        own.sq_known = 1
        announce(pc, out)
    set_tick(pc, params, now, out)


def announce(pc, out):
    """A beacon on every port: distance 0, the number, the cells that the port serves."""
    own = pc.own[0]
    for p in range(own.ports):
        frame = out.frame[send(out, p, 0, URGENT)]
        frame.kind = BEACON
        frame.dist = 0
        frame.sq = own.sq
        frame.load = 0
        frame.size = pc.size[p]
        frame.parent = 0


def set_tick(pc, params, now, out):
    """Set the timer of the next period."""
    own = pc.own[0]
    own.tick_at = (own.tick_at + params.beacon_us) & MASK30
    if after(now, own.tick_at):
        own.tick_at = (now + params.beacon_us) & MASK30
    set_timer(out, TICK, own.tick_at)


def on_input(pc, params, now, kind, item, out):
    """GIVE: a command for a cell or all, to every interface port that has a child [skin II-A]."""
    if kind != GIVE:
        return
    own = pc.own[0]
    own.command = (own.command + 1) & MASK16
    item.kind = COMMAND
    for p in range(own.ports):
        if pc.size[p] > 0:
            frame = out.frame[send(out, p, 0, 0)]
            copy_frame(frame, item)
            frame.sq = own.command
            frame.hops = 0
