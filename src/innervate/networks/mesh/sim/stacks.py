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
        on_start: the router's, and so on.
        mac_on_start: the medium access's, and so on.
        digest: a frame in one word.
        copy_frame: to a place on the air; tests may send it through bytes on the way.
        frame_bytes: its length on the wire.
        is_sound: True if every word of a node's record is in its range.
    """

    on_start: Callable[..., None]
    on_frame: Callable[..., None]
    on_timer: Callable[..., None]
    on_input: Callable[..., None]
    mac_on_start: Callable[..., None]
    mac_on_frame: Callable[..., None]
    mac_on_timer: Callable[..., None]
    mac_on_input: Callable[..., None]
    mac_on_carrier: Callable[..., None]
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
    parts: tuple[Any, ...] = (*_router(entry), *_csma(), digest, copy_frame, frame_bytes, sound)
    return Stack._make(parts)


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
