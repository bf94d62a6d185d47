"""A simulation that can be held at any microsecond, changed there, and gone on with."""

from __future__ import annotations

from abc import ABC, abstractmethod
from bisect import bisect_left, insort
from collections.abc import Callable
from typing import Any, ClassVar, NamedTuple

import numpy as np

from innervate.kernel import door
from innervate.networks.skin.sim.simulate import InvariantBroken
from innervate.sim.status import BROKEN, DONE
from innervate.sim.tables import get, put

Rows = dict[str, Any]


class Mark(NamedTuple):
    """A simulation as it was at some moment, to go back to; `bytes` is what it takes."""

    now_us: int
    world: Any
    bytes: int


class Engine(ABC):
    """A plan's network while it runs, compiled.

    The loop that it drives is the one of `innervate run`, cut into slices: same plan, same network.

    Attributes:
        plan: what runs.
        world: its tables.
        now_us: everything before this time has happened, and nothing at it or after it.
        given: faults added to those of the plan, in the order in which they were given.
    """

    # Tables of rows that the loop fills.
    tables: ClassVar[tuple[str, ...]]

    def __init__(self, plan: Any) -> None:
        self.plan = plan
        self.now_us = 0
        self.given: list[Any] = []
        self._times: list[int] = sorted(fault.at_us for fault in plan.faults)
        self._advance = self._loop()
        self.world = self._build()
        self._fresh: dict[str, list[Any]] = {name: [] for name in self.tables}

    def prepare(self) -> None:
        """Compile the loop, or load what was compiled; nothing happens yet."""
        self._advance(self.world, 0, 1)
        door.mark_compiled(self._name())

    def advance(self, until_us: int, budget: int) -> None:
        """Go on to `until_us`, or, after about `budget` events, to some whole microsecond before.

        Raises:
            InvariantBroken: a checker found what must not happen.
        """
        if until_us <= self.now_us or self.is_complete():
            return
        if self._slice(until_us, budget) != DONE:
            until_us = min(until_us, max(self._clock(), self.now_us) + 1)
            while self._slice(until_us, budget) != DONE:
                pass
        self.now_us = self._clock() + 1 if self.is_complete() else until_us

    def take(self) -> Rows:
        """The rows that were made since the last call, by table."""
        found = {}
        for name, parts in self._fresh.items():
            table = getattr(self.world, name)
            found[name] = np.concatenate(parts) if parts else table[:0].copy()
            parts.clear()
        return found

    def mark(self) -> Mark:
        """Remember this moment."""
        world, size = twin(self.world, self.tables)
        return Mark(self.now_us, world, size)

    def back_to(self, mark: Mark) -> None:
        """Go back to a moment that was remembered; what was given for later happens again."""
        self.world = twin(mark.world, self.tables)[0]
        self.now_us = mark.now_us
        self.take()
        for fault in self.given:
            if fault.at_us >= self.now_us:
                self._schedule(fault)

    def add(self, fault: Any) -> None:
        """Something is to be done to the network, not before `earliest_us`."""
        self.given.append(fault)
        insort(self._times, fault.at_us)
        self._schedule(fault)

    @property
    def next_index(self) -> int:
        """The index of the next fault to be added: behind the scenario's events."""
        return len(self.plan.scenario.model.event) + len(self.given)

    @property
    def edge_us(self) -> int:
        """Just before the next fault, or just behind those of this moment."""
        at = bisect_left(self._times, self.now_us)
        if at == len(self._times):
            return int(self.plan.duration_us)
        return max(int(self._times[at]), self.now_us + 1)

    @property
    def earliest_us(self) -> int:
        """When something can be done at the earliest: the network begins at 0, by itself."""
        return max(self.now_us, 1)

    def is_complete(self) -> bool:
        """True if it ended before its time because there was no more to do."""
        return False

    @property
    def fingerprint(self) -> str:
        """Of everything that has happened, as in a run's summary."""
        return f"{int(get(self.world.run, 0, 'fingerprint')) & (1 << 64) - 1:016x}"

    @abstractmethod
    def next_us(self) -> int | None:
        """When something happens next; None = never."""

    @abstractmethod
    def _name(self) -> str:
        """What the loop is called in the cache of compiled code."""

    @abstractmethod
    def _loop(self) -> Callable[[Any, int, int], None]:
        """The compiled loop."""

    @abstractmethod
    def _build(self) -> Any:
        """The world before its first event."""

    @abstractmethod
    def _clock(self) -> int:
        """Time of the newest event, us."""

    @abstractmethod
    def _grow(self, status: int) -> None:
        """Make room in the table that was full."""

    @abstractmethod
    def _story(self) -> str:
        """What was broken, in one line."""

    @abstractmethod
    def _schedule(self, fault: Any) -> None:
        """Put a fault into the world's tables."""

    def _slice(self, until_us: int, budget: int) -> int:
        """Run the loop until its time, its budget or a table is used up; why it stopped."""
        self._advance(self.world, until_us, budget)
        for name, parts in self._fresh.items():
            count = int(get(self.world.run, 0, name))
            if count:
                parts.append(getattr(self.world, name)[:count].copy())
                put(self.world.run, 0, **{name: 0})
        status = int(get(self.world.run, 0, "status"))
        if status == BROKEN:
            raise InvariantBroken(self._story())
        self._grow(status)
        return status


def twin(world: Any, shared: tuple[str, ...]) -> tuple[Any, int]:
    """(a copy of a tuple of tables, how many bytes it takes).

    Tables that are views of the same memory are so in the copy, too. Those named in `shared` are
    not copied: nothing is left in them between two slices.
    """
    roots: dict[int, Any] = {}

    def copy(value: Any, name: str) -> Any:
        if not isinstance(value, np.ndarray):
            if not value:
                return value
            parts = zip(value._fields, value, strict=True)
            return type(value)(*(copy(part, field) for field, part in parts))
        if name in shared:
            return value
        root = value
        while isinstance(root.base, np.ndarray):
            root = root.base
        if id(root) not in roots:
            roots[id(root)] = root.copy()
        offset = value.ctypes.data - root.ctypes.data
        return np.ndarray(value.shape, value.dtype, roots[id(root)], offset, value.strides)

    made = copy(world, "")
    return made, sum(root.nbytes for root in roots.values())
