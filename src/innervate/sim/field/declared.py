"""A network over a field that only declares its protocol: its functions, its records, its runs.

Of its `Network` it takes `protocol` (on_start, on_frame, its port 0, on_timer, on_input, TIMERS;
and on_carrier, or, `over` a medium access, on_sent, if it has one), `fields` and `frames`. Of a
frame's fields the medium knows `to` (only that node is given it, ALL = every one), `rssi` (how loud
it came in, dBm) and `made_at` (when its content was handed in), each where it is declared.
"""

import functools
import importlib
from collections.abc import Callable, Mapping
from functools import cached_property
from types import ModuleType
from typing import Any, ClassVar

from innervate.dialect import arith, outbox, rng
from innervate.dialect.access import ALL
from innervate.dialect.outbox import URGENT
from innervate.folders import invariants_of
from innervate.kernel import compilation, tables
from innervate.network import Network, access_of, layouts_of, networks
from innervate.scenario.declared.field import sizes_of
from innervate.sim import came, clocks, heap, rows, taps
from innervate.sim.cables.declared import Unfit, frames_of
from innervate.sim.came import note_came
from innervate.sim.channel.build import grow_heap
from innervate.sim.counts import Counts
from innervate.sim.field import access, build, calls, listening, loop, medium, powers, timers
from innervate.sim.field import world as w
from innervate.sim.field.simulation import Field
from innervate.sim.field.states import DEAD, OFF
from innervate.sim.own import check_of, message_times, with_messages, words_of
from innervate.sim.recorded import Recorded
from innervate.sim.sent import WORDS, look_of, parts_of
from innervate.sim.status import POOL_FULL
from innervate.sim.tables import get

BELOW = (
    access.power_on, access.power_off, access.expire_below, access.dispatch_below, access.short,
    access.due, access.step,
)  # fmt: skip
KEPT = (
    listening.pressing, listening.offer, listening.sample, listening.tell_sent,
    listening.note_report, listening.record_sent,
)  # fmt: skip


def functions(network: Network) -> ModuleType:
    """What the loop calls (see `sim/field`)."""
    protocol, fields = network.protocol, network.fields
    names = {name for name, length, *_ in fields.FRAME if not length}
    frames = frames_of([one for one in fields.FRAME if one[0] != "rssi"])
    whole = frames_of(fields.FRAME)["copy_frame"]
    look = look_of(fields.FRAME, layouts_of(network))
    do = compilation.bound(
        f"{protocol.__name__} over a field",
        (whole, frames["digest"], frames["kind_of"], _frame_bytes(network.frames)),
        _entries(protocol, names, look), parts_of(look).values(), _mac(network),
        _noted(whole, frames["kind_of"], names),
        _checks(list(invariants_of(network, "node_").values())), BELOW, KEPT,
    )  # fmt: skip
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
) -> tuple[Callable[..., Any], ...]:
    """The protocol's functions with the world as their first argument."""
    start, frame_in = protocol.on_start, protocol.on_frame
    timer_due, given = protocol.on_timer, protocol.on_input

    def on_start(world, node, now, cause):  # type: ignore[no-untyped-def]
        start(world.stations[node], world.params[0], now, cause, world.out)
        look(world, node)

    def on_frame(world, node, now, frame):  # type: ignore[no-untyped-def]
        frame_in(world.stations[node], world.params[0], now, 0, frame, world.out)
        look(world, node)

    def on_own_frame(world, node, now, frame):  # type: ignore[no-untyped-def]
        if frame.to == node or frame.to == ALL:
            frame_in(world.stations[node], world.params[0], now, 0, frame, world.out)
            look(world, node)

    def on_timer(world, node, now, timer):  # type: ignore[no-untyped-def]
        timer_due(world.stations[node], world.params[0], now, timer, world.out)
        look(world, node)

    def on_input(world, node, now, kind):  # type: ignore[no-untyped-def]
        given(world.stations[node], world.params[0], now, kind, world.item[0], world.out)
        look(world, node)

    def tell_end(world, do, node, time, ok):  # type: ignore[no-untyped-def]
        pass

    def note_carriers(world, do, time):  # type: ignore[no-untyped-def]
        pass

    on_own_frame.__name__ = "on_frame"
    made = (on_start, on_own_frame if "to" in names else on_frame, on_timer, on_input)
    if hasattr(protocol, "on_sent"):
        return (*made, *_of_sent(protocol.on_sent, look), note_carriers)
    if not hasattr(protocol, "on_carrier"):
        return (*made, tell_end, note_carriers)
    carrier, tell_changes, tell_carrier = (
        protocol.on_carrier, listening.tell_changes, listening.tell_carrier,
    )  # fmt: skip

    def on_carrier(world, node, now, cd, voc):  # type: ignore[no-untyped-def]
        carrier(world.stations[node], world.params[0], now, cd, voc, world.out)
        look(world, node)

    def tell_own_end(world, do, node, time, ok):  # type: ignore[no-untyped-def]
        tell_carrier(world, do, node, time)

    def note_changes(world, do, time):  # type: ignore[no-untyped-def]
        tell_changes(world, do, time)

    tell_own_end.__name__, note_changes.__name__ = "tell_end", "note_carriers"
    return (*made, on_carrier, tell_own_end, note_changes)


def _of_sent(sent: Callable[..., Any], look: Callable[..., None]) -> tuple[Callable[..., Any], ...]:
    """A protocol above a medium access is told what became of its frames."""
    tell_gone = listening.tell_gone

    def on_sent(world, node, now, ok):  # type: ignore[no-untyped-def]
        sent(world.stations[node], world.params[0], now, ok, world.out)
        look(world, node)

    def tell_end(world, do, node, time, ok):  # type: ignore[no-untyped-def]
        tell_gone(world, do, node, time, ok)

    return on_sent, tell_end


def _mac(network: Network) -> tuple[Callable[..., Any], ...]:
    """The handlers of the medium access below; without one, what is never called."""
    entry = importlib.import_module(access_of(network).entry) if network.over else network.protocol
    start, frame_in, timer_due = entry.on_start, entry.on_frame, entry.on_timer
    given = entry.on_input
    carrier: Any = getattr(entry, "on_carrier", None)

    def mac_on_start(world, node, now, cause):  # type: ignore[no-untyped-def]
        start(world.macs[node], world.mac_params[0], now, cause, world.mac_out)

    def mac_on_frame(world, node, now, frame):  # type: ignore[no-untyped-def]
        frame_in(world.macs[node], world.mac_params[0], now, 0, frame, world.mac_out)

    def mac_on_timer(world, node, now, timer):  # type: ignore[no-untyped-def]
        timer_due(world.macs[node], world.mac_params[0], now, timer, world.mac_out)

    def mac_on_input(world, node, now, kind):  # type: ignore[no-untyped-def]
        params, item = world.mac_params[0], world.mac_item[0]
        given(world.macs[node], params, now, kind, item, world.mac_out)

    def mac_on_carrier(world, node, now, cd, voc):  # type: ignore[no-untyped-def]
        carrier(world.macs[node], world.mac_params[0], now, cd, voc, world.mac_out)

    def no_carrier(world, node, now, cd, voc):  # type: ignore[no-untyped-def]
        pass

    if network.over:
        return mac_on_start, mac_on_frame, mac_on_timer, mac_on_input, mac_on_carrier
    names = ("mac_on_start", "mac_on_frame", "mac_on_timer", "mac_on_input")
    no_carrier.__name__ = "mac_on_carrier"
    return (*map(_nothing, names), no_carrier)


def _nothing(name: str) -> Callable[..., None]:
    def nothing(world, node, now, one):  # type: ignore[no-untyped-def]
        pass

    nothing.__name__ = name
    return nothing


def _noted(copy: Any, kind_of: Any, names: set[str]) -> tuple[Callable[..., Any], ...]:
    """What is kept of frames and deliveries, and what nodes are handed."""

    def tap(world, place, at, time, out, why):  # type: ignore[no-untyped-def]
        listening.count_frame(world, place, out, why)
        if world.run[0].tap_limit > 0:
            copy(world.tapped[world.run[0].taps], world.frames[place])
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
            listening.lose_all(world, node, listening.BUSY)
        return mark

    def record_delivered(world, node, frame, time):  # type: ignore[no-untyped-def]
        listening.keep(world, node, kind_of(frame), time, -1)

    def record_timed(world, node, frame, time):  # type: ignore[no-untyped-def]
        since = frame.made_at
        latency = (time - since) & arith.MASK30 if since > 0 else -1
        listening.keep(world, node, kind_of(frame), time, latency)
        if since > 0:
            note_came(world.came, time - latency)

    def take_item(world, index):  # type: ignore[no-untyped-def]
        copy(world.item[0], world.items[index])

    def take_timed(world, index):  # type: ignore[no-untyped-def]
        copy(world.item[0], world.items[index])
        world.item[0].made_at = max(world.offers[index].time & arith.MASK30, 1)

    def note_heard(world, node, place):  # type: ignore[no-untyped-def]
        pass

    def note_loud(world, node, place):  # type: ignore[no-untyped-def]
        frame = world.frames[place]
        frame.rssi = medium.rssi_dbm(world, world.air[place].node, node)

    record_timed.__name__, take_timed.__name__ = "record_delivered", "take_item"
    note_loud.__name__ = "note_heard"
    timed = "made_at" in names
    return (
        tap, hand_down, record_timed if timed else record_delivered,
        take_timed if timed else take_item, note_loud if "rssi" in names else note_heard,
    )  # fmt: skip


def _checks(own: list[Callable[..., Any]]) -> tuple[Callable[..., Any], ...]:
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

    return check, wipe, check_own


@functools.cache
def compiled_loop(network: Network) -> Callable[..., None]:
    """The loop of a network over a field, compiled with its protocol."""
    do = functions(network)
    compilation.register(arith, outbox, rng, heap, clocks)
    compilation.register(medium, rows, taps, listening, came, hot=False)
    compilation.register_functions(powers.strength)
    modules = compilation.modules_of(network.protocol)
    if network.has("invariants"):
        modules += compilation.modules_of(network.invariants)
    if network.over:
        modules += compilation.modules_of(importlib.import_module(access_of(network).entry))
    compilation.register(*modules, hot=False)
    compilation.register(calls, loop, access, timers, hot=False)
    compilation.register_functions(*filter(callable, vars(do).values()), hot=False)
    return tables.Lending(compilation.compiled_as_one(loop.bind(do)))


class DeclaredField(Field):
    """Nodes in a field whose protocol is declared."""

    wide = w.WIDE
    tables: ClassVar[Mapping[str, tuple[str, ...]]] = {
        "rows": w.ROW, "deliveries": w.DELIVERY, "trail": w.TRAIL,
    }  # fmt: skip

    @cached_property
    def broken_words(self) -> dict[int, str]:  # type: ignore[override]
        """What is broken, by number."""
        return {**Field.broken_words, **WORDS, **words_of(self.plan.kind)}

    def grow(self, status: int) -> None:
        """Make room for more events."""
        if status == POOL_FULL:
            self.world = grow_heap(self.world)

    @cached_property
    def message_times(self) -> list[int]:
        """When users give what is to be delivered, us."""
        return message_times(self.plan)

    def counts(self) -> Counts:
        """Frames, one for each node that could hear it; what nodes were given and gave up."""
        numbers, radios = self.world.counters, self.world.radios
        lost = {name: int(numbers[place]) for name, place in listening.LOST.items()}
        count = self.plan.nodes
        found = Counts(
            nodes=count,
            off=tuple(node for node in range(count) if self._is_off(radios, node)),
            sent=int(numbers[listening.SENT]),
            arrived=int(numbers[listening.ARRIVED]),
            lost_by={name: many for name, many in lost.items() if many},
            delivered=int(numbers[listening.DELIVERED]),
            is_shared=True,
        )
        return with_messages(found, self.message_times, self.clock_us(), self.world.came)

    def _is_off(self, radios: Any, node: int) -> bool:
        """Switched off, or not there yet; not who is only about to start with the others."""
        state = int(get(radios, node, "state"))
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
    advance = loop.bind(functions(network)) if plain else compiled_loop(network)
    world = build.build(plan, network, plain, Recorded(**kept))
    return DeclaredField(plan, world, advance, "" if plain else plan.kind)
