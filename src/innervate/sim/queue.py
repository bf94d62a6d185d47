"""What is queued in a simulation, looked at from outside of its loop."""

from typing import Any

import numpy as np

from innervate.sim import heap
from innervate.sim.tables import get, put


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
