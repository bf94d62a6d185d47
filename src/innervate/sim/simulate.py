"""Runs a plan: builds the world, drives the loop in slices, collects its tables."""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass
from types import ModuleType
from typing import Any

import numpy as np

from innervate.kernel import door, tables
from innervate.kernel.stop import Stop
from innervate.kernel.wall import wall_s
from innervate.sim import build as builder
from innervate.sim import loop, script, skin_stack, static_stack, taps
from innervate.sim import world as w
from innervate.sim.build import get
from innervate.sim.wires import ARRIVED, BLOCKS

RULE_STATIC = 3
SLICE_EVENTS = 1_000_000

Progress = Callable[[int, int], None]


class InvariantBroken(Exception):
    """A checker found something that must not happen; says what, where, when and which seed."""


@dataclass(slots=True)
class Result:
    """What a simulation leaves: the world at its end and all rows.

    `rows` are what nodes and the observer reported, `deliveries` the tactile samples that the PC
    received, `trail` all handler calls; structured arrays, with the fields of `world.ROW`,
    `world.DELIVERY` and `world.TRAIL`, times in us. `received_kept`: `deliveries` holds all
    samples, rather than none.
    """

    plan: Any
    world: w.World
    rows: Any
    deliveries: Any
    trail: Any
    counters: list[int]
    ended_us: int
    wall_s: float
    fingerprint: str
    handled: int
    arrived: int
    interrupted: bool
    received_kept: bool = False


def _modules() -> list[ModuleType]:
    from innervate.kernel import invariants
    from innervate.protocol import (
        arith,
        outbox,
        skin,
        skin_down,
        skin_route,
        skin_sink,
        skin_static,
    )
    from innervate.protocol import rng as generator
    from innervate.sim import checks, clocks, delays, wheel, wires

    return [
        arith, outbox, generator, skin_route, skin_down, skin, skin_sink, skin_static,
        wheel, clocks, wires, delays, invariants, checks, skin_stack, static_stack,
    ]  # fmt: skip


def _rare() -> list[ModuleType]:
    """What runs too seldom to be worth copying into every caller."""
    from innervate.sim import commands, observer, orders, rows, touch

    return [observer, commands, orders, touch, rows, taps]


@functools.cache
def compiled_loop(static: bool) -> Callable[..., None]:
    """The compiled loop of the skin, or of its static baseline."""
    door.register(*_rare(), hot=False)
    door.register(*_modules())
    door.register_functions(loop.pressing, loop.foresee)
    parts = loop.build(static_stack if static else skin_stack)
    door.register_functions(*parts[:-1])
    advance = door.compiled(parts[-1])
    return lambda world, until, budget: advance(tables.borrowed(world), until, budget)


def loop_name(plan: Any) -> str:
    """Which loop a plan runs on, for `kernel.door.is_compiled`."""
    return "static" if plan.params["rule"] == RULE_STATIC else "skin"


def plain_loop(static: bool) -> Callable[..., None]:
    """The same loop, uncompiled."""
    return loop.build(static_stack if static else skin_stack)[-1]


def simulate(
    plan: Any,
    *,
    plain: bool = False,
    checks: bool = True,
    observe: bool = True,
    deliveries: bool = False,
    trail: bool = False,
    progress: Progress | None = None,
    tap: taps.Tap | None = None,
) -> Result:
    """Run a plan to its end; an interrupt (Ctrl-C) ends it early and keeps what was done.

    `plain` runs the same loop uncompiled. Without `checks` and `observe` no rows are kept.
    `progress(time_us, duration_us)` is called now and then.
    `tap` is handed copies of all frames as they leave and come in (see taps.py); none of a script.
    A plan with a script plays that instead, on plain state.
    Raises InvariantBroken, and ScenarioError for a step that cannot be taken.
    """
    static = plan.params["rule"] == RULE_STATIC
    if plan.script:
        started = wall_s()
        stack = static_stack if static else skin_stack
        world, now = script.play(plan, stack, checks, trail)
        if int(get(world.run, 0, "status")) == loop.BROKEN:
            raise InvariantBroken(story(plan, world))
        return _result(plan, world, _Keep(), now, wall_s() - started, False)
    advance = (plain_loop if plain else compiled_loop)(static)
    world = builder.build(plan, plain, checks, observe, deliveries, trail, tap is not None)
    keep = _Keep()
    advance(world, 0, 1)  # nothing is due before time 0: only compiles, or loads what was compiled
    if not plain:
        door.mark_compiled(loop_name(plan))
    started = wall_s()
    with Stop() as stop:
        status = loop.BUDGET
        while status != loop.DONE and not stop.asked:
            advance(world, plan.duration_us, SLICE_EVENTS)
            status = int(get(world.run, 0, "status"))
            if status == loop.BROKEN:
                raise InvariantBroken(story(plan, world))
            if status == loop.POOL_FULL:
                world = builder.grow_pool(world)
            keep.collect(world, final=False)
            now = plan.duration_us if status == loop.DONE else int(world.wheel.clock[0])
            builder.hand_over(world, tap, now)
            if progress is not None:
                progress(now, plan.duration_us)
        done = _result(plan, world, keep, now, wall_s() - started, status != loop.DONE)
        done.received_kept = deliveries
        return done


def _result(
    plan: Any, world: w.World, keep: _Keep, ended_us: int, took_s: float, interrupted: bool
) -> Result:
    rows, delivered, steps = keep.collect(world, final=True)
    return Result(
        plan=plan,
        world=world,
        rows=rows,
        deliveries=delivered,
        trail=steps,
        counters=[int(count) for count in world.counters],
        ended_us=ended_us,
        wall_s=took_s,
        fingerprint=f"{int(get(world.run, 0, 'fingerprint')) & (1 << 64) - 1:016x}",
        handled=int(get(world.run, 0, "handled")),
        arrived=sum(int(world.counters[ARRIVED + block]) for block in BLOCKS),
        interrupted=interrupted,
    )


class _Keep:
    """Moves filled rows out of the loop's tables, so that these can stay small."""

    def __init__(self) -> None:
        self.parts: dict[str, list[Any]] = {"rows": [], "deliveries": [], "trail": []}
        self.names = {"rows": w.ROW, "deliveries": w.DELIVERY, "trail": w.TRAIL}

    def collect(self, world: w.World, final: bool) -> tuple[Any, ...]:
        for name, parts in self.parts.items():
            count = int(get(world.run, 0, name))
            table = getattr(world, name)
            if count > len(table) // 2 or final:
                parts.append(self._array(table, name, count))
                builder.put(world.run, 0, **{name: 0})
        if not final:
            return ()
        return tuple(np.concatenate(parts) for parts in self.parts.values())

    def _array(self, table: Any, name: str, count: int) -> Any:
        if not isinstance(table, list):
            return table[:count].copy()
        fields = self.names[name]
        tuples = [
            tuple(tuple(v) if isinstance(v := getattr(r, f), list) else v for f in fields)
            for r in table[:count]
        ]
        return np.array(tuples, w.row_dtype(fields))


def story(plan: Any, world: w.World) -> str:
    """A broken invariant in one line."""
    from innervate.sim import observer

    node = int(get(world.run, 0, "broken_node"))
    other = int(get(world.run, 0, "broken_other"))
    at = max(int(get(world.run, 0, "broken_at")), 0) / 1e6
    label = plan.graph.label
    what = {
        observer.BROKEN_LOOP: f"forwarding loop through {label(node)}",
        observer.BROKEN_FEASIBLE: f"feasible distance of {label(node)} is not worse than that of "
        f"its parent {label(other)}",
        observer.BROKEN_RANGE: f"a value of {label(node)} is out of its declared range",
        observer.BROKEN_OUTBOX: f"outbox of {label(node)} overflowed",
    }[int(get(world.run, 0, "broken"))]
    return f"invariant broken at {at:.6f} s (seed {plan.seed}): {what}"
