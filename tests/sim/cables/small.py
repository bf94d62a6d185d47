"""A line of two cells on cables, all nodes on, and functions of a network that note their calls."""

from unittest import mock

from innervate.networks.skin.sim.build import build
from innervate.sim import tables, wheel
from innervate.sim.cables import build as cables
from innervate.sim.cables.wires import OTHER_BLOCK
from innervate.sim.cables.world import ALIVE
from tests.networks.skin.runs import line, plan_of

END, PEER = 1, 4  # cell 0 east to cell 1 west
SINK = 2


class Do:
    """Functions of a network that note how they are called."""

    def __init__(self, world):
        self.said, self.world = [], world

    def __getattr__(self, name):
        def note(_world, *what):
            self.said.append((name, *what))

        return note

    def digest(self, frame):
        return frame.seq

    def block_of(self, _frame):
        return OTHER_BLOCK

    def is_off(self, _world, _end):
        return False

    def copy_frame(self, to, frame):
        to.seq = frame.seq


def small_world(keys=None, **kept):
    """Nothing is under way; clocks do not drift, and are 100, 200 and 300 us ahead."""
    plan = plan_of(keys or line(2, data={"rate_hz": 100}, timing={"loss": 0.0}))
    with mock.patch.object(cables, "BATCH", 8), mock.patch.object(tables, "PLAIN_ROWS", 8):
        world = build(plan, plain=True, **kept)
    for node in range(world.run[0].nodes):
        world.alive[node] = ALIVE
        world.clocks[node].offset = 100 * (node + 1)
        world.clocks[node].rate = 0
        world.starts[node].inverse = (1 << 30) - 1
    return world


def timers(world):
    """What is queued of nodes' timers: (node, timer): when."""
    nodes = world.run[0].nodes
    slots = range(world.run[0].tx_slots)
    return {(slot % nodes, slot // nodes): world.wheel.events[slot].time
            for slot in slots if world.wheel.events[slot].bucket != wheel.NIL}  # fmt: skip
