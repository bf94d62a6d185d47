"""Binds the protocols of a shared channel to the simulator, by name."""

from __future__ import annotations

from collections.abc import Callable
from types import ModuleType
from typing import Any, NamedTuple

from innervate.protocol import (
    radio_bounds,
    radio_fields,
    radio_follow,
    radio_idle,
    radio_modes,
    radio_paper,
    radio_paper_idle,
    radio_paper_reserve,
    radio_paper_turns,
    radio_paper_verify,
    radio_practical,
    radio_reporter,
    radio_station,
    radio_times,
    radio_turn,
    radio_window,
)
from innervate.protocol.radio_station import copy_frame
from innervate.scenario.radio_baselines import NUMBERS
from innervate.sim.baselines import common, contend, passing, slots, station, tree
from innervate.sim.baselines.fields import BASELINE


class Stack(NamedTuple):
    """A protocol's five functions with the simulator's world as their first argument."""

    start: Callable[..., None]
    hear: Callable[..., None]
    fire: Callable[..., None]
    give: Callable[..., None]
    carrier: Callable[..., None]
    digest: Callable[..., int]
    copy_frame: Callable[..., None]


class Protocol(NamedTuple):
    """What the simulator needs of a medium access protocol.

    Attributes:
        entry: the module with the five functions.
        modules: all it consists of, callees first.
        fields: declaration of a station's own state.
    """

    entry: ModuleType
    modules: tuple[ModuleType, ...]
    fields: Any


# One stack for all baselines; a parameter says which.
BASELINES = Protocol(
    station, (radio_station, common, contend, slots, tree, passing, station), BASELINE
)

PROTOCOLS: dict[str, Protocol] = {
    "csma-cd-r/practical": Protocol(
        radio_practical,
        (
            radio_station, radio_times, radio_bounds, radio_modes, radio_idle,
            radio_turn, radio_reporter, radio_window, radio_follow, radio_practical,
        ),
        radio_fields.PRACTICAL,
    ),
    "csma-cd-r/paper": Protocol(
        radio_paper,
        (
            radio_station, radio_paper_idle, radio_paper_turns, radio_paper_reserve,
            radio_paper_verify, radio_paper,
        ),
        radio_fields.PAPER,
    ),
    **dict.fromkeys(NUMBERS, BASELINES),
}  # fmt: skip


def digest(frame):
    """A frame in one word, for the fingerprint."""
    word = frame.kind | (frame.slots << 4) | (frame.source << 16) | (frame.handle << 26)
    word ^= (frame.pos << 42) | (frame.next << 49) | (frame.more << 56) | (frame.ok << 57)
    word ^= (frame.good[0] << 5) ^ (frame.good[1] << 21) ^ (frame.bad[0] << 13)
    return (
        word ^ (frame.bad[1] << 29) ^ (frame.window << 44) ^ (frame.span << 50) ^ (frame.wide << 60)
    )


def bind(entry: ModuleType) -> Stack:
    """The stack of a protocol."""
    on_start, on_frame, on_timer = entry.on_start, entry.on_frame, entry.on_timer
    on_input, on_carrier = entry.on_input, entry.on_carrier

    def start(world, node, now, cause):
        on_start(world.stations[node], world.params[0], now, cause, world.out)

    def hear(world, node, now, frame):
        on_frame(world.stations[node], world.params[0], now, 0, frame, world.out)

    def fire(world, node, now, timer):
        on_timer(world.stations[node], world.params[0], now, timer, world.out)

    def give(world, node, now, kind):
        on_input(world.stations[node], world.params[0], now, kind, world.item[0], world.out)

    def carrier(world, node, now, cd, voc):
        on_carrier(world.stations[node], world.params[0], now, cd, voc, world.out)

    return Stack(start, hear, fire, give, carrier, digest, copy_frame)
