"""Watches the routes of a skin while it runs: who has one, which loops close, what breaks.

Keeps for every cell whether its chain of parents reaches the PC over live cables, and whether live
cables join it with the PC at all. A change of a parent costs as much as the cells it concerns, so
that it can stay on at any size; one of the cables costs as much as there are cells.
"""

from innervate.networks.skin.protocol import constants as const
from innervate.networks.skin.protocol.constants import NONE, PORTS
from innervate.networks.skin.sim.counters import EARLY, NO_ROUTE
from innervate.scenario.actions.cables import GIVE
from innervate.sim.cables.world import DEAD
from innervate.sim.rows import record_row as note

DROPS = NO_ROUTE - const.DROP_NO_ROUTE  # the counter of a reason to drop stands this far from it

# Codes of the observer's own rows; those below 100 are the protocol's reports.
UNROUTED = 100  # a = connected cells without a route, from now on
LOOP_OPEN = 101  # a = cells in it
LOOP_CLOSED = 102  # a = how long it stood, us
CUT_OFF = 103  # a = index of the scenario's event, b = cells whose chain used it and that are on
APART = 104  # a = cells that are on and that no live cable joins with the PC, b = those since now
JOINED = 105  # a = cells that live cables join with the PC, from now on

# Its numbers in `world.run`: connected cells without a route, and as they were last noted; cells
# cut off, and connected; loops so far, and open ones; what the proofs assume that was left, as
# bits, and the PC's number when all were last looked at (see proved.py).
NUMBERS = ("unrouted", "noted", "apart", "joined", "loops", "loops_open", "outside", "counted")

BROKEN_LOOP = 1
BROKEN_FEASIBLE = 2


def on_report(world, time, node, code, a, b):
    """Count what a node reports, and judge what follows from it for routes."""
    if code == const.REPORT_DROP:
        world.counters[DROPS + a] += 1
        if a == const.DROP_NO_ROUTE and world.run[0].observe and world.watch.had[node] == 0:
            world.counters[EARLY] += 1
        return
    if world.run[0].observe == 0:
        return
    if code == const.REPORT_BROKEN and world.ends[4 * node + a].peer < 0:
        return
    note(world, time, node, code, a, b)
    if code == const.REPORT_PARENT or code == const.REPORT_BALANCE:
        follow(world, time, node, b)
        note_unrouted(world, time, node)


def next_hop(world, cell):
    """The node a cell's data goes to over a live cable, or NONE."""
    port = world.watch.port[cell]
    if port != NONE and world.epoch[4 * cell + port] & 1:
        return NONE
    return peer_of_parent(world, cell)


def follow(world, time, cell, port):
    """A cell takes another parent: settle who has a route now, and which loops open or close."""
    watch = world.watch
    if watch.ring[cell] != NONE:
        close_loop(world, time, cell)
    watch.port[cell] = port
    resettle(world, time, cell)


def resettle(world, time, cell):
    """Work out anew whether a cell has a route, and with it all cells that go through it."""
    watch = world.watch
    hop = next_hop(world, cell)
    routed = 0
    if hop == world.run[0].cells:
        routed = 1
    elif hop != NONE:
        if closes(world, hop, cell):
            open_loop(world, time, cell)
        else:
            routed = watch.routed[hop]
    spread(world, cell, routed)


def closes(world, start, cell):
    """True if the chain of parents from `start` comes to `cell`."""
    node = start
    steps = 0
    while node != NONE and node != world.run[0].cells and steps <= world.run[0].cells:
        if node == cell:
            return True
        if world.watch.ring[node] != NONE:
            return False
        node = next_hop(world, node)
        steps += 1
    return False


def spread(world, cell, routed):
    """Give a cell and all that go through it the same state."""
    watch = world.watch
    if watch.routed[cell] == routed:
        return
    count = 1
    watch.stack[0] = cell
    while count > 0:
        count -= 1
        node = watch.stack[count]
        if watch.routed[node] == routed:
            continue
        watch.routed[node] = routed
        watch.had[node] |= routed
        if watch.joined[node]:
            world.run[0].unrouted += 1 - 2 * routed
        for p in range(PORTS):
            end = 4 * node + p
            peer = world.ends[end].peer
            if peer >= 0 and peer >> 2 < world.run[0].cells:
                child = peer >> 2
                if watch.port[child] == peer & 3 and (world.epoch[end] & 1) == 0:
                    if watch.routed[child] != routed:
                        watch.stack[count] = child
                        count += 1


def open_loop(world, time, cell):
    """The chain from `cell` comes back to it."""
    run = world.run[0]
    node = cell
    length = 0
    while world.watch.ring[node] == NONE:
        world.watch.ring[node] = cell
        node = next_hop(world, node)
        length += 1
    run.loops += 1
    run.loops_open += 1
    note(world, time, cell, LOOP_OPEN, length, 0)
    rule = world.params[0].rule
    loop_free = rule == const.RULE_FEASIBLE or rule == const.RULE_STRICT
    if loop_free and run.checks and run.broken == 0:
        run.broken = BROKEN_LOOP
        run.broken_node = cell
        run.broken_other = next_hop(world, cell)


def close_loop(world, time, cell):
    """A member of a loop leaves it: the loop is gone. Its duration stands in the rows."""
    watch = world.watch
    start = watch.ring[cell]
    node = start
    while node != NONE and node < world.run[0].cells and watch.ring[node] == start:
        watch.ring[node] = NONE
        node = peer_of_parent(world, node)
    world.run[0].loops_open -= 1
    note(world, time, start, LOOP_CLOSED, 0, 0)


def peer_of_parent(world, cell):
    """The node on a cell's parent port, whether or not the cable is live."""
    port = world.watch.port[cell]
    if port == NONE:
        return NONE
    peer = world.ends[4 * cell + port].peer
    if peer < 0:
        return NONE
    return min(peer >> 2, world.run[0].cells)


def remember(world):
    """Before a command: who has a route now."""
    for cell in range(world.run[0].cells):
        world.watch.before[cell] = world.watch.routed[cell]


def on_links_changed(world, time, node, index):
    """Cables or nodes went down or came back: settle everything anew; the cells it cut off."""
    run = world.run[0]
    watch = world.watch
    for cell in range(run.cells):
        if watch.ring[cell] != NONE and ring_is_broken(world, cell):
            close_loop(world, time, cell)
    for cell in range(run.cells):
        watch.routed[cell] = 0
    for cell in range(run.cells):
        if next_hop(world, cell) == run.cells:
            spread(world, cell, 1)
    for cell in range(run.cells):
        if watch.routed[cell] == 0 and watch.ring[cell] == NONE and watch.port[cell] != NONE:
            hop = next_hop(world, cell)
            if hop != NONE and hop < run.cells and closes(world, hop, cell):
                open_loop(world, time, cell)
    trace_cables(world)
    run.unrouted = 0
    lost = 0
    for cell in range(run.cells):
        run.unrouted += watch.joined[cell] & (1 - watch.routed[cell])
        if world.alive[cell] != DEAD:  # who is off has lost more than its way
            lost += watch.before[cell] & (1 - watch.routed[cell])
    note(world, time, node, CUT_OFF, index, lost)
    if index < 0 or not goes_on(world, time):
        note_apart(world, time, node)
        note_unrouted(world, time, node)


def goes_on(world, time):
    """True if something else is done to the network in the same moment.

    What lies in between lasts no time, and nobody was cut off in it.
    """
    after = world.run[0].next_command + 1
    if after >= world.run[0].commands:
        return False
    return world.commands[after].at == time and world.commands[after].action != GIVE


def note_apart(world, time, node):
    """After cables or nodes changed: since when which cells are cut off, rows if that changed."""
    run = world.run[0]
    watch = world.watch
    apart = 0
    fresh = 0
    joined = 0
    for cell in range(run.cells):
        joined += watch.joined[cell]
        if watch.joined[cell] or world.alive[cell] == DEAD:
            watch.apart[cell] = NONE
            continue
        apart += 1
        if watch.apart[cell] == NONE:
            watch.apart[cell] = time
            fresh += 1
    if apart != run.apart or fresh > 0:
        run.apart = apart
        note(world, time, node, APART, apart, fresh)
    if joined != run.joined:
        run.joined = joined
        note(world, time, node, JOINED, joined, 0)


def note_unrouted(world, time, node):
    """A row whenever the number of connected cells without a route has changed."""
    run = world.run[0]
    if run.unrouted != run.noted:
        run.noted = run.unrouted
        note(world, time, node, UNROUTED, run.unrouted, 0)


def ring_is_broken(world, cell):
    """True if some cable of the loop that a cell is in is down."""
    start = world.watch.ring[cell]
    node = start
    for _ in range(world.run[0].cells):
        node = next_hop(world, node)
        if node == NONE or node >= world.run[0].cells:
            return True
        if node == start:
            return False
    return True


def trace_cables(world):
    """From the PC outwards along live cables: who is physically connected."""
    run = world.run[0]
    watch = world.watch
    for cell in range(run.cells):
        watch.joined[cell] = 0
    count = 0
    for end in range(4 * run.cells, len(world.ends)):
        count = join(world, end, count)
    while count > 0:
        count -= 1
        first = 4 * watch.stack[count]
        for end in range(first, first + PORTS):
            count = join(world, end, count)


def join(world, end, count):
    """A live cable joins the cell behind it: it is on the stack now, if it was not before."""
    watch = world.watch
    cell = world.ends[end].peer >> 2
    if cell < 0 or cell >= world.run[0].cells or world.epoch[end] & 1 or watch.joined[cell]:
        return count
    watch.joined[cell] = 1
    watch.stack[count] = cell
    return count + 1
