"""What a network of cables keeps and checks unless it has a recorder of its own.

A row of every report, one of every delivered frame, and the declared range of every field.
"""

from innervate.kernel.records import within
from innervate.sim import delays
from innervate.sim.cables.wires import DELIVERED, is_cut
from innervate.sim.cables.world import BROKEN_RANGE
from innervate.sim.rows import record_delivery, record_row


def on_report(world, time, node, code, a, b):
    """A row of a node's report, if reports are observed."""
    if world.run[0].observe:
        record_row(world, time, node, code, a, b)


def keep_delivered(world, time, node, port, kind, latency):
    """A node's user got a frame; how long it took, us, -1 = nobody knows."""
    world.counters[DELIVERED] += 1
    if latency >= 0:
        delays.note(world, 0, latency)
    record_delivery(world, time, node, port, kind, latency)


def is_off(world, end):
    """True if a cable that is down is so because a node at it is dead, and for nothing else."""
    return not is_cut(world, end)


def on_stop(world, time, node):
    """A node lost its memory or went dark."""


def before_change(world):
    """Cables or nodes are about to go down or to come back."""


def on_change(world, time, node, index):
    """A cable or node changed: nothing is noted of that here."""


def check(world, node):
    """Check the ranges of a node's fields, after every handler."""
    check_range(world, node)


def check_range(world, node):
    """Every word of a node's record lies in its declared range."""
    if world.run[0].broken == 0 and not within(world.words[node], world.low, world.high):
        world.run[0].broken = BROKEN_RANGE
        world.run[0].broken_node = node
