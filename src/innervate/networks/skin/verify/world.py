"""What the explorer of a skin works on: one state as a row of bytes, and where things lie in it.

A row holds the cells, the PC, the cables, what may still happen (budgets) and the frames in
flight on every direction of every cable, oldest first. One byte holds one number, so that the
symmetries of a graph are plain permutations of bytes.
"""

from typing import Any, NamedTuple

from innervate.sim.tables import Out

# Places in `SkinWorld.at`.
CELLS, CAPACITY, DIRECTIONS, PC_AT, LINK_AT, BUDGET_AT, MERGE, PROMPT, FAIR = range(9)
FEASIBLE, KEEP, UNREDUCED, LEAN, HELD, RISING, STEADY = range(9, 16)
SETTINGS = 16
DRAWS = 16  # most draws of a fair round that are tried in every way; others give the first

# A cell's head; then PORT_BYTES for each cabled port.
HEAD_BYTES, PORT_BYTES = 9, 3
FLAGS, SQ_OWN, FD_SQ, FD_DIST, HOLD, SENT_DIST, SENT_SQ, WAIT, TICKS = range(HEAD_BYTES)
ANY = 127  # ticks: as many as it takes
DIST, SQ, SAYS = range(PORT_BYTES)

# The PC.
PC_BYTES = 5
PC_SQ, PC_FLAGS, PC_PERIODS, PC_LISTEN, PC_COUNTS = range(PC_BYTES)

# Budgets of faults: one each, and all together.
BUDGETS = 6
LOSS, CUT, HEAL, FALSE, RESTART, TOTAL = range(BUDGETS)

FRAME_BYTES = 3

# What can be broken (SkinWorld.found[0]).
FINE, BROKEN_LOOP, BROKEN_ORDER, BROKEN_WORSE, BROKEN_RANGE, BROKEN_OUTBOX = range(6)
NO_ROOM = -1

# Kinds of moves.
TICK, PC_TICK, SOON, DELIVER, LOSE, CUT_LINK, HEAL_LINK, RESTART_PC = range(8)

OUTBOX = 16


class Sink(NamedTuple):
    """The PC's state: one record and a number per port."""

    own: Any
    size: Any


class SkinWorld(NamedTuple):
    """All of it; the tables of numbers are fixed but `found`, `work`, `trial`, `best`."""

    at: Any  # settings and places
    cell_at: Any  # where a cell's head lies
    port_at: Any  # [4 * cell + port] where a cabled port lies, -1 none
    out_way: Any  # [end] the direction that frames sent there take, -1 no cable
    in_way: Any  # [end] the direction that ends there
    way_end: Any  # [direction] the end it leads to; cable `link` has directions 2 link and the next
    queue_at: Any  # [direction] where its frames lie
    depth: Any  # scratch of a search for shortest routes
    orders: Any  # in which nodes tick in a fair round, one after the other; none in a search
    move_kind: Any
    move_arg: Any
    image: Any  # [g * width + i] where byte i of image g comes from
    params: Any  # of the exploration, and of the fair schedule
    cells: Any  # scratch records
    words: Any  # the first of them as a row of words
    low: Any
    high: Any
    pc: Sink
    out: Out
    frame: Any
    found: Any  # [0] what a step broke
    draws: Any  # of a fair round: how many, what each gives, out of how many each was
    work: Any
    work_words: Any
    trial: Any
    trial_words: Any
    best: Any
    best_words: Any
