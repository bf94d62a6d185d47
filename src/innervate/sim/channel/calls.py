"""A protocol's functions as the loop of a channel calls them: with the world first."""

from collections.abc import Callable
from types import ModuleType
from typing import Any


def handlers(entry: ModuleType) -> tuple[Callable[..., Any], ...]:
    """`on_start`, `on_frame`, `on_timer`, `on_input`, `on_carrier` of `entry`, over stations."""
    start, frame_in, timer_due = entry.on_start, entry.on_frame, entry.on_timer
    given, carrier = entry.on_input, entry.on_carrier

    def on_start(world, node, now, cause):  # type: ignore[no-untyped-def]
        start(world.stations[node], world.params[0], now, cause, world.out)

    def on_frame(world, node, now, frame):  # type: ignore[no-untyped-def]
        frame_in(world.stations[node], world.params[0], now, 0, frame, world.out)

    def on_timer(world, node, now, timer):  # type: ignore[no-untyped-def]
        timer_due(world.stations[node], world.params[0], now, timer, world.out)

    def on_input(world, node, now, kind):  # type: ignore[no-untyped-def]
        given(world.stations[node], world.params[0], now, kind, world.item[0], world.out)

    def on_carrier(world, node, now, cd, voc):  # type: ignore[no-untyped-def]
        carrier(world.stations[node], world.params[0], now, cd, voc, world.out)

    return on_start, on_frame, on_timer, on_input, on_carrier
