"""What is done to a running network from outside: cables cut, nodes killed, frames lost."""

from innervate.dialect.arith import MASK30
from innervate.scenario.actions.cables import CUT, KILL, LOOSE, LOSE, RESTART, RESTORE, REVIVE
from innervate.sim import clocks
from innervate.sim import wheel as queue
from innervate.sim.cables import calls, wires
from innervate.sim.cables.wires import DOWN, LOSSY
from innervate.sim.cables.world import ALIVE, DEAD, TIMER_SLOTS
from innervate.sim.clocks import timer_slot
from innervate.sim.status import MEMORY_LOST, ON_INPUT
from innervate.sim.wheel import NIL

# As in a plan's faults; the loop begins with a command of its own.
BEGIN = -1


def obey(world, do, command):
    """Carry out one command at its time."""
    action = command.action
    time = command.at
    if world.run[0].observe:
        do.before_change(world)
    if action == BEGIN:
        for node in range(world.run[0].nodes):
            queue.insert(world.wheel, node, world.starts[node].phase)
    elif action == CUT:
        if not wires.is_cut(world, command.end):
            change_link(world, command.end, 1)
    elif action == RESTORE:
        if wires.is_cut(world, command.end):
            change_link(world, command.end, -1)
    elif action == KILL:
        switch_off(world, do, time, command.node)
    elif action == REVIVE:
        if world.alive[command.node] == DEAD:
            change_all(world, command.node, -1)
            calls.switch_on(world, do, command.node, time, MEMORY_LOST)
    elif action == RESTART:
        if world.alive[command.node] == ALIVE:
            forget(world, do, time, command.node)
            calls.switch_on(world, do, command.node, time, MEMORY_LOST)
    elif action == LOOSE or action == LOSE:
        impair(world, command)
    if world.run[0].observe:
        node = max(command.node, command.end >> 2)
        do.on_change(world, time, min(node, world.run[0].cells), command.index)


def change_link(world, end, by):
    """Take a cable down (by = 1) or up (-1): an end counts the reasons it is down for."""
    peer = world.ends[end].peer
    shift_end(world, end, by)
    shift_end(world, peer, by)


def shift_end(world, end, by):
    """One end's part of it; the epoch is odd while there is any reason."""
    wire = world.ends[end]
    reasons = (wire.impaired >> 2) + by
    if reasons < 0:
        return
    was_down = wire.impaired & DOWN
    down = 1 if reasons > 0 else 0
    wire.impaired = (reasons << 2) | (wire.impaired & LOSSY) | down
    if down != was_down:
        world.epoch[end] += 1


def ends_of(world, node):
    """First end of a node and the end after its last."""
    cells = world.run[0].cells
    if node == cells:
        return 4 * cells, len(world.ends)
    return 4 * node, 4 * node + 4


def change_all(world, node, by):
    """All cables of a node at once."""
    first, behind = ends_of(world, node)
    for end in range(first, behind):
        if world.ends[end].peer >= 0:
            change_link(world, end, by)


def switch_off(world, do, time, node):
    """A node dies: its timers stop, its queues are lost, its cables are dead."""
    if world.alive[node] == DEAD:
        return
    world.alive[node] = DEAD
    change_all(world, node, 1)
    forget(world, do, time, node)


def forget(world, do, time, node):
    """A node loses its memory: timers and queues go."""
    for timer in range(TIMER_SLOTS):
        slot = timer_slot(world, node, timer)
        if world.wheel.events[slot].bucket != NIL:
            queue.remove(world.wheel, slot)
    first, behind = ends_of(world, node)
    for end in range(first, behind):
        wires.drop_queue(world, do, end, time)
    do.on_stop(world, time, node)


def hand_in(world, do, command):
    """A node is given something by its user, if the network has it so."""
    kind = do.take_input(world, command)
    if kind > 0:
        now = clocks.reading(world.clocks[command.node], command.at)
        do.on_input(world, command.node, now & MASK30, kind)
        calls.finish(world, do, command.node, command.at, ON_INPUT, 0)


def impair(world, command):
    """A loose cable loses frames both ways with a probability (2^-15), or the next few for sure."""
    for end in (command.end, world.ends[command.end].peer):
        buffer = world.buffers[end]
        if command.action == LOOSE:
            buffer.loss = command.value
        else:
            buffer.lose = command.value
        wire = world.ends[end]
        wire.impaired &= ~LOSSY
        if buffer.loss > 0 or buffer.lose > 0:
            wire.impaired |= LOSSY
