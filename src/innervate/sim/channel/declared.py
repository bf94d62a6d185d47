"""A network on a shared channel that only declares its protocol: its functions, its records, runs.

Of its `Network` it takes `protocol` (on_start, on_frame, its port 0, on_timer, on_input,
on_carrier; TIMERS up to 2) and `fields`. A frame says by `slots` how long it is on the air. A field
`made_at` of a frame, where declared, is when its content was handed in.
"""

import functools
from collections.abc import Callable, Mapping
from functools import cached_property
from types import ModuleType
from typing import Any, ClassVar, NamedTuple

import numpy as np

from innervate.dialect import arith, outbox, rng
from innervate.folders import invariants_of
from innervate.kernel import compilation, tables
from innervate.network import Network, layouts_of, networks
from innervate.sim import came, clocks, delays, heap, rows, taps
from innervate.sim.cables.declared import Unfit, frames_of
from innervate.sim.came import Came, note_came
from innervate.sim.channel import listening, loop, medium, traffic
from innervate.sim.channel import world as w
from innervate.sim.channel.build import OUTBOX, Records, build
from innervate.sim.channel.calls import handlers
from innervate.sim.channel.simulation import Channel
from innervate.sim.counts import Counts
from innervate.sim.own import came_of, check_of, message_times, with_messages, words_of
from innervate.sim.recorded import Recorded
from innervate.sim.sent import WORDS, look_of, parts_of
from innervate.sim.tables import Tables, get, put, row_dtype

DELIVERY = ("time", "node", "port", "kind", "latency")
# What the medium itself looks at, besides what a protocol declares.
OF_FRAME = (
    ("count", 0, 0, 1, "packets", "not used"),
    ("handle", 0, 0, 65535, "number", "not used"),
)
OF_ITEM = (*OF_FRAME, ("ago", 0, 0, 1, "us", "not used"))
OF_NODE = (("queued", 0, 0, 0, "packets", "not used"),)


class Above(NamedTuple):
    """What nodes are handed, when, how much of it came, and what is counted (see listening.py)."""

    items: Any
    kinds: Any
    counters: Any
    came: Came


def extended(declared: Any, more: Any) -> Any:
    """Declared fields, and those of the medium that are not among them."""
    names = {name for name, *_ in declared}
    return (*declared, *(field for field in more if field[0] not in names))


def functions(network: Network) -> ModuleType:
    """What the medium calls (see `sim/channel`)."""
    protocol, fields = network.protocol, network.fields
    if protocol.TIMERS > w.TIMERS:
        what = f"a node on a channel has at most {w.TIMERS} timers, not {protocol.TIMERS}"
        raise Unfit(what)
    if "slots" not in {name for name, *_ in fields.FRAME}:
        raise Unfit("FRAME has no field slots: how long a frame is on the air")
    frames = frames_of(fields.FRAME)
    do = ModuleType(f"{protocol.__name__} on a channel")
    names = {name for name, length, *_ in fields.FRAME if not length}
    vars(do).update({name: frames[name] for name in ("copy_frame", "digest")})
    look = look_of(fields.FRAME, layouts_of(network))
    vars(do).update(parts_of(look))
    vars(do).update(_entries(protocol, look, frames["copy_frame"], "made_at" in names))
    vars(do).update(_noted(frames["copy_frame"], frames["kind_of"], "made_at" in names))
    vars(do).update(_watching(list(invariants_of(network, "node_").values())))
    return do


def _entries(
    protocol: ModuleType, look: Callable[..., None], copy: Any, is_timed: bool
) -> dict[str, Callable[..., Any]]:
    """The protocol's functions with the world as their first argument."""
    given = protocol.on_input

    def hand_down(world, node):  # type: ignore[no-untyped-def]
        radio = world.radios[node]
        place = radio.next_offer - radio.backlog
        radio.backlog -= 1
        copy(world.item[0], world.above.items[place])
        return place

    def hand_down_timed(world, node):  # type: ignore[no-untyped-def]
        place = hand_down(world, node)
        world.item[0].made_at = max(world.arrivals[place] & arith.MASK30, 1)
        return place

    down = hand_down_timed if is_timed else hand_down

    def on_input(world, node, now, kind):  # type: ignore[no-untyped-def]
        if kind == listening.PACKET:
            kind = world.above.kinds[down(world, node)]
            given(world.stations[node], world.params[0], now, kind, world.item[0], world.out)
            look(world, node)

    return {**_looked(protocol, look),
            "on_input": on_input, "hand_down": hand_down, "hand_down_timed": down}  # fmt: skip


def _looked(protocol: ModuleType, look: Callable[..., None]) -> dict[str, Callable[..., Any]]:
    """The handlers that are called as they are, each with a look at what it sends."""
    start, frame_in, due, _, carrier = handlers(protocol)

    def on_start(world, node, now, cause):  # type: ignore[no-untyped-def]
        start(world, node, now, cause)
        look(world, node)

    def on_frame(world, node, now, frame):  # type: ignore[no-untyped-def]
        frame_in(world, node, now, frame)
        look(world, node)

    def on_timer(world, node, now, timer):  # type: ignore[no-untyped-def]
        due(world, node, now, timer)
        look(world, node)

    def on_carrier(world, node, now, cd, voc):  # type: ignore[no-untyped-def]
        carrier(world, node, now, cd, voc)
        look(world, node)

    return {"start": start, "frame_in": frame_in, "due": due, "carrier": carrier,
            "on_start": on_start, "on_frame": on_frame, "on_timer": on_timer,
            "on_carrier": on_carrier}  # fmt: skip


def _noted(copy: Any, kind_of: Any, is_timed: bool) -> dict[str, Callable[..., Any]]:
    """What is kept of frames and deliveries."""

    def record_sent(world, node, frame, time):  # type: ignore[no-untyped-def]
        world.above.counters[listening.SENT] += world.degree[node]
        if world.run[0].tap_limit > 0:
            start = time + world.run[0].ta_us
            copy(world.tapped[world.run[0].taps], frame)
            taps.record_frame(world, start, node, 1, taps.FINE).sender = node

    def record_received(world, node, what, time, clear, received):  # type: ignore[no-untyped-def]
        why = listening.why(world, node, what, clear, received)
        if world.run[0].tap_limit > 0 and world.radios[node].alive:
            copy(world.tapped[world.run[0].taps], world.frames[what])
            row = taps.record_frame(world, time, node, 0, why)
            row.start, row.sender = world.air[what].start, what >> heap.AIR_BITS

    def note_received(world, node, frame, time):  # type: ignore[no-untyped-def]
        listening.keep(world, node, kind_of(frame), time, -1)

    def note_timed(world, node, frame, time):  # type: ignore[no-untyped-def]
        since = frame.made_at
        latency = (time - since) & arith.MASK30 if since > 0 else -1
        listening.keep(world, node, kind_of(frame), time, latency)
        if since > 0:
            note_came(world.above.came, time - latency)

    return {"record_sent": record_sent, "record_received": record_received,
            "note_received": note_timed if is_timed else note_received, "kind_of": kind_of,
            "note_sent": listening.note_sent,
            "note_delivered": listening.note_delivered}  # fmt: skip


def _watching(own: list[Callable[..., Any]]) -> dict[str, Callable[..., Any]]:
    """The checks after every call: ranges, and the network's own invariants."""
    check_own = check_of(own, "stations")

    def watch(world, node, time, handler, port):  # type: ignore[no-untyped-def]
        listening.check_range(world, node)
        check_own(world, node, (time + world.radios[node].offset) & arith.MASK30)
        rows.record_step(world, node, time, handler, port)

    return {"watch": watch, "check_own": check_own}


@functools.cache
def compiled_loop(network: Network) -> Callable[..., None]:
    """The loop of a network on a channel, compiled with its protocol."""
    do = functions(network)
    compilation.register(traffic, taps, rows, hot=False)
    compilation.register(arith, outbox, rng, heap, medium, clocks, delays, listening, came)
    compilation.register_functions(*(one for one in vars(do).values() if callable(one)))
    modules = compilation.modules_of(network.protocol)
    if network.has("invariants"):
        modules += compilation.modules_of(network.invariants)
    compilation.register(*modules)
    compilation.register_functions(loop.pressing, *loop.FUNCTIONS, hot=False)
    return tables.Lending(compilation.compiled_as_one(loop.bind(do)))


class DeclaredChannel(Channel):
    """Nodes on a channel whose protocol is declared."""

    tables: ClassVar[Mapping[str, tuple[str, ...]]] = {
        "rows": w.ROW, "packets": w.PACKET, "trail": w.TRAIL,
    }  # fmt: skip

    @cached_property
    def broken_words(self) -> dict[int, str]:  # type: ignore[override]
        """What is broken, by number."""
        return {**listening.WORDS, **WORDS, **words_of(self.plan.kind)}

    def take(self) -> dict[str, Any]:
        """The rows by table; packets that were handed up are deliveries."""
        found = super().take()
        packets = found.pop("packets")
        made = np.zeros(len(packets), row_dtype(DELIVERY))
        for name, column in (("time", "time"), ("node", "node"), ("kind", "handle"),
                             ("latency", "slots")):  # fmt: skip
            made[name] = packets[column]
        return {**found, "deliveries": made}

    @cached_property
    def message_times(self) -> list[int]:
        """When users give what is to be delivered, us."""
        return message_times(self.plan)

    def counts(self) -> Counts:
        """Frames, one for each node that could hear it; what nodes were given and gave up."""
        numbers, radios = self.world.above.counters, self.world.radios
        count = self.plan.stations
        lost = {name: int(numbers[place]) for name, place in listening.LOST.items()}
        found = Counts(
            nodes=count,
            off=tuple(node for node in range(count) if not get(radios, node, "alive")),
            sent=int(numbers[listening.SENT]),
            arrived=int(numbers[listening.ARRIVED]),
            lost_by=lost,
            delivered=int(numbers[listening.DELIVERED]),
            is_shared=True,
        )
        return with_messages(found, self.message_times, self.clock_us(), self.world.above.came)


def world_of(plan: Any, plain: bool, kept: Recorded) -> w.World:
    """The world of a plan (see `scenario/declared/channel.py`), before its first event."""
    network = networks()[plan.kind]
    fields, made = network.fields, Tables(plain)
    frame = extended(fields.FRAME, OF_FRAME)
    of = Records(extended(fields.STATE, OF_NODE), fields.PARAMS, frame,
                 extended(fields.FRAME, OF_ITEM),
                 getattr(network.protocol, "OUTBOX", OUTBOX))  # fmt: skip
    items = made.states(fields.FRAME, len(plan.inputs) + 1)
    for place, given in enumerate(plan.inputs):
        put(items, place, **given.item)
    kinds = made.given([one.kind for one in plan.inputs] + [0])
    world = build(plan, of, plain, kept)
    counters = made.numbers(listening.COUNTERS, 0, np.int64)
    return world._replace(above=Above(items, kinds, counters, came_of(plan, made)))


def simulation(plan: Any, *, plain: bool = False, **kept: bool) -> DeclaredChannel:
    """A plan's network before its first event; `kept` as in `sim.recorded`."""
    network = networks()[plan.kind]
    kept.pop("deliveries", None)
    advance = loop.bind(functions(network)) if plain else compiled_loop(network)
    world = world_of(plan, plain, Recorded(**kept))
    return DeclaredChannel(plan, world, advance, "" if plain else plan.kind)
