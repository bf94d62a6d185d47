"""What of a skin's state can no longer matter, set to one value: fewer states, the same futures.

Every rule here has its reason in docs/verify.md ("What is left out"); tests compare the routes
that are reached with and without, and that a step and this can change places.
"""

from innervate.dialect.arith import later
from innervate.networks.skin.protocol.constants import INFINITY, PERIODIC, PORTS
from innervate.networks.skin.verify.row import (
    FD_KNOWN,
    HAS_TICKED,
    IS_CHILD,
    IS_PARENT,
    IS_SOON,
    LOADED,
    NOTHING_SENT,
    SQ_KNOWN,
    WAS_PARENT,
    clear,
    drop,
    has_budget,
    is_up,
)
from innervate.networks.skin.verify.world import (
    ANY,
    BUDGET_AT,
    CELLS,
    DIST,
    FD_DIST,
    FD_SQ,
    FEASIBLE,
    FLAGS,
    FRAME_BYTES,
    HEAL,
    HELD,
    HOLD,
    KEEP,
    MERGE,
    PC_AT,
    PC_COUNTS,
    PC_FLAGS,
    PC_LISTEN,
    PC_PERIODS,
    PC_SQ,
    RESTART,
    RISING,
    SAYS,
    SENT_DIST,
    SENT_SQ,
    SQ,
    SQ_OWN,
    STEADY,
    TICKS,
)

# A port that never works again: no route, and a penalty of 2.
GONE = 8
PENALTY = 12  # the bits of SAYS that hold it


def tidy(world):
    """Forget what no future of the state in `world.work` depends on."""
    for c in range(world.at[CELLS]):
        if world.at[MERGE] and world.at[KEEP] == 0 and world.work[world.cell_at[c] + TICKS] == 0:
            tidy_feasible(world, c)  # it never looks at anything again (see skin_row.trim)
        else:
            tidy_cell(world, c)
    tidy_sink(world)
    first = PORTS * world.at[CELLS]
    for p in range(world.pc.own[0].ports):
        tidy_sink_queue(world, world.in_way[first + p])


def tidy_feasible(world, c):
    """No other rule than `feasible` reads the feasible distance, and it only one that is set."""
    row = world.work
    at = world.cell_at[c]
    if world.at[FEASIBLE] == 0 or row[at + FLAGS] & FD_KNOWN == 0:
        row[at + FLAGS] &= ~FD_KNOWN
        row[at + FD_SQ] = 0
        row[at + FD_DIST] = 0


def tidy_sink(world):
    """A PC that never sends again."""
    row = world.work
    at = world.at[PC_AT]
    if row[at + PC_COUNTS] == 0 and world.at[KEEP] == 0:
        row[at + PC_SQ] = 0
        row[at + PC_FLAGS] = 0
        row[at + PC_PERIODS] = 0
        row[at + PC_LISTEN] = 0


def tidy_cell(world, c):
    """A cell, and what is on its way to it."""
    row = world.work
    at = world.cell_at[c]
    keeps_fd = holds_feasible(world, c)
    row[at + SENT_SQ] = 0  # written before every beacon, and read by no rule of these updates
    if world.at[FEASIBLE] or world.params[0].updates == PERIODIC:
        row[at + FLAGS] &= ~HAS_TICKED  # asks once for a choice that is up to date already
    if keeps_fd:
        row[at + HOLD] = 0
    tidy_feasible(world, c)
    parent = -1
    for p in range(PORTS):
        slot = world.port_at[PORTS * c + p]
        if slot >= 0:
            if row[slot + SAYS] & IS_PARENT:
                parent = slot
            tidy_port(world, c, p, slot, keeps_fd)
            tidy_queue(world, c, p, slot, keeps_fd)
    tidy_news(row, at, parent)
    if parent < 0 and keeps_fd and is_number_dead(world, c):
        row[at + SQ_OWN] = 0


def holds_feasible(world, c):
    """1 if the cell cannot forget its feasible distance any more within its ticks.

    The fair schedule tries every number of periods that may have passed (fair.py).
    """
    if world.at[KEEP]:
        return world.at[HELD] > 0
    at = world.cell_at[c]
    ticks = world.work[at + TICKS]
    return ticks == ANY or world.work[at + HOLD] + ticks < world.params[0].hold_periods


def is_dead_route(world, c, sq, dist, keeps_fd):
    """1 if a port that is not the parent and says this can never become the parent."""
    row = world.work
    at = world.cell_at[c]
    if dist == INFINITY:
        return True
    if not keeps_fd:
        return False
    if world.at[RISING] and row[at + FLAGS] & SQ_KNOWN:
        return not later(sq, row[at + SQ_OWN])
    if world.at[FEASIBLE] == 0 or (row[at + FLAGS] & FD_KNOWN) == 0:
        return False
    if later(sq, row[at + FD_SQ]):
        return False
    return sq != row[at + FD_SQ] or dist >= row[at + FD_DIST]


def is_gone(world, c, p, slot):
    """1 if a port never works again."""
    row = world.work
    penalty = (row[slot + SAYS] & PENALTY) >> 2
    if world.at[KEEP] == 0 and penalty > row[world.cell_at[c] + TICKS]:
        return True
    link = world.way_link[world.in_way[PORTS * c + p]]
    if is_up(world, link) or has_budget(world, HEAL):
        return False
    return penalty > 0 or (world.at[STEADY] and row[slot + DIST] == INFINITY)


def tidy_port(world, c, p, slot, keeps_fd):
    """What a port last heard."""
    row = world.work
    row[slot + SAYS] &= ~LOADED
    is_parent = row[slot + SAYS] & IS_PARENT
    is_dead = row[slot + SAYS] & IS_CHILD or row[slot + DIST] == INFINITY
    if not is_parent:
        sq, dist = row[slot + SQ], row[slot + DIST]
        is_dead = is_dead or is_dead_route(world, c, sq, dist, keeps_fd)
    if is_dead:
        row[slot + DIST] = INFINITY
        row[slot + SQ] = 0
        row[slot + SAYS] &= ~IS_CHILD
    if not is_parent and is_gone(world, c, p, slot):
        row[slot + DIST] = INFINITY
        row[slot + SQ] = 0
        row[slot + SAYS] = GONE | (row[slot + SAYS] & WAS_PARENT)
        clear(world, world.in_way[PORTS * c + p])


def tidy_queue(world, c, p, slot, keeps_fd):
    """Frames that change nothing: the oldest while they repeat what the port last heard."""
    row = world.work
    way = world.in_way[PORTS * c + p]
    at = world.queue_at[way]
    for i in range(row[at]):
        frame = at + 1 + FRAME_BYTES * i
        row[frame + SAYS] &= ~LOADED
        if row[frame + DIST] == INFINITY or row[frame + SAYS] & IS_CHILD:
            row[frame + DIST] = INFINITY
            row[frame + SQ] = 0
            row[frame + SAYS] = 0
    if world.at[STEADY]:
        drop_repeated(world, way)
    is_closed = row[slot + DIST] == INFINITY and (row[slot + SAYS] & IS_PARENT) == 0
    while row[at] > 0:
        dist, sq = row[at + 1 + DIST], row[at + 1 + SQ]
        is_same = world.at[STEADY] and dist == row[slot + DIST] and sq == row[slot + SQ]
        if not is_same and not (is_closed and is_dead_route(world, c, sq, dist, keeps_fd)):
            break
        drop(world, way)


def drop_repeated(world, way):
    """Of equal frames one after the other the first stays: it may be lost where they may, too."""
    row = world.work
    at = world.queue_at[way]
    i = 1
    while i < row[at]:
        here = at + 1 + FRAME_BYTES * i
        if same_frame(row, here, here - FRAME_BYTES):
            drop_one(row, at, i)
        else:
            i += 1


def same_frame(row, a, b):
    """1 if two frames say the same."""
    return (
        row[a + DIST] == row[b + DIST]
        and row[a + SQ] == row[b + SQ]
        and row[a + SAYS] == row[b + SAYS]
    )


def drop_one(row, at, i):
    """Frame `i` of a queue is gone."""
    last = at + 1 + FRAME_BYTES * (row[at] - 1)
    for k in range(at + 1 + FRAME_BYTES * i, last):
        row[k] = row[k + FRAME_BYTES]
    for k in range(last, last + FRAME_BYTES):
        row[k] = 0
    row[at] -= 1


def tidy_news(row, at, parent):
    """A timer for news that are none any more: firing it would change nothing."""
    if row[at + FLAGS] & IS_SOON == 0 or row[at + SENT_DIST] == NOTHING_SENT:
        return
    dist = INFINITY
    if parent >= 0:
        dist = min(row[parent + DIST] + 1, INFINITY)
    if dist != row[at + SENT_DIST]:
        return
    if parent < 0 or row[parent + SAYS] & WAS_PARENT:
        row[at + FLAGS] &= ~IS_SOON


def is_number_dead(world, c):
    """1 if the number of a cell without a route is of no use: only the PC would look at it."""
    if world.at[FEASIBLE] == 0:
        return False
    row = world.work
    first = PORTS * world.at[CELLS]
    for p in range(PORTS):
        way = world.out_way[PORTS * c + p]
        if way >= 0 and world.way_end[way] >= first:
            return is_known(world, row[world.cell_at[c] + SQ_OWN])
    return True


def is_known(world, sq):
    """1 if a number tells the PC nothing, now or later."""
    pc = world.at[PC_AT]
    if world.work[pc + PC_COUNTS] == 0 and world.at[KEEP] == 0:
        return True
    return is_old(world, sq) and not has_budget(world, RESTART)


def is_old(world, sq):
    """1 if the PC has this number or a newer one."""
    pc = world.at[PC_AT]
    return world.work[pc + PC_FLAGS] and world.work[pc + PC_SQ] >= sq


def tidy_sink_queue(world, way):
    """Frames to the PC that tell it no newer number; of the others the number stays."""
    row = world.work
    at = world.queue_at[way]
    i = 0
    while i < row[at]:
        frame = at + 1 + FRAME_BYTES * i
        row[frame + DIST] = 0
        row[frame + SAYS] &= LOADED
        is_idle = row[frame + SAYS] == 0 or is_known(world, row[frame + SQ])
        if is_idle or (i > 0 and is_repeated(world, frame)):
            drop_one(row, at, i)
        else:
            i += 1


def is_repeated(world, frame):
    """1 if a frame to the PC says what the one before it says, and that one is enough.

    It is if the PC keeps its memory, or loses it once at most and knows until then what they say.
    """
    row = world.work
    if not same_frame(row, frame, frame - FRAME_BYTES):
        return False
    if has_budget(world, RESTART):
        return row[world.at[BUDGET_AT] + RESTART] == 1 and is_old(world, row[frame + SQ])
    return True


__all__ = ["tidy"]
