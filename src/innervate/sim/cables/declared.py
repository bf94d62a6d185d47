"""A network over cables that only declares its protocol: its functions, its records, its runs.

Of its `Network` it takes `protocol` (a module: `on_start`, `on_frame`, `on_timer`, `on_input` of a
node; TIMERS; perhaps OUTBOX) and `fields` (STATE, FRAME, PARAMS). All nodes are equal but for
`state.number`. A field `made_at` of a frame, where declared, is when its content was handed to its
first sender: latencies are taken from it; 0 is for what no user handed in, which has none.
"""

import functools
from collections.abc import Callable, Iterable, Mapping
from types import ModuleType
from typing import Any

from innervate.dialect.arith import MASK30
from innervate.folders import invariants_of
from innervate.network import Network, layouts_of, networks
from innervate.scenario.actions.cables import GIVE
from innervate.sim import came, clocks, wheel
from innervate.sim.cables import loop, recorder
from innervate.sim.cables.build import Added, Records, build
from innervate.sim.cables.simulation import Cables
from innervate.sim.cables.world import ALIVE, SOURCE, World
from innervate.sim.came import note_came
from innervate.sim.counts import Counts
from innervate.sim.handlers import Given, handlers
from innervate.sim.own import (
    Declared,
    Unfit,
    came_of,
    check_of,
    frames_of,
    modules_of,
    with_messages,
)
from innervate.sim.recorded import Recorded
from innervate.sim.sent import look_of, parts_of
from innervate.sim.tables import Tables, get, put

OUTBOX = 16
CELL = Given("world.cells[node], world.params[0]", "world.sample[0]")


def functions(
    protocol: ModuleType, fields: ModuleType, own: Mapping[str, Any] | None = None,
    layouts: Any = (),
) -> ModuleType:  # fmt: skip
    """What the medium calls (see `sim/cables`), of a protocol, its fields, its invariants.

    `layouts` are those of its frames; () = they do not say what is on a wire.
    """
    if SOURCE < protocol.TIMERS:
        raise Unfit(f"a node over cables has at most {SOURCE} timers, not {protocol.TIMERS}")
    do = ModuleType(f"{protocol.__name__} over cables")
    look, frames = look_of(fields.FRAME, layouts), frames_of(fields.FRAME)
    frames["copy_frame"] = getattr(protocol, "copy_frame", frames["copy_frame"])
    for some in (parts_of(look), _entries(protocol, look), frames, _users_side(**frames)):
        vars(do).update(some)
    for name in ("is_off", "on_report", "on_stop", "before_change", "on_change", "check"):
        vars(do)[name] = getattr(recorder, name)
    if own:
        vars(do).update(_checks(own.values()))
    return do


def _checks(own: Iterable[Callable[..., Any]]) -> dict[str, Callable[..., None]]:
    """The check of ranges, and after it those of a network's own invariants."""
    check_own = check_of(own, "cells")

    def check(world, node):  # type: ignore[no-untyped-def]
        recorder.check_range(world, node)
        now = clocks.reading(world.clocks[node], world.wheel.clock[wheel.NOW]) & MASK30
        check_own(world, node, now)

    return {"check": check, "check_own": check_own}


def _entries(protocol: ModuleType, look: Callable[..., None]) -> dict[str, Callable[..., Any]]:
    """The protocol's functions with the world as their first argument."""
    made = handlers(protocol, CELL, look=look, has_ports=True)
    take = made["on_frame"]

    def on_frame(world, node, time, port, frame):  # type: ignore[no-untyped-def]
        take(world, node, clocks.reading(world.clocks[node], time) & MASK30, port, frame)

    return {**made, "take_frame": take, "on_frame": on_frame}


def _users_side(
    *, copy_frame: Any, kind_of: Any, stamp: Any, latency_of: Any, **_others: Any
) -> dict[str, Callable[..., Any]]:
    """What is handed to nodes, and what they deliver; with what `frames_of` makes."""

    def take_input(world, command):  # type: ignore[no-untyped-def]
        copy_frame(world.sample[0], world.carrier[command.value])
        stamp(world.sample[0], command.at)
        return command.index if world.alive[command.node] == ALIVE else 0

    def sense(world, node, time):  # type: ignore[no-untyped-def]
        stamp(world.sample[0], time)

    def on_deliver(world, time, node, port, frame):  # type: ignore[no-untyped-def]
        kind, latency = kind_of(frame), latency_of(frame, time)
        recorder.keep_delivered(world, time, node, port, kind, latency)
        note_came(world.watch, time, latency)

    return {"take_input": take_input, "sense": sense, "on_deliver": on_deliver}


class DeclaredCables(Declared, Cables):
    """Nodes whose protocol is declared, with invariants of their own."""

    def counts(self) -> Counts:
        """Frames of all cables, and what users gave and got."""
        done = int(get(self.world.run, 0, "next_command"))
        newest_us = int(get(self.world.commands, done - 1, "at")) if done else 0
        now_us = max(self.clock_us(), newest_us)
        return with_messages(super().counts(), self.message_times, now_us, self.world.watch)


def _functions(network: Network) -> ModuleType:
    rules = invariants_of(network, "node_")
    return functions(network.protocol, network.fields, rules, layouts_of(network))


@functools.cache
def compiled_loop(network: Network) -> Callable[..., None]:
    """The loop of a network over cables, compiled with its protocol."""
    do = _functions(network)
    own = tuple(filter(callable, vars(do).values()))
    return loop.compiled(do, (recorder, came, *modules_of(network)), (), own=own)


def world_of(plan: Any, plain: bool, kept: Recorded) -> World:
    """The world of a plan (see `scenario/cables.py`), before its first event."""
    network = networks()[plan.kind]
    tables, fields = Tables(plain), network.fields
    room = getattr(network.protocol, "OUTBOX", OUTBOX)
    of = Records(fields.STATE, fields.FRAME, fields.PARAMS, fields.FRAME, outbox=room)
    items = tables.states(fields.FRAME, len(plan.inputs) + 1)
    rows = []
    for place, given in enumerate(plan.inputs):
        put(items, place, **given.item)
        rows.append((given.at_us, GIVE, -1, given.node, place, given.kind))
    added = Added(came_of(plan, tables), items, tuple(rows), ways=1)
    return build(plan, of, tables, kept, added)


def simulation(plan: Any, *, plain: bool = False, **kept: bool) -> Cables:
    """A plan's network before its first event; `kept` as in `sim.recorded`."""
    network = networks()[plan.kind]
    advance = loop.bind(_functions(network)) if plain else compiled_loop(network)
    world = world_of(plan, plain, Recorded(**kept))
    return DeclaredCables(plan, world, advance, "" if plain else plan.kind)
