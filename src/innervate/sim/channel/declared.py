"""A network on a shared channel that only declares its protocol: its functions, its records, runs.

Of its `Network` it takes `protocol` (on_start, on_frame, its port 0, on_timer, on_input,
on_carrier; TIMERS up to 2) and `fields`. A frame says by `slots` how long it is on the air. A field
`made_at` of a frame, where declared, is when its content was handed in.
"""

import functools
from collections.abc import Callable, Mapping
from types import ModuleType
from typing import Any, ClassVar, NamedTuple

from innervate.dialect import arith, outbox, rng
from innervate.folders import invariants_of
from innervate.kernel import compilation, tables
from innervate.network import Network, layouts_of, networks
from innervate.sim import came, clocks, heap, heard, rows, taps
from innervate.sim.came import Came
from innervate.sim.channel import listening, loop, medium, traffic
from innervate.sim.channel import world as w
from innervate.sim.channel.build import OUTBOX, Records, build
from innervate.sim.channel.simulation import Channel
from innervate.sim.counts import Counts
from innervate.sim.handlers import handlers
from innervate.sim.own import Unfit, check_of, frames_of, modules_of
from innervate.sim.recorded import Recorded
from innervate.sim.sent import look_of, parts_of
from innervate.sim.tables import DELIVERY, ROW, TRAIL, Names, Tables, get, put

# What the medium itself looks at, besides what a protocol declares.
OF_FRAME = (
    ("count", 0, 0, 1, "packets", "not used"),
    ("handle", 0, 0, 65535, "number", "not used"),
)
OF_ITEM = (*OF_FRAME, ("ago", 0, 0, 1, "us", "not used"))
OF_NODE = (("queued", 0, 0, 0, "packets", "not used"),)


class Above(NamedTuple):
    """What nodes are handed, when, how much of it came, and what is counted (see heard.py)."""

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
    do = ModuleType(f"{protocol.__name__} on a channel")
    look, frames = look_of(fields.FRAME, layouts_of(network)), frames_of(fields.FRAME)
    for some in (
        frames, parts_of(look), _entries(protocol, look, **frames), _noted(**frames),
        _watching(list(invariants_of(network, "node_").values())),
    ):  # fmt: skip
        vars(do).update(some)
    return do


def _entries(
    protocol: ModuleType, look: Callable[..., None], *, copy_frame: Any, stamp: Any, **_others: Any
) -> dict[str, Callable[..., Any]]:
    """The protocol's functions with the world as their first argument."""
    made = handlers(protocol, look=look)
    given = made["on_input"]

    def on_input(world, node, now, kind):  # type: ignore[no-untyped-def]
        if kind == listening.PACKET:
            radio = world.radios[node]
            place = radio.next_offer - radio.backlog
            radio.backlog -= 1
            copy_frame(world.item[0], world.above.items[place])
            stamp(world.item[0], world.arrivals[place])
            given(world, node, now, world.above.kinds[place])

    return {**made, "give_input": given, "on_input": on_input}


def _noted(
    *, copy_frame: Any, kind_of: Any, latency_of: Any, **_others: Any
) -> dict[str, Callable[..., Any]]:
    """What is kept of frames and deliveries."""

    def record_sent(world, node, frame, time):  # type: ignore[no-untyped-def]
        world.above.counters[heard.SENT] += world.degree[node]
        if world.run[0].tap_limit > 0:
            start = time + world.run[0].ta_us
            copy_frame(world.tapped[world.run[0].taps], frame)
            taps.record_frame(world, start, node, 1, taps.FINE).sender = node

    def record_received(world, node, what, time, clear, received):  # type: ignore[no-untyped-def]
        why = listening.why(world, node, what, clear, received)
        if world.run[0].tap_limit > 0 and world.radios[node].alive:
            copy_frame(world.tapped[world.run[0].taps], world.frames[what])
            row = taps.record_frame(world, time, node, 0, why)
            row.start, row.sender = world.air[what].start, what >> heap.AIR_BITS

    def note_received(world, node, frame, time):  # type: ignore[no-untyped-def]
        listening.keep(world, node, kind_of(frame), time, latency_of(frame, time))

    return {"record_sent": record_sent, "record_received": record_received,
            "note_received": note_received, "note_sent": listening.note_sent,
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
    compilation.register(arith, outbox, rng, heap, medium, clocks, listening, came)
    compilation.register_functions(*(one for one in vars(do).values() if callable(one)))
    compilation.register(*modules_of(network))
    compilation.register_functions(loop.pressing, *loop.FUNCTIONS, hot=False)
    return tables.Lending(compilation.compiled_as_one(loop.bind(do)))


class DeclaredChannel(heard.Heard, Channel):
    """Nodes on a channel whose protocol is declared; packets that are handed up are deliveries."""

    tables: ClassVar[Mapping[str, Names]] = {
        "rows": ROW, "packets": DELIVERY, "trail": TRAIL,
    }  # fmt: skip

    def take(self) -> dict[str, Any]:
        """The rows that were made since the last call, by table."""
        found = super().take()
        found["deliveries"] = found.pop("packets")
        return found

    def counts(self) -> Counts:
        """Frames, one for each node that could hear it; what nodes were given and gave up."""
        radios, nodes = self.world.radios, self.plan.stations
        off = tuple(node for node in range(nodes) if not get(radios, node, "alive"))
        return self.counts_of(self.world.above, off, nodes)


def world_of(plan: Any, plain: bool, kept: Recorded) -> w.World:
    """The world of a plan (see `scenario/declared/channel.py`), before its first event."""
    network = networks()[plan.kind]
    fields, made = network.fields, Tables(plain)
    frame = extended(fields.FRAME, OF_FRAME)
    of = Records(extended(fields.STATE, OF_NODE), fields.PARAMS, frame,
                 extended(fields.FRAME, OF_ITEM),
                 getattr(network.protocol, "OUTBOX", OUTBOX), DELIVERY)  # fmt: skip
    items = made.states(fields.FRAME, len(plan.inputs) + 1)
    for place, given in enumerate(plan.inputs):
        put(items, place, **given.item)
    kinds = made.given([one.kind for one in plan.inputs] + [0])
    above = Above(items=items, kinds=kinds, **heard.tables_of(made, plan))
    return build(plan, of, plain, kept)._replace(above=above)


def simulation(plan: Any, *, plain: bool = False, **kept: bool) -> DeclaredChannel:
    """A plan's network before its first event; `kept` as in `sim.recorded`."""
    network = networks()[plan.kind]
    kept.pop("deliveries", None)
    advance = loop.bind(functions(network)) if plain else compiled_loop(network)
    world = world_of(plan, plain, Recorded(**kept))
    return DeclaredChannel(plan, world, advance, "" if plain else plan.kind)
