"""A shared channel under way (see sim/driver.py)."""

from collections.abc import Mapping
from typing import Any, ClassVar

from innervate.sim.channel import build, listening, world
from innervate.sim.driver import Simulation
from innervate.sim.queue import first_of
from innervate.sim.status import POOL_FULL
from innervate.sim.tables import get, longer


class Channel(Simulation):
    """Stations that all hear each other; its network says which rows it keeps, and what broke."""

    wide = world.WIDE
    broken_words: ClassVar[Mapping[int, str]] = listening.WORDS

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
        commands = longer(self.world.commands, place + 1)
        self.world = self.world._replace(commands=commands)
        build.put_command(self.world, place, fault)
