"""The static baseline: a breadth-first tree built once; after a failure everything restarts.

[skin I-A, II-A] The PC floods a set-up frame with a new number; a cell takes the port it first
hears it on as parent and passes it on after a random delay, hence trees differ from start to
start. Beacons only keep watch over the cables. A cell whose parent is lost floods a restart; the
PC waits `restart_us` (about 2 s) and sets the network up anew. No balancing.
It uses the state of skin.py: sq_own numbers the set-up, sent_dist and sent_sq are what we pass on.
"""

from innervate.dialect.arith import MASK16, MASK30, after, later
from innervate.dialect.outbox import URGENT, report, send, set_timer
from innervate.dialect.rng import draw
from innervate.networks.skin.protocol import cell as skin
from innervate.networks.skin.protocol import sink as skin_sink
from innervate.networks.skin.protocol.constants import (
    BEACON,
    COMMAND,
    INFINITY,
    NONE,
    ONE,
    PORTS,
    REPORT_BROKEN,
    REPORT_PARENT,
    RESTART,
    SOON,
    TICK,
)


def on_start(cell, params, now, cause, out):
    """Switch on with nothing known."""
    skin.on_start(cell, params, now, cause, out)
    cell.sent_dist = INFINITY


def on_frame(cell, params, now, port, frame, out):
    """Keep watch, join the first set-up heard, pass restarts, data and commands on."""
    if frame.kind == BEACON:
        cell.dist[port] = frame.dist
        cell.sq[port] = frame.sq
        cell.load[port] = frame.load
        cell.child[port] = frame.parent
        cell.heard[port] = 1
        fresh = cell.sq_known == 0 or later(frame.sq, cell.sq_own)
        if fresh and frame.dist < params.max_depth and frame.parent == 0:
            if cell.wait > 0:
                # Back in a network that is set up: what goes through us must be set up anew.
                cell.wait = 0
                cell.sq_own = frame.sq
                cell.sq_known = 1
            else:
                join(cell, params, now, port, out)
    elif frame.kind == RESTART:
        if cell.sq_known and frame.sq == cell.sq_own and cell.parent != NONE:
            give_up(cell, out)
    elif frame.kind == COMMAND:
        skin.hand_down(cell, params, port, frame, out)
    else:
        skin.forward(cell, params, frame, out)


def on_timer(cell, params, now, timer, out):
    """TICK: keep watch. SOON: pass the set-up on."""
    if timer == SOON:
        cell.soon = 0
        cell.sent_dist = skin.distance(cell)
        cell.sent_sq = cell.sq_own
        skin.send_beacons(cell, 0, out)
        return
    skin.supervise(cell, params, out)
    cell.own_load = skin.sum_load(cell)
    if cell.parent != NONE and cell.pf[cell.parent] >= ONE:
        give_up(cell, out)
    elif cell.parent == NONE and cell.sq_known:
        flood_restart(cell, out)
    skin.send_beacons(cell, 0, out)
    cell.tick_at = (cell.tick_at + params.beacon_us) & MASK30
    if after(now, cell.tick_at):
        cell.tick_at = (now + params.beacon_us) & MASK30
    set_timer(out, TICK, cell.tick_at)


def join(cell, params, now, port, out):
    """The first set-up frame of a new number decides the parent."""
    report(out, REPORT_PARENT, cell.parent, port)
    # A set-up frame came over this cable: what was missed before it, while the PC listened, is old.
    if cell.pf[port] >= ONE:
        report(out, REPORT_BROKEN, port, 0)
    cell.pf[port] = 0
    cell.parent = port
    cell.sq_own = cell.sq[port]
    cell.sq_known = 1
    cell.soon = 1
    spread = params.forward_max_us - params.forward_min_us + 1
    wait = params.forward_min_us + draw(cell, spread)
    set_timer(out, SOON, (now + wait) & MASK30)


def give_up(cell, out):
    """The route is lost: have the whole network restarted."""
    report(out, REPORT_PARENT, cell.parent, NONE)
    cell.parent = NONE
    cell.sent_dist = INFINITY
    flood_restart(cell, out)


def flood_restart(cell, out):
    """Tell every neighbour that this set-up is over."""
    for p in range(PORTS):
        frame = out.frame[send(out, p, 0, URGENT)]
        frame.kind = RESTART
        frame.dist = INFINITY
        frame.sq = cell.sq_own
        frame.load = 0
        frame.size = 0
        frame.parent = 0


def sink_frame(pc, params, now, port, frame, out):
    """As in skin_sink; a restart that concerns this set-up starts the dead time."""
    if frame.kind == RESTART:
        own = pc.own[0]
        if own.repair == 0 and own.sq_known and frame.sq == own.sq:
            own.repair = 1
            set_timer(out, SOON, (now + params.restart_us) & MASK30)
    else:
        skin_sink.on_frame(pc, params, now, port, frame, out)


def sink_timer(pc, params, now, timer, out):
    """TICK: listen, then set up once, then keep watch. SOON: the dead time is over, set up anew."""
    own = pc.own[0]
    if timer == SOON:
        own.repair = 0
        own.sq = (own.sq + 1) & MASK16
        skin_sink.announce(pc, out)
        return
    if own.listen > 0:
        own.listen = own.listen - 1
        if own.listen == 0:
            own.sq = (own.sq + 1) & MASK16
            own.sq_known = 1
    else:
        skin_sink.announce(pc, out)
    skin_sink.set_tick(pc, params, now, out)
