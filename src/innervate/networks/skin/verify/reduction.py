"""What of a skin's state can no longer matter, set to one value: fewer states, the same futures.

Every rule here has its reason in docs/verify.md ("What is left out"); tests compare the routes
that are reached with and without, and that a step and this can change places.
"""

from innervate.dialect.arith import later
from innervate.networks.skin.protocol.constants import INFINITY, PERIODIC, PORTS
from innervate.networks.skin.verify import row as rows
from innervate.networks.skin.verify import world as w

# A port that never works again: no route, and a penalty of 2.
GONE = 8
PENALTY = 12  # the bits of SAYS that hold it


def tidy(world):
    """Forget what no future of the state in `world.work` depends on."""
    for c in range(world.at[w.CELLS]):
        if (
            world.at[w.MERGE]
            and world.at[w.KEEP] == 0
            and world.work[world.cell_at[c] + w.TICKS] == 0
        ):
            tidy_feasible(world, c)  # it never looks at anything again (see skin_row.trim)
        else:
            tidy_cell(world, c)
    tidy_sink(world)
    first = PORTS * world.at[w.CELLS]
    for p in range(world.pc.own[0].ports):
        tidy_sink_queue(world, world.in_way[first + p])


def tidy_feasible(world, c):
    """No other rule than `feasible` reads the feasible distance, and it only one that is set."""
    row = world.work
    at = world.cell_at[c]
    if world.at[w.FEASIBLE] == 0 or row[at + w.FLAGS] & rows.FD_KNOWN == 0:
        row[at + w.FLAGS] &= ~rows.FD_KNOWN
        row[at + w.FD_SQ] = 0
        row[at + w.FD_DIST] = 0


def tidy_sink(world):
    """A PC that never sends again."""
    row = world.work
    at = world.at[w.PC_AT]
    if row[at + w.PC_COUNTS] == 0 and world.at[w.KEEP] == 0:
        row[at + w.PC_SQ] = 0
        row[at + w.PC_FLAGS] = 0
        row[at + w.PC_PERIODS] = 0
        row[at + w.PC_LISTEN] = 0


def tidy_cell(world, c):
    """A cell, and what is on its way to it."""
    row = world.work
    at = world.cell_at[c]
    keeps_fd = holds_feasible(world, c)
    row[at + w.SENT_SQ] = 0  # written before every beacon, and read by no rule of these updates
    if world.at[w.FEASIBLE] or world.params[0].updates == PERIODIC:
        row[at + w.FLAGS] &= ~rows.HAS_TICKED  # asks once for a choice that is up to date already
    if keeps_fd:
        row[at + w.HOLD] = 0
    tidy_feasible(world, c)
    parent = -1
    for p in range(PORTS):
        slot = world.port_at[PORTS * c + p]
        if slot >= 0:
            if row[slot + w.SAYS] & rows.IS_PARENT:
                parent = slot
            tidy_port(world, c, p, slot, keeps_fd)
            tidy_queue(world, c, p, slot, keeps_fd)
    tidy_news(row, at, parent)
    if parent < 0 and keeps_fd and is_number_dead(world, c):
        row[at + w.SQ_OWN] = 0


def holds_feasible(world, c):
    """1 if the cell cannot forget its feasible distance any more within its ticks.

    The fair schedule tries every number of periods that may have passed (fair.py).
    """
    if world.at[w.KEEP]:
        return world.at[w.HELD] > 0
    at = world.cell_at[c]
    ticks = world.work[at + w.TICKS]
    return ticks == w.ANY or world.work[at + w.HOLD] + ticks < world.params[0].hold_periods


def is_dead_route(world, c, sq, dist, keeps_fd):
    """1 if a port that is not the parent and says this can never become the parent."""
    row = world.work
    at = world.cell_at[c]
    if dist == INFINITY:
        return True
    if not keeps_fd:
        return False
    if world.at[w.RISING] and row[at + w.FLAGS] & rows.SQ_KNOWN:
        return not later(sq, row[at + w.SQ_OWN])
    if world.at[w.FEASIBLE] == 0 or (row[at + w.FLAGS] & rows.FD_KNOWN) == 0:
        return False
    if later(sq, row[at + w.FD_SQ]):
        return False
    return sq != row[at + w.FD_SQ] or dist >= row[at + w.FD_DIST]


def is_gone(world, c, p, slot):
    """1 if a port never works again."""
    row = world.work
    penalty = (row[slot + w.SAYS] & PENALTY) >> 2
    if world.at[w.KEEP] == 0 and penalty > row[world.cell_at[c] + w.TICKS]:
        return True
    link = world.in_way[PORTS * c + p] // 2
    if rows.is_up(world, link) or rows.has_budget(world, w.HEAL):
        return False
    return penalty > 0 or (world.at[w.STEADY] and row[slot + w.DIST] == INFINITY)


def tidy_port(world, c, p, slot, keeps_fd):
    """What a port last heard."""
    row = world.work
    row[slot + w.SAYS] &= ~rows.LOADED
    is_parent = row[slot + w.SAYS] & rows.IS_PARENT
    is_dead = row[slot + w.SAYS] & rows.IS_CHILD or row[slot + w.DIST] == INFINITY
    if not is_parent:
        sq, dist = row[slot + w.SQ], row[slot + w.DIST]
        is_dead = is_dead or is_dead_route(world, c, sq, dist, keeps_fd)
    if is_dead:
        row[slot + w.DIST] = INFINITY
        row[slot + w.SQ] = 0
        row[slot + w.SAYS] &= ~rows.IS_CHILD
    if not is_parent and is_gone(world, c, p, slot):
        row[slot + w.DIST] = INFINITY
        row[slot + w.SQ] = 0
        row[slot + w.SAYS] = GONE | (row[slot + w.SAYS] & rows.WAS_PARENT)
        rows.clear(world, world.in_way[PORTS * c + p])


def tidy_queue(world, c, p, slot, keeps_fd):
    """Frames that change nothing: the oldest while they repeat what the port last heard."""
    row = world.work
    way = world.in_way[PORTS * c + p]
    at = world.queue_at[way]
    for i in range(row[at]):
        frame = at + 1 + w.FRAME_BYTES * i
        row[frame + w.SAYS] &= ~rows.LOADED
        if row[frame + w.DIST] == INFINITY or row[frame + w.SAYS] & rows.IS_CHILD:
            row[frame + w.DIST] = INFINITY
            row[frame + w.SQ] = 0
            row[frame + w.SAYS] = 0
    if world.at[w.STEADY]:
        drop_repeated(world, way)
    is_closed = row[slot + w.DIST] == INFINITY and (row[slot + w.SAYS] & rows.IS_PARENT) == 0
    while row[at] > 0:
        dist, sq = row[at + 1 + w.DIST], row[at + 1 + w.SQ]
        is_same = world.at[w.STEADY] and dist == row[slot + w.DIST] and sq == row[slot + w.SQ]
        if not is_same and not (is_closed and is_dead_route(world, c, sq, dist, keeps_fd)):
            break
        rows.drop(world, way)


def drop_repeated(world, way):
    """Of equal frames one after the other the first stays: it may be lost where they may, too."""
    row = world.work
    at = world.queue_at[way]
    i = 1
    while i < row[at]:
        here = at + 1 + w.FRAME_BYTES * i
        if same_frame(row, here, here - w.FRAME_BYTES):
            rows.drop_one(row, at, i)
        else:
            i += 1


def same_frame(row, a, b):
    """1 if two frames say the same."""
    return (
        row[a + w.DIST] == row[b + w.DIST]
        and row[a + w.SQ] == row[b + w.SQ]
        and row[a + w.SAYS] == row[b + w.SAYS]
    )


def tidy_news(row, at, parent):
    """A timer for news that are none any more: firing it would change nothing."""
    if row[at + w.FLAGS] & rows.IS_SOON == 0 or row[at + w.SENT_DIST] == rows.NOTHING_SENT:
        return
    dist = INFINITY
    if parent >= 0:
        dist = min(row[parent + w.DIST] + 1, INFINITY)
    if dist != row[at + w.SENT_DIST]:
        return
    if parent < 0 or row[parent + w.SAYS] & rows.WAS_PARENT:
        row[at + w.FLAGS] &= ~rows.IS_SOON


def is_number_dead(world, c):
    """1 if the number of a cell without a route is of no use: only the PC would look at it."""
    if world.at[w.FEASIBLE] == 0:
        return False
    row = world.work
    first = PORTS * world.at[w.CELLS]
    for p in range(PORTS):
        way = world.out_way[PORTS * c + p]
        if way >= 0 and world.way_end[way] >= first:
            return is_known(world, row[world.cell_at[c] + w.SQ_OWN])
    return True


def is_known(world, sq):
    """1 if a number tells the PC nothing, now or later."""
    pc = world.at[w.PC_AT]
    if world.work[pc + w.PC_COUNTS] == 0 and world.at[w.KEEP] == 0:
        return True
    return is_old(world, sq) and not rows.has_budget(world, w.RESTART)


def is_old(world, sq):
    """1 if the PC has this number or a newer one."""
    pc = world.at[w.PC_AT]
    return world.work[pc + w.PC_FLAGS] and world.work[pc + w.PC_SQ] >= sq


def tidy_sink_queue(world, way):
    """Frames to the PC that tell it no newer number; of the others the number stays."""
    row = world.work
    at = world.queue_at[way]
    i = 0
    while i < row[at]:
        frame = at + 1 + w.FRAME_BYTES * i
        row[frame + w.DIST] = 0
        row[frame + w.SAYS] &= rows.LOADED
        is_idle = row[frame + w.SAYS] == 0 or is_known(world, row[frame + w.SQ])
        if is_idle or (i > 0 and is_repeated(world, frame)):
            rows.drop_one(row, at, i)
        else:
            i += 1


def is_repeated(world, frame):
    """1 if a frame to the PC says what the one before it says, and that one is enough.

    It is if the PC keeps its memory, or loses it once at most and knows until then what they say.
    """
    row = world.work
    if not same_frame(row, frame, frame - w.FRAME_BYTES):
        return False
    if rows.has_budget(world, w.RESTART):
        return row[world.at[w.BUDGET_AT] + w.RESTART] == 1 and is_old(world, row[frame + w.SQ])
    return True
