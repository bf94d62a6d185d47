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
from innervate.sim.field import motion
from innervate.sim.handlers import Given, access_handlers, handlers

ROUTER = Given("world.nodes[node], world.gates[world.radios[node].gate], world.params[0]")

# What the loop asks of the layer below.
BELOW = (
    "hand_down", "power_on", "power_off", "expire_below", "dispatch_below", "short", "due", "step",
)  # fmt: skip


# What it asks of the mesh, besides its handlers.
ORDERS = (
    orders.pressing, orders.wipe, orders.offer, motion.sample, orders.tell_place, orders.tell_sent,
    orders.note_heard, orders.note_report, orders.note_carriers, orders.check,
    recorder.record_sent, recorder.record_delivered, recorder.tap,
)  # fmt: skip


class Layer(NamedTuple):
    """What lies below the router."""

    part: ModuleType  # `sim.field.access` or `over_channel`
    channel: ModuleType | None = None  # what the channel of the latter calls; None = there is none


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
        handlers(entry, ROUTER).values(), access_handlers(csma).values(),
        (digest, copy_frame, frame_bytes), ORDERS, below,
    )  # fmt: skip
    vars(made)["channel"] = layer.channel
    return made


def plain(entry: ModuleType, layer: Layer, through: Callable[[Any], Any] | None) -> ModuleType:
    """The same on plain objects; every frame sent is passed `through` a function if given."""
    made = bind(entry, layer)
    if through is not None:
        vars(made)["copy_frame"] = lambda to, frame: copy_frame(to, through(frame))
    return made
