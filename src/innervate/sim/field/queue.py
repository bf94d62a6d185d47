"""What the mesh's events are, and their order at equal times; the heap itself is the radio's.

Signals end before others start, both before anything that could look at the channel.
"""

from innervate.dialect.arith import MASK30
from innervate.networks.mesh.sim.world import TIMERS
from innervate.sim.heap import (
    AIR_BITS,
    LAST,
    RANK_SHIFT,
    SENDER_BITS,
    STATION_SHIFT,
    STATIONS_MAX,
    TIME_MAX,
    TIME_SHIFT,
    key_of,
    pop,
    push,
)

# The first three belong to the layer below the router.
ENDS = 0  # what: the frame's place
STARTS = 1  # what: the frame's place
TELL = 2  # what becomes of a frame: the medium access has given it up, or delivered it
TIMER = 3  # what: which
COMMAND = 4  # the next in the table
SAMPLE = 5  # what: which walk
OFFER = 6  # the next in the table

WHAT_MASK = (1 << STATION_SHIFT) - 1
PLACES_MAX = 1 << (SENDER_BITS + AIR_BITS)

__all__ = [
    "LAST", "RANK_SHIFT", "STATIONS_MAX", "STATION_SHIFT", "TIME_MAX", "TIME_SHIFT", "key_of",
    "pop", "push", "set_timer",
]  # fmt: skip


def set_timer(world, node, timer, at, time, now):
    """A timer of a node fires at its clock reading `at`."""
    when = time + max(0, ((at - now + (1 << 29)) & MASK30) - (1 << 29))
    if world.due[node * TIMERS + timer] != when:
        world.due[node * TIMERS + timer] = when
        push(world.heap, key_of(when, TIMER, node, timer))
