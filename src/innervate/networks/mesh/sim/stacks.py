"""Binds a router and the medium access below it to the simulator."""

from __future__ import annotations

import importlib
from collections.abc import Callable
from types import ModuleType
from typing import Any, NamedTuple

from innervate.kernel.bits import mix
from innervate.networks.mesh.protocol import csma
from innervate.networks.mesh.protocol.constants import ACK
from innervate.networks.mesh.protocol.frames import copy_frame, frame_bytes


class Stack(NamedTuple):
    """The functions of router and medium access with the simulator's world first.

    Attributes:
        start: the router's on_start, and so on: hear, fire, give.
        mac_start: the medium access's on_start, and so on.
        digest: a frame in one word.
        copy_frame: to a place on the air; tests may send it through bytes on the way.
        frame_bytes: its length on the wire.
        is_sound: True if every word of a node's record is in its range.
    """

    start: Callable[..., None]
    hear: Callable[..., None]
    fire: Callable[..., None]
    give: Callable[..., None]
    mac_start: Callable[..., None]
    mac_hear: Callable[..., None]
    mac_fire: Callable[..., None]
    mac_give: Callable[..., None]
    mac_carrier: Callable[..., None]
    digest: Callable[..., int]
    copy_frame: Callable[..., None]
    frame_bytes: Callable[..., int]
    is_sound: Callable[..., bool]


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


def is_sound(world, node):
    """True if every word of a node's record is in its range."""
    words, low, high = world.words[node], world.low, world.high
    wrong = 0
    for i in range(len(low)):
        wrong += (words[i] < low[i]) | (words[i] > high[i])
    return wrong == 0


def bind(entry: ModuleType, sound: Callable[..., bool] = is_sound) -> Stack:
    """The stack of a router, over CSMA."""
    on_start, on_frame, on_timer, on_input = (
        *(entry.on_start, entry.on_frame),
        *(entry.on_timer, entry.on_input),
    )
    mac_on_start, mac_on_frame, mac_on_timer = csma.on_start, csma.on_frame, csma.on_timer
    mac_on_input, mac_on_carrier = csma.on_input, csma.on_carrier

    def start(world, node, now, cause):
        gate = world.gates[world.radios[node].gate]
        on_start(world.nodes[node], gate, world.params[0], now, cause, world.out)

    def hear(world, node, now, frame):
        gate = world.gates[world.radios[node].gate]
        on_frame(world.nodes[node], gate, world.params[0], now, 0, frame, world.out)

    def fire(world, node, now, timer):
        gate = world.gates[world.radios[node].gate]
        on_timer(world.nodes[node], gate, world.params[0], now, timer, world.out)

    def give(world, node, now, kind):
        gate, item = world.gates[world.radios[node].gate], world.item[0]
        on_input(world.nodes[node], gate, world.params[0], now, kind, item, world.out)

    def mac_start(world, node, now, cause):
        mac_on_start(world.macs[node], world.mac_params[0], now, cause, world.mac_out)

    def mac_hear(world, node, now, frame):
        mac_on_frame(world.macs[node], world.mac_params[0], now, 0, frame, world.mac_out)

    def mac_fire(world, node, now, timer):
        mac_on_timer(world.macs[node], world.mac_params[0], now, timer, world.mac_out)

    def mac_give(world, node, now, kind):
        params, item = world.mac_params[0], world.mac_item[0]
        mac_on_input(world.macs[node], params, now, kind, item, world.mac_out)

    def mac_carrier(world, node, now, cd, voc):
        mac_on_carrier(world.macs[node], world.mac_params[0], now, cd, voc, world.mac_out)

    return Stack(
        *(start, hear, fire, give, mac_start, mac_hear, mac_fire, mac_give, mac_carrier),
        *(digest, copy_frame, frame_bytes, sound),
    )


def plain_stack(entry: ModuleType, fields: Any, through: Callable[[Any], Any] | None) -> Stack:
    """The same on plain objects; every frame sent is passed `through` a function if given."""
    scalars = [(name, low, high) for name, length, low, high, *_ in fields if not length]
    arrays = [(name, low, high) for name, length, low, high, *_ in fields if length]

    def sound(world: Any, node: int) -> bool:
        state = world.nodes[node]
        return all(low <= getattr(state, name) <= high for name, low, high in scalars) and all(
            low <= min(getattr(state, name)) and max(getattr(state, name)) <= high
            for name, low, high in arrays
        )

    stack = bind(entry, sound)
    if through is None:
        return stack
    return stack._replace(copy_frame=lambda to, frame: copy_frame(to, through(frame)))
