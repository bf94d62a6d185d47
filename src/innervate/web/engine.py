"""A simulation that can be held at any microsecond, changed there, and gone on with."""

from bisect import bisect_left, insort
from collections.abc import Collection
from typing import Any, NamedTuple

import numpy as np

from innervate.network import networks
from innervate.sim.driver import Simulation
from innervate.sim.status import DONE
from innervate.web.errors import WatchError

Rows = dict[str, Any]


class Mark(NamedTuple):
    """A simulation as it was at some moment, to go back to; `bytes` is what it takes."""

    now_us: int
    world: Any
    bytes: int


class Engine:
    """A network while it runs, compiled: held at any microsecond, changed, taken back.

    It is the simulation that `innervate run` drives, too: same plan, same network.

    Attributes:
        plan: what runs.
        now_us: everything before this time has happened, and nothing at it or after it.
        given: faults added to those of the plan, in the order in which they were given.
    """

    def __init__(self, running: Simulation) -> None:
        self.running = running
        self.plan = running.plan
        self.now_us = 0
        self.given: list[Any] = []
        self._times: list[int] = sorted(fault.at_us for fault in self.plan.faults)

    @property
    def world(self) -> Any:
        """The tables of the simulation as they are now."""
        return self.running.world

    def advance(self, until_us: int, budget: int) -> None:
        """Go on to `until_us`, or, after about `budget` events, to some whole microsecond before.

        Raises:
            InvariantBroken: a checker found what must not happen.
        """
        if until_us <= self.now_us or self.running.is_complete():
            return
        running = self.running
        if running.advance(until_us, budget) != DONE:
            until_us = min(until_us, max(running.clock_us(), self.now_us) + 1)
            while running.advance(until_us, budget) != DONE:
                pass
        self.now_us = running.clock_us() + 1 if self.running.is_complete() else until_us

    def mark(self) -> Mark:
        """A copy of everything at this moment, to come back to."""
        world, size = twin(self.world, self.running.tables)
        return Mark(self.now_us, world, size)

    def back_to(self, mark: Mark) -> None:
        """Go back to a moment that was remembered; what was given for later happens again."""
        self.running.world = twin(mark.world, self.running.tables)[0]
        self.now_us = mark.now_us
        self.running.take()
        for fault in self.given:
            if fault.at_us >= self.now_us:
                self.running.schedule(fault)

    def add(self, fault: Any) -> None:
        """Something is to be done to the network, not before `earliest_us`."""
        self.given.append(fault)
        insort(self._times, fault.at_us)
        self.running.schedule(fault)

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
    def is_before_fault(self) -> bool:
        """Something is done to the network at this moment, and has not happened yet."""
        at = bisect_left(self._times, self.now_us)
        return at < len(self._times) and self._times[at] == self.now_us

    @property
    def earliest_us(self) -> int:
        """When something can be done at the earliest: the network begins at 0, by itself."""
        return max(self.now_us, 1)


def engine_of(plan: Any) -> Engine:
    """The engine of a plan.

    Raises:
        WatchError: it cannot be watched: it has no clock, say, or is too large.
    """
    network = networks()[plan.kind]
    why = network.unwatchable(plan)
    if why:
        raise WatchError(f"{plan.scenario.path or plan.scenario.name}: {why}")
    made: Engine = network.engine(network.simulation(plan))
    return made


def twin(world: Any, shared: Collection[str]) -> tuple[Any, int]:
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
