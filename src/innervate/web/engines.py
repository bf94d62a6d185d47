"""The three simulations behind one interface: how each is driven, and how a fault is put in."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, ClassVar

import numpy as np

from innervate.scenario.orders import Order
from innervate.scenario.radio_plan import KILL, LEAVE
from innervate.sim import build as skin_build
from innervate.sim import loop as skin_loop
from innervate.sim import simulate as skin
from innervate.sim import wheel
from innervate.sim.build import get, put
from innervate.sim.mesh import build as mesh_build
from innervate.sim.mesh import channel, stacks
from innervate.sim.mesh import loop as mesh_loop
from innervate.sim.mesh import queue as mesh_queue
from innervate.sim.mesh import simulate as mesh
from innervate.sim.radio import build as radio_build
from innervate.sim.radio import heap
from innervate.sim.radio import simulate as radio
from innervate.web.engine import Engine, Mark
from innervate.web.errors import WatchError
from innervate.web.touching import Finger

CELLS_MAX = 20_000
ORDERS_CELLS_MAX = 2_000  # of a skin without data or commands of its own: they need room to wait

Loop = Callable[[Any, int, int], None]


def engine_of(plan: Any) -> Engine:
    """The engine of a plan.

    Raises:
        WatchError: it has no clock to be watched by, or is too large.
    """
    source = plan.scenario.path or plan.scenario.name
    if plan.kind == "skin" and plan.graph.cells > CELLS_MAX:
        what = f"{plan.graph.cells:,} cells are too many to be drawn"
        raise WatchError(f"{source}: {what}; at most {CELLS_MAX:,}")
    if plan.kind == "skin" and plan.script:
        why = "its [script] replaces the clock"
        raise WatchError(f"{source}: {why}; use: innervate run")
    if plan.kind == "radio" and plan.scenario.model.channel.level == "slotted":
        why = 'the slotted level has no stations to watch; set channel.level = "event"'
        raise WatchError(f"{source}: {why}")
    if plan.kind == "skin":
        return SkinEngine(plan)
    return RadioEngine(plan) if plan.kind == "radio" else MeshEngine(plan)


class SkinEngine(Engine):
    """A skin."""

    tables: ClassVar[tuple[str, ...]] = ("rows", "deliveries")
    finger: Finger | None = None  # once a hand has touched the skin

    def __init__(self, plan: Any) -> None:
        self.orders: list[Order] = []  # given by hand
        super().__init__(plan)

    @property
    def takes_orders(self) -> bool:
        """Is there room for commands of the PC?"""
        known = bool(self.plan.orders) or self.plan.data_period_us > 0
        return known or self.plan.graph.cells <= ORDERS_CELLS_MAX

    def give(self, order: Order) -> None:
        """Have the PC send a command, not before `earliest_us`."""
        self.orders.append(order)
        self._schedule_row(skin_build.order_row(order))

    def touch(self, cell: int | None) -> None:
        """Touch a cell from now on, or none."""
        if self.finger is None:
            self.finger = Finger(self.plan)
        self.finger.move(self.earliest_us, cell)
        self.world = self.finger.into(self.world)

    def back_to(self, mark: Mark) -> None:
        """Go back to a moment that was remembered; what was touched later is touched again."""
        super().back_to(mark)
        for order in self.orders:
            if order.at_us >= self.now_us:
                self._schedule_row(skin_build.order_row(order))
        if self.finger is not None:
            self.world = self.finger.into(self.world)

    def next_us(self) -> int | None:
        """When something happens next."""
        world = self.world
        events = world.wheel.events[: int(world.wheel.pool[wheel.FRESH])]
        times = events["time"][events["bucket"] != wheel.NIL]
        found = [int(times.min())] if len(times) else []
        place = int(get(world.run, 0, "next_command"))
        if place < int(get(world.run, 0, "commands")):
            found.append(int(world.commands["at"][place]))
        return min(found, default=None)

    def _name(self) -> str:
        return skin.loop_name(self.plan)

    def _loop(self) -> Loop:
        return skin.compiled_loop(self.plan.params["rule"] == skin.RULE_STATIC)

    def _build(self) -> Any:
        kept = self.plan.data_period_us > 0
        return skin_build.build(self.plan, deliveries=kept, orders=self.takes_orders)

    def _clock(self) -> int:
        return int(self.world.wheel.clock[wheel.NOW])

    def _grow(self, status: int) -> None:
        if status == skin_loop.POOL_FULL:
            self.world = skin_build.grow_pool(self.world)

    def _story(self) -> str:
        return skin.story(self.plan, self.world)

    def _schedule(self, fault: Any) -> None:
        self._schedule_row(skin_build.fault_row(fault))

    def _schedule_row(self, row: tuple[int, ...]) -> None:
        self.world, _ = with_command(self.world, "at", row)


class RadioEngine(Engine):
    """A radio team."""

    tables: ClassVar[tuple[str, ...]] = ("rows", "sent", "packets")

    def is_complete(self) -> bool:
        """A team that had so many packets to deliver ends with the last of them."""
        wanted = int(get(self.world.run, 0, "wanted"))
        return int(get(self.world.run, 0, "completed")) >= wanted > 0

    def next_us(self) -> int | None:
        """When something happens next."""
        if self.world.told[0]:
            return self._clock()
        return first_of(self.world.heap)

    def _name(self) -> str:
        return str(self.plan.protocol).replace("/", "-")

    def _loop(self) -> Loop:
        return radio.compiled_loop(self.plan.protocol)

    def _build(self) -> Any:
        return radio_build.build(self.plan, plain=False, checks=True, keep=True, trail=False)

    def _clock(self) -> int:
        return int(get(self.world.run, 0, "now"))

    def _grow(self, status: int) -> None:
        if status == skin_loop.POOL_FULL:
            self.world = radio_build.grow_heap(self.world)

    def _story(self) -> str:
        return radio.story(self.plan, self.world)

    def _schedule(self, fault: Any) -> None:
        place = len(self.world.commands)
        longer = np.zeros(place + 1, self.world.commands.dtype)
        longer[:place] = self.world.commands
        self.world = self.world._replace(commands=longer)
        put(self.world.commands, place, action=fault.action, node=fault.node, value=fault.value)
        put(self.world.commands, place, index=fault.index)
        heap.push(self.world.heap, heap.key_of(fault.at_us, heap.COMMAND, 0, place))
        # As a plan with such events has it: turns may overlap, and who is gone delivers no more.
        put(self.world.run, 0, exclusive=0)
        if fault.action in (KILL, LEAVE):
            put(self.world.run, 0, wanted=0)


class MeshEngine(Engine):
    """A mesh."""

    tables: ClassVar[tuple[str, ...]] = ("rows", "sent", "delivered", "rounds")

    def next_us(self) -> int | None:
        """When something happens next."""
        times = [first_of(self.world.heap)]
        if self.world.below:
            told = bool(self.world.below.told[0])
            times.append(self._clock() if told else first_of(self.world.below.heap))
        return min((time for time in times if time is not None), default=None)

    def _name(self) -> str:
        return mesh.loop_name(self.plan)

    def _loop(self) -> Loop:
        return mesh.compiled_loop(stacks.mesh(), self.plan.mac)

    def _build(self) -> Any:
        return mesh_build.build(self.plan, plain=False, checks=True, keep=True, trail=False)

    def _clock(self) -> int:
        return int(get(self.world.run, 0, "now"))

    def _grow(self, status: int) -> None:
        if status == skin_loop.POOL_FULL:
            self.world = channel.grown(self.world)
        if status == mesh_loop.SEEN_FULL:
            self.world = mesh_build.grow_seen(self.world)

    def _story(self) -> str:
        return mesh.story(self.plan, self.world)

    def _schedule(self, fault: Any) -> None:
        """The queue holds the key of the next command alone."""
        row = (fault.at_us, fault.action, fault.node, fault.other, fault.value)
        self.world, is_next = with_command(self.world, "time", row)
        if is_next:
            keys, size = self.world.heap
            rank = (keys[: size[0]] >> mesh_queue.RANK_SHIFT) & 7
            others = np.sort(keys[: size[0]][rank != mesh_queue.COMMAND])
            keys[: len(others)] = others  # in order, hence a heap
            size[0] = len(others)
            key = mesh_queue.key_of(fault.at_us, mesh_queue.COMMAND, 0, 0)
            mesh_queue.push(self.world.heap, key)


def with_command(world: Any, time: str, row: tuple[int, ...]) -> tuple[Any, bool]:
    """The world with one more command, behind those of its moment; is it the next one?

    `time` names the column by which the table is in order.
    """
    count, first = (int(get(world.run, 0, name)) for name in ("commands", "next_command"))
    before = world.commands[:count]
    place = first + int(np.searchsorted(before[time][first:], row[0], "right"))
    longer = np.zeros(count + 1, before.dtype)
    longer[:place], longer[place + 1 :] = before[:place], before[place:]
    longer[place] = row
    put(world.run, 0, commands=count + 1)
    return world._replace(commands=longer), place == first


def first_of(queue: Any) -> int | None:
    """Time of the first event in a heap; None = it is empty."""
    return int(queue.keys[0]) >> heap.TIME_SHIFT if queue.size[0] else None
