"""Runs a plan: builds the world, drives the loop in slices, collects its tables."""

from __future__ import annotations

import functools
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from types import ModuleType
from typing import Any

import numpy as np

from innervate.sim import build as builder
from innervate.sim import loop, skin_stack, static_stack
from innervate.sim import world as w
from innervate.sim.wheel import FRESH, LAST

RULE_STATIC = 3
SLICE_EVENTS = 1_000_000

Progress = Callable[[int, int], None]


class InvariantBroken(Exception):
    """A checker found something that must not happen; says what, where, when and which seed."""


@dataclass(slots=True)
class Result:
    """What a simulation leaves: the world at its end and all rows.

    Rows are structured arrays (compiled) or lists of objects (plain).
    """

    plan: Any
    world: w.World
    rows: Any
    deliveries: Any
    trail: Any
    ended_us: int
    wall_s: float
    fingerprint: int
    handled: int
    arrived: int
    interrupted: bool = False


def _modules() -> list[ModuleType]:
    from innervate.protocol import arith, outbox, skin, skin_sink, skin_static
    from innervate.protocol import rng as generator
    from innervate.sim import checks, clocks, commands, observer, touch, wheel, wires

    return [
        arith, outbox, generator, skin, skin_sink, skin_static,
        wheel, clocks, touch, wires, observer, checks, commands, skin_stack, static_stack,
    ]  # fmt: skip


@functools.cache
def compiled_loop(static: bool) -> Callable[..., None]:
    """The compiled loop of the skin, or of its static baseline."""
    from innervate.kernel import door, tables

    door.register(*_modules())
    parts = loop.build(static_stack if static else skin_stack)
    door.register_functions(*parts[:-1])
    advance = door.compiled(parts[-1])
    return lambda world, until, budget: advance(tables.borrowed(world), until, budget)


def plain_loop(static: bool) -> Callable[..., None]:
    """The same loop, uncompiled."""
    return loop.build(static_stack if static else skin_stack)[-1]
