"""A skin without further faults: what a fair schedule starts from, and what it has to guess."""

from innervate.networks.skin.protocol.constants import INFINITY, NONE
from innervate.networks.skin.verify import row as rows
from innervate.networks.skin.verify import world as w
from innervate.networks.skin.verify.check import measure_depths, parent_port
from innervate.verify import search


def forget_budgets(world):
    """Nothing more happens to the network; nobody stops."""
    row = world.work
    for c in range(world.at[w.CELLS]):
        row[world.cell_at[c] + w.TICKS] = 1
    row[world.at[w.PC_AT] + w.PC_COUNTS] = 1
    for i in range(w.BUDGETS):
        row[world.at[w.BUDGET_AT] + i] = 0


def draw_first(world):
    """All draws of what is played next give the first of what may be chosen."""
    for k in range(len(world.draws)):
        world.draws[k] = 0


def draw_otherwise(world):
    """The next way in which the draws that were made can turn out; 0 if this was the last."""
    draws = world.draws
    place = min(draws[0], w.DRAWS)
    draws[0] = 0
    while place > 0:
        draws[place] += 1
        if draws[place] < draws[w.DRAWS + place]:
            return True
        draws[place] = 0
        place -= 1
    return False


def insert_lost(world, source, target, index):
    """Keep a state, and those in which the last beacon on a direction was lost, if one may be.

    A search in which ticks take beacons in leaves a lost one under way (moves.py); the fair
    schedule would deliver it.
    """
    for way in range(-1, world.at[w.DIRECTIONS]):
        search.fetch_row(world, source, index)
        if way >= 0:
            at = world.queue_at[way]
            if world.work[at] == 0 or not rows.spend(world, w.LOSS):
                continue
            rows.drop_one(world.work, at, world.work[at] - 1)
        search.insert(world, target, index)


def insert_expiring(world, source, target, index):
    """Keep a state, with every choice of cells that forget their feasible distance in the next
    round: where the search has forgotten how long a cell had no route, it may be one of them.
    """
    for chosen in range(1 << world.at[w.CELLS]):
        search.fetch_row(world, source, index)
        measure_depths(world)
        is_possible = True
        for c in range(world.at[w.CELLS]):
            if (chosen >> c) & 1:
                is_possible = is_possible and may_expire(world, c)
                world.work[world.cell_at[c] + w.HOLD] = world.params[0].hold_periods - 1
        if is_possible:
            search.insert(world, target, index)


def may_expire(world, c):
    """1 if a cell may have had no route for FD_HOLD after the next period, by what is known.

    Where no cable leads to the PC it is no matter.
    """
    if world.depth[c] == INFINITY or parent_port(world, c) != NONE:
        return False
    most = world.work[world.cell_at[c] + w.HOLD] + world.at[w.HELD] - 1
    return most + 1 >= world.params[0].hold_periods
