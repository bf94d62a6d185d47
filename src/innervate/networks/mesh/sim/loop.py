"""The simulation loop of a mesh: one function, compiled on arrays or plain on lists.

`do` are the functions of the router, and of what lies below it (see stacks.py).
"""

from collections.abc import Callable
from typing import Any

from innervate.dialect.arith import MASK16, MASK30
from innervate.networks.mesh.protocol import constants as mesh_const
from innervate.networks.mesh.protocol.constants import MESSAGE, SAMPLE
from innervate.networks.mesh.sim import calls
from innervate.networks.mesh.sim.world import TIMERS
from innervate.scenario.actions.field import CUT, JAM, KILL, QUIET, RESTART, RESTORE, REVIVE
from innervate.sim.field import medium, motion, powers, queue
from innervate.sim.field.queue import RANK_SHIFT, STATION_SHIFT, STATIONS_MAX, TIME_SHIFT, WHAT_MASK
from innervate.sim.field.states import ALIVE, OFF
from innervate.sim.status import (
    BROKEN,
    BUDGET,
    DONE,
    ON_START,
    ON_TIMER,
    POOL_FULL,
    ROWS_FULL,
)

NEVER = -1
BOOT = 7  # a command besides those of `scenario/plan.py`
COLD, MEMORY_LOST = 0, 1
DUPLICATES_FULL = 100  # a status: the table of deliveries is half full

BYTE = 0xFF


def pressing(world):
    """Why the loop has to stop before the next event, or DONE; limits leave room for one."""
    run = world.run[0]
    if run.broken:
        return BROKEN
    if run.rows > run.row_limit or run.sent > run.sent_limit or run.trail > run.trail_limit:
        return ROWS_FULL
    if run.delivered > run.delivered_limit or run.rounds > run.round_limit:
        return ROWS_FULL
    if run.taps > run.tap_limit:
        return ROWS_FULL
    if run.duplicates > run.duplicate_limit:
        return DUPLICATES_FULL
    if world.heap.size[0] + 64 * run.nodes + 64 > len(world.heap.keys):
        return POOL_FULL
    return DONE


def wipe(world, node):
    """A node's memory is lost: all but who it is, and how its random choices go on."""
    own, nodes, gate = world.nodes[node], world.run[0].nodes, world.radios[node].gate
    number, rank, robot, rng = own.number, own.rank, own.robot, own.rng
    words, blank = world.words[node], world.words[nodes]
    for i in range(len(world.low)):
        words[i] = blank[i]
    own.number, own.rank, own.robot, own.rng = number, rank, robot, rng
    spare = len(world.gates) - 1
    if gate != spare:
        words, blank = world.gate_words[gate], world.gate_words[spare]
        for i in range(world.run[0].gate_words):
            words[i] = blank[i]


def switch_on(world, do, node, time, cause):
    """A node starts, for the first time or again; with MEMORY_LOST its record is wiped."""
    radio = world.radios[node]
    if cause == MEMORY_LOST:
        wipe(world, node)
    radio.state = ALIVE
    radio.boots += 1
    for timer in range(TIMERS):
        world.due[node * TIMERS + timer] = NEVER
    do.power_on(world, do, node, time, cause)
    do.on_start(world, node, (time + radio.offset) & MASK30, cause)
    calls.finish(world, do, node, time, ON_START, cause)


def obey(world, do, index, time):
    """An event of the scenario."""
    command = world.commands[index]
    action, node = command.action, command.node
    state = world.radios[node].state
    if (action == KILL or action == RESTART) and state == ALIVE:
        do.power_off(world, do, node, time)
        medium.die(world, node)
    if action == BOOT and state == OFF:
        switch_on(world, do, node, time, COLD)
    elif (action == REVIVE and state != ALIVE) or action == RESTART:
        switch_on(world, do, node, time, MEMORY_LOST)
    elif action == CUT or action == RESTORE:
        medium.set_cut(world, node, command.other, action == CUT)
    elif action == JAM:
        medium.set_noise(world, node, powers.strength(world.strengths, command.value))
    elif action == QUIET:
        medium.set_noise(world, node, 0)


def offer(world, do, index, time):
    """Hand a message down; its first bytes are the offer's index."""
    message, item = world.offers[index], world.item[0]
    node = message.node
    if world.radios[node].state != ALIVE:
        world.run[0].unasked += 1
        return
    item.handle = index & MASK16
    item.dest, item.flags, item.length = message.dest, message.flags, message.length
    for i in range(message.length):
        item.body[i] = (index >> (8 * (i & 3))) & BYTE
    calls.give(world, do, node, time, MESSAGE)


def sample(world, do, index, time):
    """A robot learns where it is."""
    node = world.walks[index].node
    motion.walk_on(world, index, time)
    if motion.tell_place(world, node):
        calls.give(world, do, node, time, SAMPLE)
    at = time + world.run[0].sample
    queue.push(world.heap, queue.key_of(at, queue.SAMPLE, node, index))


def expire(world, do, node, timer, time):
    """A timer is due, if it has not been set anew."""
    radio = world.radios[node]
    if world.due[node * TIMERS + timer] != time or radio.state != ALIVE:
        return
    world.due[node * TIMERS + timer] = NEVER
    if timer < mesh_const.TIMERS:
        do.on_timer(world, node, (time + radio.offset) & MASK30, timer)
        calls.finish(world, do, node, time, ON_TIMER, timer)
    else:
        do.expire_below(world, do, node, timer, time)


def dispatch(world, do, key, time):
    """Hand the first event of the queue to what it is for."""
    run = world.run[0]
    rank = (key >> RANK_SHIFT) & 7
    node = (key >> STATION_SHIFT) & (STATIONS_MAX - 1)
    what = key & WHAT_MASK
    queue.pop(world.heap)
    if rank == queue.TIMER:
        expire(world, do, node, what, time)
    elif rank < queue.TIMER:
        do.dispatch_below(world, do, rank, node, what, time)
    elif rank == queue.SAMPLE:
        sample(world, do, what, time)
    elif rank == queue.OFFER:
        offer(world, do, run.next_offer, time)
        run.next_offer += 1
        if run.next_offer < run.offers:
            at = world.offers[run.next_offer].time
            queue.push(world.heap, queue.key_of(at, queue.OFFER, 0, 0))
    else:
        obey(world, do, run.next_command, time)
        run.next_command += 1
        if run.next_command < run.commands:
            at = world.commands[run.next_command].time
            queue.push(world.heap, queue.key_of(at, queue.COMMAND, 0, 0))


def run_until(world, do, until, budget):
    """Run up to, not including, time `until` (us), or `budget` events."""
    run, heap = world.run[0], world.heap
    for _ in range(budget):
        run.status = pressing(world)
        if run.status == DONE:
            run.status = do.short(world)
        if run.status != DONE:
            return
        key = heap.keys[0] if heap.size[0] > 0 else queue.LAST
        soon, time = do.due(world), key >> TIME_SHIFT
        if min(soon, time) >= until:
            return
        run.now = min(soon, time)
        if soon < time:
            do.step(world, do, soon)
        else:
            dispatch(world, do, key, time)
    run.status = BUDGET


def bind(do: Any) -> Callable[..., None]:
    """The loop over a router and what lies below it: (world, until_us, budget)."""

    def advance(world, until, budget):  # type: ignore[no-untyped-def]
        run_until(world, do, until, budget)

    return advance
