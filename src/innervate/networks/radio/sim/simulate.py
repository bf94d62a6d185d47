"""Runs a radio plan: builds the world, drives the loop in slices, collects its tables."""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from innervate.kernel import door, tables
from innervate.kernel.stop import Stop
from innervate.kernel.wall import wall_s
from innervate.networks.radio.sim import recorder as books
from innervate.networks.radio.sim import stacks
from innervate.networks.skin.sim.simulate import InvariantBroken
from innervate.sim import heap, rows, taps
from innervate.sim.channel import build as builder
from innervate.sim.channel import loop, medium, traffic
from innervate.sim.channel import world as w
from innervate.sim.status import BROKEN, BUDGET, DONE, POOL_FULL
from innervate.sim.tables import get, hand_over, move_rows

SLICE_EVENTS = 1_000_000

Progress = Callable[[int, int], None]

NAMES = {"rows": w.ROW, "sent": w.SENT, "packets": w.PACKET, "trail": w.TRAIL}


@dataclass(slots=True)
class RadioResult:
    """What a radio simulation leaves.

    `rows` are what stations reported, `sent` all transmissions, `packets` all packets that their
    sender takes for delivered, `trail` all handler calls: structured arrays with the fields of
    `world.ROW`, `world.SENT`, `world.PACKET` and `world.TRAIL`, times in us.
    `counts` holds the numbers of the run by name.
    """

    plan: Any
    world: w.World
    rows: Any
    sent: Any
    packets: Any
    trail: Any
    counts: dict[str, int]
    ended_us: int
    wall_s: float
    fingerprint: str
    interrupted: bool


COUNTS = ("handled", "decoded", "garbled", "offers", "dropped", "completed", "silent", "partial",
          "again")  # fmt: skip


def compiled_loop(name: str) -> Callable[..., None]:
    """The compiled loop of a protocol by name."""
    return _compiled(stacks.PROTOCOLS[name])


@functools.cache
def _compiled(protocol: stacks.Protocol) -> Callable[..., None]:
    """Its loop; all names of one protocol share it."""
    parts = registered(protocol, traffic)
    door.register_functions(*parts[:-1], hot=False)
    advance = door.compiled(parts[-1])
    return lambda world, until, budget: advance(tables.borrowed(world), until, budget)


def registered(protocol: stacks.Protocol, packets: Any) -> loop.Handlers:
    """A protocol's loop, plain; what its parts call may be compiled."""
    from innervate.dialect import arith, outbox, rng

    door.register(traffic, rows, taps, hot=False)
    door.register(arith, outbox, rng, heap, medium)
    door.register(*protocol.modules, hot=False)
    door.register(books, hot=False)
    door.register_functions(loop.pressing, hot=False)
    stack = stacks.bind(protocol.entry)
    door.register_functions(*stack)
    return loop.build(stack, packets)


def simulate(
    plan: Any,
    *,
    plain: bool = False,
    checks: bool = True,
    keep: bool = True,
    trail: bool = False,
    progress: Progress | None = None,
    tap: taps.Tap | None = None,
) -> RadioResult:
    """Run a radio plan to its end; an interrupt (Ctrl-C) ends it early and keeps what was done.

    `plain` runs the same loop uncompiled; without `keep` only the counts are kept.
    `tap` is handed copies of all frames as they leave and come in (see sim/taps.py).
    Raises InvariantBroken.
    """
    if plain:
        advance = loop.build(stacks.bind(stacks.PROTOCOLS[plan.protocol].entry))[-1]
    else:
        advance = compiled_loop(plan.protocol)
    world = builder.build(plan, plain, checks, keep, trail, tap is not None)
    advance(world, 0, 1)
    if not plain:
        for name, protocol in stacks.PROTOCOLS.items():
            if protocol == stacks.PROTOCOLS[plan.protocol]:
                door.mark_compiled(name.replace("/", "-"))
    parts: dict[str, list[Any]] = {name: [] for name in NAMES}
    started = wall_s()
    with Stop() as stop:
        status = BUDGET
        while status != DONE and not stop.asked:
            advance(world, plan.duration_us, SLICE_EVENTS)
            status = int(get(world.run, 0, "status"))
            if status == BROKEN:
                raise InvariantBroken(story(plan, world))
            if status == POOL_FULL:
                world = builder.grow_heap(world)
            move_rows(world, parts, NAMES, w.WIDE)
            hand_over(world, tap, int(get(world.run, 0, "now")))
            if progress is not None:
                progress(int(get(world.run, 0, "now")), plan.duration_us)
    done = int(get(world.run, 0, "completed")) >= plan.wanted > 0
    ended = int(get(world.run, 0, "now")) if done or stop.asked else plan.duration_us
    found = {name: np.concatenate(kept) for name, kept in parts.items()}
    return RadioResult(
        plan=plan,
        world=world,
        counts={name: int(get(world.run, 0, name)) for name in COUNTS},
        ended_us=ended,
        wall_s=wall_s() - started,
        fingerprint=f"{int(get(world.run, 0, 'fingerprint')) & (1 << 64) - 1:016x}",
        interrupted=status != DONE,
        **found,
    )


def story(plan: Any, world: w.World) -> str:
    """A broken invariant in one line."""
    node = int(get(world.run, 0, "broken_node"))
    at = max(int(get(world.run, 0, "broken_at")), 0) / 1e6
    what = {
        medium.BROKEN_DEAF: f"station {node} sent while its radio could not",
        medium.BROKEN_AIR: f"station {node} has too many transmissions under way",
        loop.BROKEN_OUTBOX: f"outbox of station {node} overflowed",
        books.BROKEN_TURNS: f"station {node} began a turn while another station had its own",
        books.BROKEN_RANGE: f"a value of station {node} is out of its declared range",
    }[int(get(world.run, 0, "broken"))]
    return f"invariant broken at {at:.6f} s (seed {plan.seed}): {what}"
