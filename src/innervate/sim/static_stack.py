"""Binds the static baseline to the simulator; all but its handlers is the skin's."""

from innervate.protocol import skin_sink, skin_static
from innervate.protocol.skin import copy_frame as copy_frame
from innervate.protocol.skin import on_input
from innervate.protocol.skin_words import SAMPLE
from innervate.sim.skin_stack import check as check
from innervate.sim.skin_stack import deliver as deliver
from innervate.sim.skin_stack import digest as digest
from innervate.sim.skin_stack import give as give
from innervate.sim.skin_stack import local
from innervate.sim.skin_stack import report as report
from innervate.sim.skin_stack import stopped as stopped


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
