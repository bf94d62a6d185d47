"""A network of cables under way (see sim/driver.py)."""

from __future__ import annotations

from typing import Any

from innervate.sim import wheel
from innervate.sim.cables import build, wires
from innervate.sim.cables.world import ALIVE
from innervate.sim.counts import Counts
from innervate.sim.driver import Simulation
from innervate.sim.queue import with_command
from innervate.sim.status import POOL_FULL
from innervate.sim.tables import get


class Cables(Simulation):
    """Nodes that are joined by cables; its network says which rows it keeps, and what broke."""

    def clock_us(self) -> int:
        """Time of the newest event, us."""
        return int(self.world.wheel.clock[wheel.NOW])

    def counts(self) -> Counts:
        """Frames of all classes on all cables, and what users gave and got."""
        numbers, alive = self.world.counters, self.world.alive
        return Counts(
            nodes=len(alive),
            off=tuple(node for node in range(len(alive)) if alive[node] != ALIVE),
            sent=_in_all_blocks(numbers, wires.SENT),
            arrived=_in_all_blocks(numbers, wires.ARRIVED),
            lost_by={name: _in_all_blocks(numbers, word) for name, word in wires.REASONS.items()},
            offered=int(numbers[wires.OFFERED]),
            delivered=int(numbers[wires.DELIVERED]),
            dropped_by={"no_route": int(numbers[wires.NO_ROUTE]),
                        "loop": int(numbers[wires.LOOPED])},
        )  # fmt: skip

    def next_us(self) -> int | None:
        """When something happens next; None = never."""
        world = self.world
        events = world.wheel.events[: int(world.wheel.pool[wheel.FRESH])]
        times = events["time"][events["bucket"] != wheel.NIL]
        found = [int(times.min())] if len(times) else []
        place = int(get(world.run, 0, "next_command"))
        if place < int(get(world.run, 0, "commands")):
            found.append(int(world.commands["at"][place]))
        return min(found, default=None)

    def grow(self, status: int) -> None:
        """Make room for more frames on their way."""
        if status == POOL_FULL:
            self.world = build.grow_pool(self.world)

    def schedule(self, fault: Any) -> None:
        """Something is to be done to the network."""
        self.schedule_row(build.fault_row(fault))

    def schedule_row(self, row: tuple[int, ...]) -> None:
        """One row of `world.COMMAND`, at a time that has not come yet."""
        self.world, _ = with_command(self.world, "at", row)


def _in_all_blocks(numbers: Any, word: int) -> int:
    return sum(int(numbers[word + block]) for block in wires.BLOCKS)
