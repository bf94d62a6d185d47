"""Binds the static baseline to the simulator; all but its handlers is the skin's."""

from innervate.networks.skin.protocol import sink as skin_sink
from innervate.networks.skin.protocol import static as skin_static
from innervate.networks.skin.protocol.cell import copy_frame as copy_frame
from innervate.networks.skin.protocol.cell import on_input
from innervate.networks.skin.protocol.constants import SAMPLE
from innervate.networks.skin.sim.stack import check as check
from innervate.networks.skin.sim.stack import deliver as deliver
from innervate.networks.skin.sim.stack import digest as digest
from innervate.networks.skin.sim.stack import give as give
from innervate.networks.skin.sim.stack import local
from innervate.networks.skin.sim.stack import report as report
from innervate.networks.skin.sim.stack import stopped as stopped


def start(world, node, now, cause):
    """Switch a node on."""
    if node == world.run[0].cells:
        skin_sink.on_start(world.pc, world.params[0], now, cause, world.out)
    else:
        skin_static.on_start(world.cells[node], world.params[0], now, cause, world.out)


def hear(world, node, time, port, frame):
    """Hand a node a frame."""
    now = local(world, node, time)
    if node == world.run[0].cells:
        skin_static.sink_frame(world.pc, world.params[0], now, port, frame, world.out)
    else:
        skin_static.on_frame(world.cells[node], world.params[0], now, port, frame, world.out)


def fire(world, node, now, timer):
    """A node's timer fires."""
    if node == world.run[0].cells:
        skin_static.sink_timer(world.pc, world.params[0], now, timer, world.out)
    else:
        skin_static.on_timer(world.cells[node], world.params[0], now, timer, world.out)


def sample(world, node, now):
    """Hand a cell what its sensors say."""
    on_input(world.cells[node], world.params[0], now, SAMPLE, world.sample[0], world.out)
