"""A shared channel under way (see sim/driver.py)."""

from typing import Any

import numpy as np

from innervate.sim import heap
from innervate.sim.channel import build, world
from innervate.sim.driver import Simulation
from innervate.sim.queue import first_of
from innervate.sim.status import POOL_FULL
from innervate.sim.tables import get, put


class Channel(Simulation):
    """Stations that all hear each other; its network says which rows it keeps, and what broke."""

    wide = world.WIDE

    def is_complete(self) -> bool:
        """Stations that had so many packets to deliver end with the last of them."""
        wanted = int(get(self.world.run, 0, "wanted"))
        return int(get(self.world.run, 0, "completed")) >= wanted > 0

    def broken_us(self) -> int:
        """When it broke, as it was noted, us."""
        return max(int(get(self.world.run, 0, "broken_at")), 0)

    def next_us(self) -> int | None:
        """When something happens next; None = never."""
        return self.clock_us() if self.world.told[0] else first_of(self.world.heap)

    def grow(self, status: int) -> None:
        """Make room for more events."""
        if status == POOL_FULL:
            self.world = build.grow_heap(self.world)

    def schedule(self, fault: Any) -> None:
        """Something is to be done to the network."""
        place = len(self.world.commands)
        longer = np.zeros(place + 1, self.world.commands.dtype)
        longer[:place] = self.world.commands
        self.world = self.world._replace(commands=longer)
        put(self.world.commands, place, action=fault.action, node=fault.node, value=fault.value)
        put(self.world.commands, place, index=fault.index)
        heap.push(self.world.heap, heap.key_of(fault.at_us, heap.COMMAND, 0, place))
