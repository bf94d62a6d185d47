"""A field under way (see sim/driver.py)."""

from collections.abc import Mapping
from typing import Any, ClassVar

import numpy as np

from innervate.sim.driver import Simulation
from innervate.sim.field import medium, queue
from innervate.sim.queue import first_of, with_command


class Field(Simulation):
    """Nodes that hear whom they can; its network says which rows it keeps, what more may break."""

    broken_words: ClassVar[Mapping[int, str]] = {
        medium.BROKEN_AIR: "{node} has too many frames under way",
        medium.BROKEN_OUTBOX: "outbox of {node} overflowed",
        medium.BROKEN_RANGE: "a value of {node} is out of its declared range",
        medium.BROKEN_HELD: "{node} handed down a frame while another was under way",
        medium.BROKEN_FRAME: "a receiver changed the frame that {node} had sent",
    }

    def next_us(self) -> int | None:
        """When something happens next; None = never."""
        times = [first_of(self.world.heap)]
        if self.world.below:
            told = bool(self.world.below.told[0])
            times.append(self.clock_us() if told else first_of(self.world.below.heap))
        return min((time for time in times if time is not None), default=None)

    def schedule(self, fault: Any) -> None:
        """Something is to be done to the network; the queue holds the next command's key alone."""
        row = (fault.at_us, fault.action, fault.node, fault.other, fault.value)
        self.world, is_next = with_command(self.world, "time", row)
        if is_next:
            keys, size = self.world.heap
            rank = (keys[: size[0]] >> queue.RANK_SHIFT) & 7
            others = np.sort(keys[: size[0]][rank != queue.COMMAND])
            keys[: len(others)] = others  # in order, hence a heap
            size[0] = len(others)
            queue.push(self.world.heap, queue.key_of(fault.at_us, queue.COMMAND, 0, 0))
