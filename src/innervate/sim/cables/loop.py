"""The simulation loop of a network of cables: one function, compiled on arrays or plain on lists.

It takes events off the wheel, lets the node's protocol handle them, drains the outbox, and stops
when the time, the commands or the room in a table is used up; `run.status` says which.
"""

from collections.abc import Callable
from types import ModuleType
from typing import Any

from innervate.dialect import arith, outbox, rng
from innervate.kernel import compilation
from innervate.kernel.tables import fetch
from innervate.scenario.actions.cables import GIVE
from innervate.sim import clocks, delays, rows, taps
from innervate.sim import wheel as queue
from innervate.sim.cables import calls, commands, wires
from innervate.sim.status import BROKEN, BUDGET, DONE, POOL_FULL, ROWS_FULL
from innervate.sim.wheel import FRESH, LAST, NIL

# Events between two looks at the room left in the tables.
BATCH = 64
FORESEE_CELLS = 2000  # fewer fit into the processor's caches anyway
FORESEE_EVENTS = 4
ROWS_PER_EVENT = 24  # besides what a node's outbox holds
PUSHED_PER_EVENT = 16  # likewise: events that one leads to


def pressing(world):
    """Why the loop has to stop before the next batch, or DONE."""
    run = world.run[0]
    pool, acts = world.wheel.pool, BATCH * world.out.limit[0]
    if run.broken:
        return BROKEN
    if pool[FRESH] + BATCH * PUSHED_PER_EVENT + acts > run.pool_slots + pool[LAST]:
        return POOL_FULL
    if run.rows + BATCH * ROWS_PER_EVENT + acts > run.row_limit:
        return ROWS_FULL
    if run.deliveries + acts > run.delivery_limit > 0 or run.trail + BATCH > run.trail_limit > 0:
        return ROWS_FULL
    if run.taps > run.tap_limit:  # beyond the limit there is room for a batch
        return ROWS_FULL
    return DONE


def foresee(world, wheel):
    """Have what an event a little later needs fetched from memory while others are handled."""
    slot = wheel.clock[queue.PENDING]
    for _ in range(FORESEE_EVENTS):
        if slot == NIL:
            break
        slot = wheel.links[queue.BUCKETS + slot]
    if slot == NIL:
        index = queue.first(wheel, 0, wheel.clock[queue.NOW] & queue.MASK)
        if index == NIL:
            return
        slot = wheel.links[index]
    run = world.run[0]
    if slot >= run.pool_slots:
        end = wheel.events[slot].target
        node = min(end >> 2, run.cells - 1)
        fetch(world.epoch, end, 0)
    else:
        node = min(slot - clocks.timer_of(world, slot) * run.nodes, run.cells - 1)
        fetch(world.ends, 4 * node, 0)
        fetch(world.ends, 4 * node, 1)
        fetch(world.cells, node, 3)
        fetch(world.starts, node, 0)
    fetch(world.cells, node, 0)
    fetch(world.cells, node, 1)
    fetch(world.cells, node, 2)
    fetch(world.clocks, node, 0)
    fetch(world.alive, node, 0)


def dispatch(world, do, slot, time):
    """Hand an event to what it is for."""
    run = world.run[0]
    if slot >= run.pool_slots and world.wheel.events[slot].kind == wires.DELAYED:
        wires.release(world, do, slot, time)
    elif run.tx_slots <= slot < run.pool_slots:
        wires.wire_free(world, do, slot - run.tx_slots, time)
    else:
        calls.on_event(world, do, slot, time)


def run_batch(world, do, limit):
    """Up to BATCH events before a time; true if that was all there was before it."""
    wheel = world.wheel
    for _ in range(BATCH):
        slot = queue.pop(wheel, limit)
        if slot == NIL:
            return True
        if world.run[0].cells > FORESEE_CELLS:
            foresee(world, wheel)
        dispatch(world, do, slot, wheel.clock[queue.NOW])
    return False


def run_until(world, do, until, budget):
    """Run up to, not including, time `until` (us), or about `budget` events."""
    run = world.run[0]
    for _ in range(0, budget, BATCH):
        run.status = pressing(world)
        if run.status != DONE:
            return
        limit = until
        if run.next_command < run.commands:
            limit = min(until, world.commands[run.next_command].at)
        if run_batch(world, do, limit) and run.broken == 0:
            if limit >= until:
                return
            command = world.commands[run.next_command]
            if command.action == GIVE:
                commands.hand_in(world, do, command)
            else:
                commands.obey(world, do, command)
            run.next_command += 1
    run.status = BUDGET


def bind(do: Any) -> Callable[..., None]:
    """The loop over a network's functions, plain: (world, until_us, budget of events)."""

    def advance(world, until, budget):  # type: ignore[no-untyped-def]
        run_until(world, do, until, budget)

    return advance


def compiled(
    do: ModuleType, hot: tuple[ModuleType, ...], rare: tuple[ModuleType, ...], name: str = "",
    own: tuple[Callable[..., Any], ...] = (),
) -> Callable[..., None]:  # fmt: skip
    """The loop over a network's functions, compiled.

    Args:
        do: a module (see `kernel/compilation.bound`) with the network's functions.
        hot: the modules that they stand in, and all that they call.
        rare: those of them that run too seldom to be worth copying into every caller.
        name: under which it may have come with the toolkit (see kernel/ready.py).
        own: of the network's functions, those that stand in none of these modules.
    """

    def jitted() -> Any:
        compilation.register_functions(*own)
        compilation.register_functions(calls.switch_on, hot=False)
        compilation.register(*rare, commands, rows, taps, hot=False)
        compilation.register(arith, outbox, rng, *hot, queue, clocks, wires, delays, calls)
        compilation.register_functions(pressing, foresee, dispatch, run_batch, run_until)
        return compilation.compiled_as_one(bind(do))

    return compilation.loop(name, jitted)
