"""A network over a field that only declares its protocol: its functions, its records, its runs.

Of its `Network` it takes `protocol` (on_start, on_frame, its port 0, on_timer, on_input, TIMERS;
and on_carrier, or, `over` a medium access, on_sent, if it has one), `fields` and `frames`. Of a
frame's fields the medium knows `to` (only that node is given it, ALL = every one), `rssi` (how loud
it came in, dBm) and `made_at` (when its content was handed in), each where it is declared.
"""

import functools
import importlib
from collections.abc import Callable, Mapping
from types import ModuleType
from typing import Any, ClassVar

from innervate.dialect import arith, outbox, rng
from innervate.dialect.access import ALL
from innervate.dialect.folder import MEASURED
from innervate.dialect.outbox import URGENT
from innervate.folders import invariants_of
from innervate.kernel import compilation, tables
from innervate.network import Network, access_of, layouts_of, networks
from innervate.scenario.declared.field import sizes_of
from innervate.scenario.declared.moving import placed_of
from innervate.sim import came, clocks, heap, heard, rows, taps
from innervate.sim.came import note_came
from innervate.sim.channel.build import grow_heap
from innervate.sim.counts import Counts
from innervate.sim.field import access, build, calls, listening, loop, medium, motion, powers
from innervate.sim.field import world as w
from innervate.sim.field.simulation import Field
from innervate.sim.field.states import DEAD, OFF
from innervate.sim.handlers import access_handlers, handlers
from innervate.sim.own import Unfit, check_of, frames_of, modules_of
from innervate.sim.recorded import Recorded
from innervate.sim.sent import look_of, parts_of
from innervate.sim.status import POOL_FULL
from innervate.sim.tables import DELIVERY, ROW, TRAIL, Names, get

BELOW = (
    access.power_on, access.power_off, access.expire_below, access.dispatch_below, access.short,
    access.due, access.step,
)  # fmt: skip
KEPT = (
    listening.pressing, listening.offer, listening.tell_sent, listening.note_report,
    listening.record_sent,
)  # fmt: skip


def functions(network: Network, moves: bool = False) -> ModuleType:
    """What the loop calls (see `sim/field`); `moves`: there are robots."""
    protocol, fields = network.protocol, network.fields
    names = {name for name, length, *_ in fields.FRAME if not length}
    look, frames = look_of(fields.FRAME, layouts_of(network)), frames_of(fields.FRAME, MEASURED)
    below = importlib.import_module(access_of(network).entry) if network.over else None
    do = compilation.bound(f"{protocol.__name__} over a field", BELOW, KEPT)
    for some in (
        frames, {"frame_bytes": _frame_bytes(network.frames)}, parts_of(look),
        _entries(protocol, names, look), access_handlers(below),
        {"sample": motion.sample if moves else listening.sample},
        {"tell_place": _told(network.fields, frames["copy_frame"])},
        _noted("rssi" in names, **frames),
        _checks(list(invariants_of(network, "node_").values())),
    ):  # fmt: skip
        vars(do).update(some)
    return do


def _frame_bytes(frames: Any) -> Callable[..., int]:
    """`frame_bytes`, written out for the kinds of a layout."""
    sizes = sizes_of(frames)
    lines = [line for kind, size in sizes.items()
             for line in (f"    if frame.kind == {kind}:", f"        return {size}")]  # fmt: skip
    text = "\n".join(["def frame_bytes(frame):", *lines, f"    return {max(sizes.values())}"])
    made: dict[str, Any] = {}
    exec(compile(text, "frames of a protocol", "exec"), made)
    found: Callable[..., int] = made["frame_bytes"]
    return found


def _entries(
    protocol: ModuleType, names: set[str], look: Callable[..., None]
) -> dict[str, Callable[..., Any]]:
    """The protocol's functions with the world as their first argument, and what calls them."""
    made = handlers(protocol, look=look)
    made |= {"tell_end": listening.tell_nothing, "note_carriers": listening.tell_nobody}
    if "on_sent" in made:
        made["tell_end"] = listening.tell_gone
    elif "on_carrier" in made:
        made["tell_end"] = listening.tell_own_end
        made["note_carriers"] = listening.tell_changes
    take = made["on_frame"]

    def on_own_frame(world, node, now, frame):  # type: ignore[no-untyped-def]
        if frame.to == node or frame.to == ALL:
            take(world, node, now, frame)

    return made | {"take_frame": take, "on_frame": on_own_frame} if "to" in names else made


def _noted(
    is_measured: bool, *, copy_frame: Any, kind_of: Any, stamp: Any, latency_of: Any, **_others: Any
) -> dict[str, Callable[..., Any]]:
    """What is kept of frames and deliveries, and what nodes are handed."""

    def tap(world, place, at, time, out, why):  # type: ignore[no-untyped-def]
        listening.count_frame(world, place, out, why)
        if world.run[0].tap_limit > 0:
            copy_frame(world.tapped[world.run[0].taps], world.frames[place])
            row = taps.record_frame(world, time, at, out, why)
            row.start, row.sender = world.air[place].start, world.air[place].node

    def hand_down(world, do, node, frame, act, time):  # type: ignore[no-untyped-def]
        radio = world.radios[node]
        act.b, act.c = min(max(act.b, 0), access.ATTEMPT_MAX), act.c & URGENT
        if not act.c and (radio.held != medium.NONE or radio.waiting > 0):
            listening.put_off(world, do, node, frame, act)
            return do.digest(frame)
        blocked = world.run[0].blocked
        mark = access.hand_down(world, do, node, frame, act, time)
        if act.c and world.run[0].blocked > blocked:
            listening.lose_all(world, node, heard.BUSY)
        return mark

    def record_delivered(world, node, frame, time):  # type: ignore[no-untyped-def]
        latency = latency_of(frame, time)
        world.counters[heard.DELIVERED] += 1
        rows.record_delivery(world, time, node, 0, kind_of(frame), latency)
        note_came(world.came, time, latency)

    def take_item(world, index):  # type: ignore[no-untyped-def]
        copy_frame(world.item[0], world.items[index])
        stamp(world.item[0], world.offers[index].time)

    def note_heard(world, node, place):  # type: ignore[no-untyped-def]
        pass

    def note_loud(world, node, place):  # type: ignore[no-untyped-def]
        frame = world.frames[place]
        frame.rssi = medium.rssi_dbm(world, world.air[place].node, node)

    return {"tap": tap, "hand_down": hand_down, "record_delivered": record_delivered,
            "take_item": take_item,
            "note_heard": note_loud if is_measured else note_heard}  # fmt: skip


def _told(fields: Any, copy_frame: Any) -> Callable[..., None]:
    """What tells a robot where it is: an input, as its network's `PLACED` says."""
    placed = placed_of(fields)
    if placed is None:
        return listening.tell_no_place
    kind, _unit, (x_low, x_high), (y_low, y_high) = placed

    def tell_place(world, do, index, time):  # type: ignore[no-untyped-def]
        walk, item = world.walks[index], world.item[0]
        copy_frame(item, world.items[len(world.items) - 1])
        item.x = min(max(walk.told_x, x_low), x_high)
        item.y = min(max(walk.told_y, y_low), y_high)
        calls.give(world, do, walk.node, time, kind)

    return tell_place


def _checks(own: list[Callable[..., Any]]) -> dict[str, Callable[..., Any]]:
    """The checks after every call; and what a node loses that is switched on again: its queue.

    What its `on_start` does not set is as before, as in stable storage, over any medium.
    """
    check_own = check_of(own, "stations")

    def check(world, do, node, time):  # type: ignore[no-untyped-def]
        if not calls.is_sound(world, node):
            medium.breaks(world, medium.BROKEN_RANGE, node)
        check_own(world, node, (time + world.radios[node].offset) & arith.MASK30)

    def wipe(world, node):  # type: ignore[no-untyped-def]
        world.radios[node].first = world.radios[node].waiting = 0

    return {"check": check, "wipe": wipe, "check_own": check_own}


@functools.cache
def compiled_loop(network: Network, moves: bool = False) -> Callable[..., None]:
    """The loop of a network over a field, compiled with its protocol; `moves`: with robots."""
    do = functions(network, moves)
    compilation.register(arith, outbox, rng, heap, clocks)
    compilation.register(medium, rows, taps, listening, came, hot=False)
    compilation.register_functions(powers.strength)
    if moves:
        compilation.register(motion, hot=False)
        compilation.register_functions(*motion.CALLED)
    modules = modules_of(network)
    if network.over:
        modules += compilation.modules_of(importlib.import_module(access_of(network).entry))
    compilation.register(*modules, hot=False)
    compilation.register(calls, loop, access, hot=False)
    compilation.register_functions(*filter(callable, vars(do).values()), hot=False)
    return tables.Lending(compilation.compiled_as_one(loop.bind(do)))


class DeclaredField(heard.Heard, Field):
    """Nodes in a field whose protocol is declared."""

    wide = w.WIDE
    tables: ClassVar[Mapping[str, Names]] = {
        "rows": ROW, "deliveries": DELIVERY, "trail": TRAIL,
    }  # fmt: skip

    def grow(self, status: int) -> None:
        """Make room for more events."""
        if status == POOL_FULL:
            self.world = grow_heap(self.world)

    def counts(self) -> Counts:
        """Frames, one for each node that could hear it; what nodes were given and gave up."""
        nodes = self.plan.nodes
        off = tuple(node for node in range(nodes) if self._is_off(node))
        lost = self.named(self.world.counters, listening.LOST)
        return self.counts_of(self.world, off, nodes)._replace(
            lost_by={name: many for name, many in lost.items() if many}
        )

    def _is_off(self, node: int) -> bool:
        """Switched off, or not there yet; not who is only about to start with the others."""
        state = int(get(self.world.radios, node, "state"))
        return state == DEAD or (state == OFF and bool(self.plan.absent[node]))


def simulation(plan: Any, *, plain: bool = False, **kept: bool) -> DeclaredField:
    """A plan's network before its first event; `kept` as in `sim.recorded`.

    Raises:
        Unfit: its frames have no kind, or no layouts.
    """
    network = networks()[plan.kind]
    if not network.has("frames") or not hasattr(network.frames, "LAYOUTS"):
        raise Unfit("frames.LAYOUTS is missing: it says how long a frame is on the air")
    kept.pop("deliveries", None)
    moves = bool(plan.walks)
    advance = loop.bind(functions(network, moves)) if plain else compiled_loop(network, moves)
    world = build.build(plan, network, plain, Recorded(**kept))
    return DeclaredField(plan, world, advance, "" if plain else plan.kind)
