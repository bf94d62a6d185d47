"""Runs a plan: builds the world, drives the loop in slices, collects its tables."""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import ModuleType
from typing import Any, ClassVar

from innervate.kernel.wall import wall_s
from innervate.networks.skin.sim import build as builder
from innervate.networks.skin.sim import script, static_stack
from innervate.networks.skin.sim import stack as skin_stack
from innervate.sim import taps
from innervate.sim.cables import loop
from innervate.sim.cables import world as w
from innervate.sim.cables.simulation import Cables
from innervate.sim.cables.wires import ARRIVED, BLOCKS
from innervate.sim.driver import Ended, InvariantBroken, Progress
from innervate.sim.status import BROKEN
from innervate.sim.tables import get, move_rows

RULE_STATIC = 3


@dataclass(slots=True)
class Result:
    """What a simulation leaves: the world at its end and all rows.

    `rows` are what nodes and the observer reported, `deliveries` the tactile samples that the PC
    received, `trail` all handler calls; structured arrays, with the fields of `world.ROW`,
    `build.DELIVERY` and `world.TRAIL`, times in us. `received_kept`: `deliveries` holds all
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


def _modules() -> tuple[ModuleType, ...]:
    from innervate.dialect import arith, outbox
    from innervate.dialect import rng as generator
    from innervate.networks.skin import invariants
    from innervate.networks.skin.protocol import cell, down, route, sink, static
    from innervate.networks.skin.sim import checks
    from innervate.sim.cables import recorder

    return (
        arith, outbox, generator, route, down, cell, sink, static,
        invariants, recorder, checks, skin_stack, static_stack,
    )  # fmt: skip


def _rare() -> tuple[ModuleType, ...]:
    """What runs too seldom to be worth copying into every caller."""
    from innervate.networks.skin.sim import observer, orders, touch

    return (observer, orders, touch)


@functools.cache
def compiled_loop(static: bool) -> Callable[..., None]:
    """The compiled loop of the skin, or of its static baseline."""
    stack = static_stack if static else skin_stack
    return loop.compiled(stack, _modules(), _rare())


def loop_name(plan: Any) -> str:
    """Which loop a plan runs on, for `kernel.door.is_compiled`; a script needs none."""
    if plan.script:
        return ""
    return "static" if plan.params["rule"] == RULE_STATIC else "skin"


def plain_loop(static: bool) -> Callable[..., None]:
    """The same loop, uncompiled."""
    return loop.bind(static_stack if static else skin_stack)


class SkinSimulation(Cables):
    """A skin under way."""

    tables: ClassVar[Mapping[str, tuple[str, ...]]] = {
        "rows": w.ROW, "deliveries": builder.DELIVERY, "trail": w.TRAIL,
    }  # fmt: skip

    def story(self) -> str:
        """The broken invariant, in one line."""
        return story(self.plan, self.world)


def simulation(plan: Any, *, plain: bool = False, **kept: bool) -> SkinSimulation:
    """A plan's skin before its first event; `kept` as in `build`."""
    static = plan.params["rule"] == RULE_STATIC
    advance = (plain_loop if plain else compiled_loop)(static)
    name = "" if plain else loop_name(plan)
    return SkinSimulation(plan, builder.build(plan, plain, **kept), advance, name)


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
    if plan.script:
        return _played(plan, checks, trail)
    running = simulation(
        plan, plain=plain, checks=checks, observe=observe, deliveries=deliveries, trail=trail,
        tap=tap is not None,
    )  # fmt: skip
    done = _result(running, running.finish(progress, tap))
    done.received_kept = deliveries
    return done


def _played(plan: Any, checks: bool, trail: bool) -> Result:
    """A scenario's script, in place of the clock."""
    started = wall_s()
    stack = static_stack if plan.params["rule"] == RULE_STATIC else skin_stack
    world, now = script.play(plan, stack, checks, trail)
    if int(get(world.run, 0, "status")) == BROKEN:
        raise InvariantBroken(story(plan, world))
    played = SkinSimulation(plan, world, lambda *_: None)
    move_rows(world, played._kept, played.tables, played.wide)
    return _result(played, Ended(now, wall_s() - started, False, played.take()))


def _result(running: SkinSimulation, ended: Ended) -> Result:
    world = running.world
    return Result(
        plan=running.plan,
        world=world,
        counters=[int(count) for count in world.counters],
        ended_us=ended.ended_us,
        wall_s=ended.wall_s,
        fingerprint=running.fingerprint,
        handled=int(get(world.run, 0, "handled")),
        arrived=sum(int(world.counters[ARRIVED + block]) for block in BLOCKS),
        interrupted=ended.interrupted,
        **ended.rows,
    )


def story(plan: Any, world: w.World) -> str:
    """A broken invariant in one line."""
    from innervate.networks.skin.sim import observer

    node = int(get(world.run, 0, "broken_node"))
    other = int(get(world.run, 0, "broken_other"))
    at = max(int(get(world.run, 0, "broken_at")), 0) / 1e6
    label = plan.graph.label
    what = {
        observer.BROKEN_LOOP: f"forwarding loop through {label(node)}",
        observer.BROKEN_FEASIBLE: f"feasible distance of {label(node)} is not worse than that of "
        f"its parent {label(other)}",
        w.BROKEN_RANGE: f"a value of {label(node)} is out of its declared range",
        w.BROKEN_OUTBOX: f"outbox of {label(node)} overflowed",
    }[int(get(world.run, 0, "broken"))]
    return f"invariant broken at {at:.6f} s (seed {plan.seed}): {what}"
