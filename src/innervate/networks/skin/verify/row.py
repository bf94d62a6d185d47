"""From a row of bytes to the protocol's records and back; see world.py for the row.

What no choice of a route depends on is left out: clock readings (nothing has a time here), sizes
and how great a load is (balancing is off; only load 0, which marks a cell without a number,
counts), and whether a port was heard since the last tick (an event decides that).
"""

from innervate.dialect.arith import MASK30
from innervate.networks.skin.protocol.constants import BEACON, INFINITY, NONE, ONE, PORTS
from innervate.networks.skin.verify import world as w

NOTHING_SENT = 254

# Bits of a cell's FLAGS, of a port's SAYS and of a frame's last byte.
SQ_KNOWN, FD_KNOWN, IS_SOON, HAS_TICKED = 1, 2, 4, 8
LOADED, IS_CHILD = 1, 2
PENALTY = 4  # two bits
IS_PARENT, WAS_PARENT = 16, 32


def load_cell(world, c, i):
    """Cell `c` of the row into scratch record `i`."""
    row = world.work
    cell = world.cells[i]
    at = world.cell_at[c]
    flags = row[at + w.FLAGS]
    cell.sq_known = flags & SQ_KNOWN
    cell.fd_known = (flags & FD_KNOWN) >> 1
    cell.soon = (flags & IS_SOON) >> 2
    cell.sq_own = row[at + w.SQ_OWN]
    cell.fd_sq = row[at + w.FD_SQ]
    cell.fd_dist = row[at + w.FD_DIST]
    cell.hold = row[at + w.HOLD]
    cell.wait = row[at + w.WAIT]
    cell.sent_sq = row[at + w.SENT_SQ]
    sent = row[at + w.SENT_DIST]
    cell.sent_dist = -1 if sent == NOTHING_SENT else sent
    cell.parent = NONE
    cell.sent_parent = NONE
    cell.own_load = 1
    # The gap has passed since never; after a first beacon no time passes.
    cell.sent_at = (0 - world.params[0].gap_us) & MASK30 if sent == NOTHING_SENT else 0
    cell.tick_at = 0
    for p in range(PORTS):
        load_port(row, cell, p, world.port_at[PORTS * c + p], flags & HAS_TICKED)


def load_port(row, cell, p, at, has_ticked):
    """One port; a socket without a cable is broken from the first tick on."""
    cell.size[p] = 0
    cell.heard[p] = 0
    if at < 0:
        cell.dist[p] = INFINITY
        cell.sq[p] = 0
        cell.load[p] = 0
        cell.child[p] = 0
        cell.pf[p] = 2 * ONE if has_ticked else 0
        return
    says = row[at + w.SAYS]
    cell.dist[p] = row[at + w.DIST]
    cell.sq[p] = row[at + w.SQ]
    cell.load[p] = says & LOADED
    cell.child[p] = (says & IS_CHILD) >> 1
    cell.pf[p] = ((says >> 2) & 3) * ONE
    if says & IS_PARENT:
        cell.parent = p
    if says & WAS_PARENT:
        cell.sent_parent = p


def save_cell(world, c, has_ticked):
    """Scratch record 0 into the row as cell `c`."""
    row = world.work
    cell = world.cells[0]
    at = world.cell_at[c]
    flags = (row[at + w.FLAGS] & HAS_TICKED) | has_ticked
    row[at + w.FLAGS] = flags | cell.sq_known | (cell.fd_known << 1) | (cell.soon << 2)
    row[at + w.SQ_OWN] = cell.sq_own & 255
    row[at + w.FD_SQ] = cell.fd_sq & 255
    row[at + w.FD_DIST] = cell.fd_dist
    row[at + w.HOLD] = min(cell.hold, 255)
    row[at + w.WAIT] = min(cell.wait, 255)
    if world.at[w.MERGE]:  # what was sent last matters between ticks only
        row[at + w.SENT_DIST] = NOTHING_SENT
        row[at + w.SENT_SQ] = 0
    else:
        row[at + w.SENT_DIST] = NOTHING_SENT if cell.sent_dist < 0 else cell.sent_dist
        row[at + w.SENT_SQ] = cell.sent_sq & 255
    for p in range(PORTS):
        slot = world.port_at[PORTS * c + p]
        if slot >= 0:
            says = min(cell.load[p], 1) | (cell.child[p] << 1) | ((cell.pf[p] // ONE) << 2)
            if cell.parent == p:
                says |= IS_PARENT
            if cell.sent_parent == p and world.at[w.MERGE] == 0:
                says |= WAS_PARENT
            row[slot + w.DIST] = cell.dist[p]
            row[slot + w.SQ] = cell.sq[p] & 255
            row[slot + w.SAYS] = says


def load_pc(world):
    """The PC of the row into its record."""
    row = world.work
    own = world.pc.own[0]
    at = world.at[w.PC_AT]
    own.sq = row[at + w.PC_SQ]
    own.sq_known = row[at + w.PC_FLAGS]
    own.periods = row[at + w.PC_PERIODS]
    own.listen = row[at + w.PC_LISTEN]
    own.tick_at = 0
    for p in range(own.ports):
        world.pc.size[p] = 0


def save_pc(world):
    """The PC's record into the row."""
    row = world.work
    own = world.pc.own[0]
    at = world.at[w.PC_AT]
    row[at + w.PC_SQ] = own.sq & 255
    row[at + w.PC_FLAGS] = own.sq_known
    row[at + w.PC_PERIODS] = own.periods
    row[at + w.PC_LISTEN] = own.listen


def is_up(world, link):
    """1 if the cable is not cut."""
    return world.work[world.at[w.LINK_AT] + link] == 0


def has_budget(world, which):
    """1 if this fault may still happen."""
    at = world.at[w.BUDGET_AT]
    return world.work[at + which] > 0 and world.work[at + w.TOTAL] > 0


def spend(world, which):
    """Let this fault happen; 0 if it may not. Without faults left all budgets read 0."""
    if not has_budget(world, which):
        return False
    row = world.work
    at = world.at[w.BUDGET_AT]
    row[at + which] -= 1
    row[at + w.TOTAL] -= 1
    if row[at + w.TOTAL] == 0:
        for i in range(w.BUDGETS):
            row[at + i] = 0
    return True


# Frames in flight.


def push(world, way, frame):
    """A beacon goes out, unless nobody could tell the difference."""
    row = world.work
    at = world.queue_at[way]
    count = row[at]
    dist = frame.dist
    sq = frame.sq & 255
    says = min(frame.load, 1) | (frame.parent << 1)
    if world.at[w.UNREDUCED] == 0 and is_idle(world, way, count, dist, sq, says):
        return
    if count >= world.at[w.CAPACITY]:
        world.found[0] = w.NO_ROOM
        return
    slot = at + 1 + w.FRAME_BYTES * count
    row[slot + w.DIST] = dist
    row[slot + w.SQ] = sq
    row[slot + w.SAYS] = says
    row[at] = count + 1


def is_idle(world, way, count, dist, sq, says):
    """1 if a beacon changes nothing whenever it arrives: it is for the PC and tells no newer
    number; or, with MERGE, it repeats the one before it, or its receiver never looks again.
    """
    row = world.work
    end = world.way_end[way]
    cells = world.at[w.CELLS]
    if end >= PORTS * cells:
        pc = world.at[w.PC_AT]
        # A number that is not newer changes nothing unless the PC loses its memory.
        if row[pc + w.PC_COUNTS] == 0 and world.at[w.KEEP] == 0:
            return True
        known = row[pc + w.PC_FLAGS] and row[pc + w.PC_SQ] >= sq
        may_forget = has_budget(world, w.RESTART) or world.at[w.FAIR]
        return (says & LOADED) == 0 or (known and not may_forget)
    if world.at[w.MERGE] == 0:
        return False
    c = end // PORTS
    if row[world.cell_at[c] + w.TICKS] == 0 and world.at[w.KEEP] == 0:
        return True
    if count > 0:
        slot = world.queue_at[way] + 1 + w.FRAME_BYTES * (count - 1)
    else:
        slot = world.port_at[end]
    return (
        row[slot + w.DIST] == dist and row[slot + w.SQ] == sq and (row[slot + w.SAYS] & 3) == says
    )


def take(world, way, i):
    """The oldest frame of a direction into frame record `i`; the others move up."""
    row = world.work
    at = world.queue_at[way]
    frame = world.frame[i]
    frame.kind = BEACON
    frame.dist = row[at + 1 + w.DIST]
    frame.sq = row[at + 1 + w.SQ]
    says = row[at + 1 + w.SAYS]
    frame.load = says & LOADED
    frame.parent = (says & IS_CHILD) >> 1
    frame.size = 0
    drop(world, way)


def drop(world, way):
    """The oldest frame of a direction is gone."""
    drop_one(world.work, world.queue_at[way], 0)


def drop_one(row, at, i):
    """Frame `i` of a queue is gone."""
    last = at + 1 + w.FRAME_BYTES * (row[at] - 1)
    for k in range(at + 1 + w.FRAME_BYTES * i, last):
        row[k] = row[k + w.FRAME_BYTES]
    for k in range(last, last + w.FRAME_BYTES):
        row[k] = 0
    row[at] -= 1


def clear(world, way):
    """All frames of a direction are gone."""
    row = world.work
    at = world.queue_at[way]
    for i in range(at, at + 1 + w.FRAME_BYTES * row[at]):
        row[i] = 0


def trim(world, c):
    """With MERGE: forget frames to a cell that say what it last heard, or that it never hears.

    Of a cell that never ticks again nothing but its parent and feasible distance matters.
    """
    row = world.work
    head = world.cell_at[c]
    is_over = row[head + w.TICKS] == 0 and world.at[w.KEEP] == 0
    if is_over:
        row[head + w.FLAGS] &= FD_KNOWN
        row[head + w.SQ_OWN] = 0
        row[head + w.HOLD] = 0
        row[head + w.WAIT] = 0
    for p in range(PORTS):
        slot = world.port_at[PORTS * c + p]
        if slot < 0:
            continue
        way = world.in_way[PORTS * c + p]
        at = world.queue_at[way]
        if is_over:
            clear(world, way)
            row[slot + w.DIST] = 0
            row[slot + w.SQ] = 0
            row[slot + w.SAYS] &= IS_PARENT
        while row[at] > 0 and is_same(row, at + 1, slot):
            drop(world, way)


def is_same(row, frame, port):
    """1 if a frame says what the port last heard."""
    return (
        row[frame + w.DIST] == row[port + w.DIST]
        and row[frame + w.SQ] == row[port + w.SQ]
        and row[frame + w.SAYS] == (row[port + w.SAYS] & 3)
    )


def next_draw(world):
    """What the next draw of a fair round gives."""
    made = world.draws[0]
    return world.draws[1 + made] if made < w.DRAWS else 0


def note_draw(world, asked):
    """A draw of a fair round was made, out of so many."""
    made = world.draws[0]
    if made < w.DRAWS:
        world.draws[1 + w.DRAWS + made] = asked
    world.draws[0] = made + 1
