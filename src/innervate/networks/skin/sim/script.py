"""Plays a scenario's [script]: its steps replace the clock, everything else is the simulator's.

Nothing happens by itself. Timers and frames on their way lie in the event queue; a step picks the
one it names and has it handled. A step takes a millisecond, so that rows have a time.
"""

from typing import Any, NamedTuple

from innervate.dialect import plain
from innervate.networks.skin.protocol import constants as skin_const
from innervate.networks.skin.scenario import script as steps
from innervate.networks.skin.sim.build import build
from innervate.scenario import ScenarioError
from innervate.scenario.actions import cables as actions
from innervate.sim import wheel
from innervate.sim.cables import calls, commands, loop
from innervate.sim.cables.wires import DOWN, LOST_CUT, LOST_NOISE
from innervate.sim.cables.world import COMMAND, World
from innervate.sim.status import BROKEN, COLD, DONE
from innervate.sim.tables import get
from innervate.sim.wheel import NIL

STEP_US = 1000
FROM_OUTSIDE = {
    steps.STEP_CUT: actions.CUT,
    steps.STEP_RESTORE: actions.RESTORE,
    steps.STEP_RESTART: actions.RESTART,
}


def play(plan: Any, stack: Any, checks: bool, trail: bool) -> tuple[World, int]:
    """Play all steps of `plan.script` on plain state; the world after them and its time (us).

    Raises ScenarioError if a step asks for a frame that is not on its way or a timer not set.
    """
    world = build(plan, plain=True, checks=checks, trail=trail, deliveries=True)
    for node in range(get(world.run, 0, "nodes")):
        world.starts[node].phase = 0
    loop.run_until(world, stack, 1, 1)  # the command that begins a run
    for node in range(get(world.run, 0, "nodes")):
        wheel.remove(world.wheel, node)
        calls.switch_on(world, stack, node, 0, COLD)
    time = 0
    stage = _Stage(plan, world, stack, set())
    for number, step in enumerate(plan.script):
        time += STEP_US
        _take(stage, number, step, time)
        if get(world.run, 0, "broken"):
            world.run[0].status = BROKEN
            world.run[0].broken_at = time
            return world, time
    world.run[0].status = DONE
    return world, time


class _Stage(NamedTuple):
    """What a script is played on; `missed` holds the ends that the next ticks find broken."""

    plan: Any
    world: World
    stack: Any
    missed: set[int]


def _take(stage: _Stage, number: int, step: Any, time: int) -> None:
    """Take one step of the script."""
    plan, world, stack, missed = stage
    label = plan.graph.label
    if step.action == steps.DRAW:
        for cell in world.cells:
            cell.choice = step.value
        return
    if step.action == steps.DETECT:
        cell, port = world.cells[step.node], step.end - 4 * step.node
        cell.heard[port] = 0
        cell.pf[port] = max(cell.pf[port], skin_const.ONE - 1)
        missed.add(step.end)
    elif step.action in (steps.TICK, steps.SOON):
        timer = skin_const.TICK if step.action == steps.TICK else skin_const.SOON
        if timer == skin_const.TICK and plan.scenario.model.script.keepalive:
            _keep_alive(world, step.node, missed)
        slot = timer * get(world.run, 0, "nodes") + step.node
        if world.wheel.events[slot].bucket == NIL:
            raise _refused(plan, number, f"{label(step.node)} has nothing to send soon")
        wheel.remove(world.wheel, slot)
        calls.on_event(world, stack, slot, time)
    elif step.action in FROM_OUTSIDE:
        _obey(world, stack, step, time)
    else:
        slot = _oldest(world, step.end)
        if slot == NIL:
            where = f"{plan.graph.label_end(step.end)} to {label(step.node)}"
            raise _refused(plan, number, f"no frame is on its way from {where}")
        wheel.remove(world.wheel, slot)
        if step.action == steps.DELIVER:
            calls.on_event(world, stack, slot, time)
        else:
            world.counters[LOST_NOISE + world.wheel.events[slot].kind] += 1
            wheel.give(world.wheel, slot)
    for cell in world.cells:
        cell.choice = -1


def _keep_alive(world: World, node: int, missed: set[int]) -> None:
    """Before a cell's tick: every port that is not to be found broken has heard something."""
    if node == get(world.run, 0, "cells"):
        return
    cell = world.cells[node]
    for port in range(skin_const.PORTS):
        end = 4 * node + port
        if world.ends[end].peer < 0:
            continue
        works = not world.ends[end].impaired & DOWN or cell.pf[port] < skin_const.ONE
        cell.heard[port] = int(works and end not in missed)
        missed.discard(end)


def _obey(world: World, stack: Any, step: Any, time: int) -> None:
    """A cable is cut, with what is on it, or works again; a node loses its memory."""
    command = plain.make("Command", tuple((n, 0, -1, -1, "", "") for n in COMMAND))()
    command.at, command.action = time, FROM_OUTSIDE[step.action]
    command.node = step.node if step.action == steps.STEP_RESTART else -1
    command.end = step.end
    commands.obey(world, stack, command)
    if step.action == steps.STEP_CUT:
        for end in (step.end, world.ends[step.end].peer):
            while (slot := _oldest(world, end)) != NIL:
                wheel.remove(world.wheel, slot)
                world.counters[LOST_CUT + world.wheel.events[slot].kind] += 1
                wheel.give(world.wheel, slot)


def _refused(plan: Any, number: int, why: str) -> ScenarioError:
    key = ("script", "steps", number)
    error: ScenarioError = plan.scenario.source.error(key, f"script.steps.{number}: {why}")
    return error


def _oldest(world: World, end: int) -> int:
    """The slot of the frame sent from `end` that is longest on its way, or NIL."""
    target = world.ends[end].peer
    first = get(world.run, 0, "pool_slots")
    last = world.wheel.pool[wheel.FRESH]
    waiting = [
        (event.time, slot)
        for slot in range(first, last)
        if (event := world.wheel.events[slot]).bucket != NIL and event.target == target
    ]
    return min(waiting)[1] if waiting else NIL
