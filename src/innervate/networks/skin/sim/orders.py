"""Commands of the PC, followed to every cell that they are for: who gets one, when, and who not.

What is known of a command and a cell stands in `world.watch.due`, for the last SLOTS commands: the
state of the cell as the command was given, until it came. A slot that is used again is settled
first.
"""

from innervate.dialect.arith import MASK16, MASK30
from innervate.networks.skin.protocol.constants import EVERYBODY, GIVE, NONE
from innervate.networks.skin.sim.counters import ADDRESSED, GIVEN, MISSED, REACHED, REPEATED, STRAY
from innervate.sim import delays
from innervate.sim.cables.world import ALIVE
from innervate.sim.rows import record_row as note

SLOTS = 64

# States of a cell, for a command.
NOT_MEANT = 0
WAS_OFF = 1
HAD_NO_WAY = 2
HAD_A_WAY = 3
CAME = 4

# Codes of rows.
ORDER_GIVEN = 110  # by the PC: a = number, b = the cell, or -1 for all
ORDER_CAME = 111  # at a cell: a = number, b = latency, us


def begin(world, order):
    """Note whom a command is for, and what it says; the kind of input if the PC can send it."""
    run = world.run[0]
    whom = order.end
    number = (world.pc.own[0].command + 1) & MASK16
    slot = number % SLOTS
    settle(world, slot)
    world.watch.due_number[slot] = number
    first, behind = 0, run.cells
    if whom != NONE:
        first, behind = whom, whom + 1
    for cell in range(first, behind):
        state = HAD_A_WAY
        if world.alive[cell] != ALIVE:
            state = WAS_OFF
        elif world.cells[cell].parent == NONE:
            state = HAD_NO_WAY
        world.watch.due[slot * run.cells + cell] = state
    world.counters[GIVEN] += 1
    world.counters[ADDRESSED] += behind - first
    if run.observe:
        note(world, order.at, run.cells, ORDER_GIVEN, number, whom)
    item = world.sample[0]
    item.cell = EVERYBODY if whom == NONE else whom
    item.dist = order.value >> 16
    item.proximity = order.value & MASK16
    item.made_at = order.at & MASK30
    if world.alive[run.cells] == ALIVE:
        return GIVE
    settle(world, slot)
    return 0


def settle(world, slot):
    """Whoever a command has not reached by now is never reached by it."""
    if world.watch.due_number[slot] == NONE:
        return
    cells = world.run[0].cells
    for cell in range(cells):
        state = world.watch.due[slot * cells + cell]
        if state != NOT_MEANT and state != CAME:
            world.counters[MISSED + state - WAS_OFF] += 1
        world.watch.due[slot * cells + cell] = NOT_MEANT
    world.watch.due_number[slot] = NONE


def reach(world, time, node, frame):
    """A command came to a cell's user."""
    run = world.run[0]
    slot = frame.sq % SLOTS
    place = slot * run.cells + node
    if world.watch.due_number[slot] != frame.sq or world.watch.due[place] == NOT_MEANT:
        world.counters[STRAY] += 1
        return
    if world.watch.due[place] == CAME:
        world.counters[REPEATED] += 1
        return
    world.watch.due[place] = CAME
    world.counters[REACHED] += 1
    latency_us = (time - frame.made_at) & MASK30
    delays.note(world, len(world.delays) - 1, latency_us)
    if run.observe:
        note(world, time, node, ORDER_CAME, frame.sq, latency_us)
