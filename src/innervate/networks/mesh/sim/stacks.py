"""Binds a router and the medium access below it to the simulator."""

import importlib
from collections.abc import Callable
from types import ModuleType
from typing import Any, NamedTuple

from innervate.kernel import compilation
from innervate.kernel.bits import mix
from innervate.networks.mesh.protocol import csma
from innervate.networks.mesh.protocol.constants import ACK
from innervate.networks.mesh.protocol.frames import copy_frame, frame_bytes
from innervate.networks.mesh.sim import orders, recorder

# What the loop asks of the layer below.
BELOW = (
    "hand_down", "power_on", "power_off", "expire_below", "dispatch_below", "short", "due", "step",
)  # fmt: skip


# What it asks of the mesh, besides its handlers.
ORDERS = (
    orders.pressing, orders.wipe, orders.offer, orders.sample, orders.tell_sent, orders.note_heard,
    orders.note_report, orders.note_carriers, orders.check,
    recorder.record_sent, recorder.record_delivered, recorder.tap,
)  # fmt: skip


class Layer(NamedTuple):
    """What lies below the router.

    Attributes:
        part: `sim.field.access` or `over_channel`.
        channel: what the channel of the latter calls; None = there is none.
    """

    part: ModuleType
    channel: ModuleType | None = None


def mesh() -> ModuleType:
    """The module with the five functions of the mesh's router."""
    return importlib.import_module("innervate.networks.mesh.protocol.node")


def digest(frame):
    """What a frame has on the wire in one word, for the fingerprint."""
    mark = mix(
        frame.kind | frame.link_src << 6 | frame.link_dst << 14, frame.origin | frame.seq << 8
    )
    if frame.kind == ACK:
        return mix(mark, frame.rssi)
    mark = mix(mark, frame.flags | frame.dest << 8 | frame.table_ver << 16 | frame.ttl << 24)
    mark = mix(mark, frame.path_len | frame.length << 8)
    for i in range(frame.path_len):
        mark = mix(mark, frame.path[i])
    for i in range(frame.length):
        mark = mix(mark, frame.body[i])
    return mark


def bind(entry: ModuleType, layer: Layer) -> ModuleType:
    """What a mesh's loop calls, of a router and what lies below it.

    The handlers of both, `mac_` before those of the medium access, with the world first; of frames
    `digest`, `copy_frame`, `frame_bytes`; and of the layer below what the loop asks of it (BELOW).
    """
    below = (getattr(layer.part, name) for name in BELOW)
    made = compilation.bound(
        f"{entry.on_start.__module__} {layer.part.__name__}",
        _router(entry), _csma(), (digest, copy_frame, frame_bytes), ORDERS, below,
    )  # fmt: skip
    vars(made)["channel"] = layer.channel
    return made


def _router(entry: ModuleType) -> tuple[Callable[..., Any], ...]:
    """A router's functions with the world as their first argument."""
    start, frame_in, timer_due = entry.on_start, entry.on_frame, entry.on_timer
    given = entry.on_input

    def on_start(world, node, now, cause):  # type: ignore[no-untyped-def]
        gate = world.gates[world.radios[node].gate]
        start(world.nodes[node], gate, world.params[0], now, cause, world.out)

    def on_frame(world, node, now, frame):  # type: ignore[no-untyped-def]
        gate = world.gates[world.radios[node].gate]
        frame_in(world.nodes[node], gate, world.params[0], now, 0, frame, world.out)

    def on_timer(world, node, now, timer):  # type: ignore[no-untyped-def]
        gate = world.gates[world.radios[node].gate]
        timer_due(world.nodes[node], gate, world.params[0], now, timer, world.out)

    def on_input(world, node, now, kind):  # type: ignore[no-untyped-def]
        gate, item = world.gates[world.radios[node].gate], world.item[0]
        given(world.nodes[node], gate, world.params[0], now, kind, item, world.out)

    return on_start, on_frame, on_timer, on_input


def _csma() -> tuple[Callable[..., Any], ...]:
    """The handlers of CSMA, over the world's tables of radios."""
    start, frame_in, timer_due = csma.on_start, csma.on_frame, csma.on_timer
    given, carrier = csma.on_input, csma.on_carrier

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

    return mac_on_start, mac_on_frame, mac_on_timer, mac_on_input, mac_on_carrier


def plain(entry: ModuleType, layer: Layer, through: Callable[[Any], Any] | None) -> ModuleType:
    """The same on plain objects; every frame sent is passed `through` a function if given."""
    made = bind(entry, layer)
    if through is not None:
        vars(made)["copy_frame"] = lambda to, frame: copy_frame(to, through(frame))
    return made
