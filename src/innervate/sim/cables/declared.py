"""A network over cables that only declares its protocol: its functions, its records, its runs.

Of its `Network` it takes `protocol` (a module: `on_start`, `on_frame`, `on_timer`, `on_input` of a
node; TIMERS; perhaps OUTBOX) and `fields` (STATE, FRAME, PARAMS). All nodes are equal but for
`state.number`. A field `made_at` of a frame, where declared, is when its content was handed to its
first sender: latencies are taken from it; 0 is for what no user handed in, which has none.
"""

import functools
from bisect import bisect_right
from collections.abc import Callable, Iterable, Mapping
from functools import cached_property
from types import ModuleType
from typing import Any

from innervate.dialect.arith import MASK30
from innervate.folders import invariants_of
from innervate.kernel import compilation
from innervate.kernel.bits import mix
from innervate.network import Network, layouts_of, networks
from innervate.scenario.actions.cables import GIVE
from innervate.sim import clocks, wheel
from innervate.sim.cables import loop, recorder
from innervate.sim.cables.build import Added, Records, build
from innervate.sim.cables.simulation import Cables
from innervate.sim.cables.world import ALIVE, SOURCE, World
from innervate.sim.counts import Counts
from innervate.sim.own import check_of, message_times, words_of
from innervate.sim.recorded import Recorded
from innervate.sim.sent import WORDS, look_of, parts_of
from innervate.sim.tables import Tables, get, put

OUTBOX = 16


class Unfit(ValueError):
    """A protocol cannot be simulated as it is declared."""


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
    look = look_of(fields.FRAME, layouts)
    vars(do).update(parts_of(look))
    vars(do).update(_entries(protocol, look))
    vars(do).update(frames_of(fields.FRAME))
    if hasattr(protocol, "copy_frame"):
        vars(do)["copy_frame"] = protocol.copy_frame
    names = {name for name, length, *_ in fields.FRAME if not length}
    vars(do).update(_users_side(do, "made_at" in names))
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
    start, frame_in = protocol.on_start, protocol.on_frame
    timer_due, given = protocol.on_timer, protocol.on_input

    def on_start(world, node, now, cause):  # type: ignore[no-untyped-def]
        start(world.cells[node], world.params[0], now, cause, world.out)
        look(world, node)

    def on_frame(world, node, time, port, frame):  # type: ignore[no-untyped-def]
        now = clocks.reading(world.clocks[node], time) & MASK30
        frame_in(world.cells[node], world.params[0], now, port, frame, world.out)
        look(world, node)

    def on_timer(world, node, now, timer):  # type: ignore[no-untyped-def]
        timer_due(world.cells[node], world.params[0], now, timer, world.out)
        look(world, node)

    def on_input(world, node, now, kind):  # type: ignore[no-untyped-def]
        given(world.cells[node], world.params[0], now, kind, world.sample[0], world.out)
        look(world, node)

    return {"on_start": on_start, "on_frame": on_frame, "on_timer": on_timer, "on_input": on_input}


def frames_of(declared: Any) -> dict[str, Callable[..., Any]]:
    """`copy_frame`, `digest`, `kind_of` and `block_of`, written out for the fields of a frame."""
    copies, words = [], []
    for name, length, *_ in declared:
        for place in [f"{name}[{i}]" for i in range(length)] if length else [name]:
            copies.append(f"    to.{place} = frm.{place}")
            if name != "made_at":
                words.append(f"    word = mix(word, frame.{place})")
    kind = "frame.kind" if any(name == "kind" for name, *_ in declared) else "-1"
    text = "\n".join([
        "def copy_frame(to, frm):", *copies,
        "def digest(frame):", "    word = 1", *words, "    return word",
        "def kind_of(frame):", f"    return {kind}",
        "def block_of(frame):", "    return 0",
    ])  # fmt: skip
    made: dict[str, Any] = {"mix": mix}
    exec(compile(text, "frames of a protocol", "exec"), made)
    return {name: made[name] for name in ("copy_frame", "digest", "kind_of", "block_of")}


def _users_side(do: ModuleType, is_timed: bool) -> dict[str, Callable[..., Any]]:
    """What is handed to nodes, and what they deliver."""
    copy_frame, kind_of = do.copy_frame, do.kind_of

    def take_input(world, command):  # type: ignore[no-untyped-def]
        copy_frame(world.sample[0], world.carrier[command.value])
        return command.index if world.alive[command.node] == ALIVE else 0

    def sense(world, node, time):  # type: ignore[no-untyped-def]
        pass

    def on_deliver(world, time, node, port, frame):  # type: ignore[no-untyped-def]
        recorder.keep_delivered(world, time, node, port, kind_of(frame))

    if not is_timed:
        return {"take_input": take_input, "sense": sense, "on_deliver": on_deliver}

    def take_timed(world, command):  # type: ignore[no-untyped-def]
        kind = take_input(world, command)
        world.sample[0].made_at = max(command.at & MASK30, 1)
        return kind

    def sense_timed(world, node, time):  # type: ignore[no-untyped-def]
        world.sample[0].made_at = max(time & MASK30, 1)

    def deliver_timed(world, time, node, port, frame):  # type: ignore[no-untyped-def]
        on_deliver(world, time, node, port, frame)
        if frame.made_at > 0:
            recorder.keep_latency(world, (time - frame.made_at) & MASK30)

    return {
        "take_input": take_timed, "sense": sense_timed, "on_deliver": deliver_timed,
        "take_any_input": take_input, "on_any_deliver": on_deliver,
    }  # fmt: skip


class DeclaredCables(Cables):
    """Nodes whose protocol is declared, with invariants of their own."""

    @cached_property
    def broken_words(self) -> dict[int, str]:  # type: ignore[override]
        """What is broken, by number."""
        return {**Cables.broken_words, **WORDS, **words_of(self.plan.kind)}

    @cached_property
    def message_times(self) -> list[int]:
        """When users give what is to be delivered, us."""
        return message_times(self.plan)

    def counts(self) -> Counts:
        """Frames of all cables, and what users gave and got."""
        done = int(get(self.world.run, 0, "next_command"))
        newest_us = int(get(self.world.commands, done - 1, "at")) if done else 0
        offered = bisect_right(self.message_times, max(self.clock_us(), newest_us))
        return super().counts()._replace(offered=offered)


def _functions(network: Network) -> ModuleType:
    rules = invariants_of(network, "node_")
    return functions(network.protocol, network.fields, rules, layouts_of(network))


def plain_loop(kind: str) -> Callable[..., None]:
    """The loop of a network, uncompiled."""
    return loop.bind(_functions(networks()[kind]))


@functools.cache
def compiled_loop(network: Network) -> Callable[..., None]:
    """The loop of a network over cables, compiled with its protocol."""
    do = _functions(network)
    own = tuple(filter(callable, vars(do).values()))
    hot = [recorder, *compilation.modules_of(network.protocol)]
    if network.has("invariants"):
        hot += compilation.modules_of(network.invariants)
    advance: Callable[..., None] = loop.compiled(do, tuple(hot), (), own=own)
    return advance


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
    return build(plan, of, tables, kept, Added(carrier=items, inputs=tuple(rows), ways=1))


def simulation(plan: Any, *, plain: bool = False, **kept: bool) -> Cables:
    """A plan's network before its first event; `kept` as in `sim.recorded`."""
    advance = plain_loop(plan.kind) if plain else compiled_loop(networks()[plan.kind])
    name = "" if plain else plan.kind
    return DeclaredCables(plan, world_of(plan, plain, Recorded(**kept)), advance, name)
