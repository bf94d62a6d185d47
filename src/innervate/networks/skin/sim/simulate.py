"""Runs a plan: builds the world, drives the loop in slices, collects its tables."""

import functools
from collections.abc import Callable, Mapping
from types import ModuleType
from typing import Any, ClassVar

from innervate.kernel.clock import wall_s
from innervate.networks.skin.protocol import fields
from innervate.networks.skin.protocol.constants import RULE_STATIC
from innervate.networks.skin.sim import build as builder
from innervate.networks.skin.sim import observer, script, static_stack
from innervate.networks.skin.sim import stack as skin_stack
from innervate.networks.skin.sim.counters import LOOPED, NO_ROUTE
from innervate.networks.skin.sim.proved import PC_STAYS
from innervate.sim import taps
from innervate.sim.cables import loop
from innervate.sim.cables.simulation import Cables, Result
from innervate.sim.driver import Ended, InvariantBroken, Progress
from innervate.sim.recorded import Recorded
from innervate.sim.status import BROKEN
from innervate.sim.tables import ROW, TRAIL, Names, get, move_rows


def _modules() -> tuple[ModuleType, ...]:
    from innervate.networks.skin import invariants
    from innervate.networks.skin.protocol import cell, command_window, route, sink, static
    from innervate.networks.skin.sim import checks
    from innervate.sim.cables import recorder

    return (
        route, command_window, cell, sink, static,
        invariants, recorder, checks, skin_stack, static_stack,
    )  # fmt: skip


def _rare() -> tuple[ModuleType, ...]:
    """What runs too seldom to be worth copying into every caller."""
    from innervate.networks.skin.sim import orders, proved, touch

    return (observer, orders, proved, touch)


@functools.cache
def compiled_loop(static: bool) -> Callable[..., None]:
    """The compiled loop of the skin, or of its static baseline."""
    stack = static_stack if static else skin_stack
    return loop.compiled(stack, _modules(), _rare(), "static" if static else "skin")


def loop_name(plan: Any) -> str:
    """Which loop a plan runs on, for `kernel.compilation.is_compiled`; a script needs none."""
    if plan.script:
        return ""
    return "static" if plan.params["rule"] == RULE_STATIC else "skin"


def plain_loop(static: bool) -> Callable[..., None]:
    """The loop as plain Python: the same events, no compiler."""
    return loop.bind(static_stack if static else skin_stack)


class SkinSimulation(Cables):
    """A skin that is simulated in slices: its plan, its world, its loop."""

    tables: ClassVar[Mapping[str, Names]] = {
        "rows": ROW, "deliveries": builder.DELIVERY, "trail": TRAIL,
    }  # fmt: skip

    broken_words: ClassVar[Mapping[int, str]] = {
        observer.BROKEN_LOOP: "forwarding loop through {node}",
        observer.BROKEN_FEASIBLE: "feasible distance of {node} is not worse than that of its "
        "parent {other}",
        **Cables.broken_words,
    }
    sink = (fields.SINK, fields.SINK_PORT)
    dropped: ClassVar[Mapping[str, int]] = {"no_route": NO_ROUTE, "loop": LOOPED}

    def broken(self) -> InvariantBroken:
        """Said with it, if the PC was restarted under rule strict (docs/prove.md)."""
        error = super().broken()
        if not int(get(self.world.run, 0, "outside")) >> PC_STAYS & 1:
            return error
        foreseen = InvariantBroken(f"{error}; rule strict does not stand that the PC is restarted")
        foreseen.is_foreseen = True
        return foreseen


def simulation(plan: Any, *, plain: bool = False, **kept: bool) -> SkinSimulation:
    """A plan's skin before its first event; `kept` as in `sim.recorded`, and `orders`."""
    static = plan.params["rule"] == RULE_STATIC
    advance = (plain_loop if plain else compiled_loop)(static)
    name = "" if plain else loop_name(plan)
    return SkinSimulation(plan, builder.build(plan, plain, **kept), advance, name)


def simulate(
    plan: Any,
    *,
    plain: bool = False,
    progress: Progress | None = None,
    tap: taps.Tap | None = None,
    **kept: bool,
) -> Result:
    """Run a plan to its end; an interrupt (Ctrl-C) ends it early and keeps what was done.

    `plain` runs the same loop uncompiled. `kept` as in `sim.recorded`; without `checks` and
    `observe` no rows are.
    `progress(time_us, duration_us)` is called now and then.
    `tap` is handed copies of all frames as they leave and come in (see taps.py); none of a script.
    A plan with a script plays that instead, on plain state.
    Raises InvariantBroken, and ScenarioError for a step that cannot be taken.
    """
    asked = Recorded(**kept, tap=tap is not None)
    if plan.script:
        return _played(plan, asked)
    running = simulation(plan, plain=plain, **asked._asdict())
    return running.result(running.finish(progress, tap), asked.deliveries)


def _played(plan: Any, asked: Recorded) -> Result:
    """A scenario's script, in place of the clock."""
    started = wall_s()
    stack = static_stack if plan.params["rule"] == RULE_STATIC else skin_stack
    world, now = script.play(plan, stack, asked.checks, asked.trail)
    played = SkinSimulation(plan, world, lambda *_: None)
    if int(get(world.run, 0, "status")) == BROKEN:
        raise played.broken()
    move_rows(world, played._kept, played.tables, played.wide)
    return played.result(Ended(now, wall_s() - started, False, played.take()), False)
