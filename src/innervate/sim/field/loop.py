"""The simulation loop of a field: one function, compiled on arrays or plain on lists.

`do` are the functions of a network, and of the medium access below it (see `sim/field`).
"""

from collections.abc import Callable
from typing import Any

from innervate.dialect.arith import MASK30
from innervate.scenario.actions.field import CUT, JAM, KILL, QUIET, RESTART, RESTORE, REVIVE
from innervate.sim.field import calls, medium, powers, queue
from innervate.sim.field.queue import RANK_SHIFT, STATION_SHIFT, STATIONS_MAX, TIME_SHIFT, WHAT_MASK
from innervate.sim.field.states import ALIVE, DEAD, OFF
from innervate.sim.status import BUDGET, COLD, DONE, MEMORY_LOST, ON_START, ON_TIMER

NEVER = -1
BOOT = 7  # a command besides those of `scenario/actions`


def switch_on(world, do, node, time, cause):
    """A node starts, for the first time or again; with MEMORY_LOST its record is wiped."""
    radio = world.radios[node]
    if cause == MEMORY_LOST:
        do.wipe(world, node)
    radio.state = ALIVE
    radio.boots += 1
    timers = world.run[0].timers
    for timer in range(timers):
        world.due[node * timers + timer] = NEVER
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
    elif action == KILL and state == OFF:
        world.radios[node].state = DEAD  # and it is not switched on at its time, either
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


def expire(world, do, node, timer, time):
    """A timer is due, if it has not been set anew."""
    radio = world.radios[node]
    place = node * world.run[0].timers + timer
    if world.due[place] != time or radio.state != ALIVE:
        return
    world.due[place] = NEVER
    if timer < world.run[0].own_timers:
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
        do.sample(world, do, what, time)
    elif rank == queue.OFFER:
        do.offer(world, do, run.next_offer, time)
        run.next_offer += 1
        if run.next_offer < run.offers:
            at = world.offers[run.next_offer].time
            queue.push(world.heap, queue.key_of(at, queue.OFFER, 0, 0))
    else:
        obey(world, do, run.next_command, time)
        do.note_carriers(world, do, time)
        run.next_command += 1
        if run.next_command < run.commands:
            at = world.commands[run.next_command].time
            queue.push(world.heap, queue.key_of(at, queue.COMMAND, 0, 0))


def run_until(world, do, until, budget):
    """Run up to, not including, time `until` (us), or `budget` events."""
    run, heap = world.run[0], world.heap
    for _ in range(budget):
        run.status = do.pressing(world)
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
