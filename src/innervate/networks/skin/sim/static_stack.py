"""The static baseline as the medium of cables is told of it; all but its handlers is the skin's."""

from innervate.networks.skin.protocol import sink as skin_sink
from innervate.networks.skin.protocol import static as skin_static
from innervate.networks.skin.protocol.cell import copy_frame as copy_frame
from innervate.networks.skin.sim.stack import before_change as before_change
from innervate.networks.skin.sim.stack import block_of as block_of
from innervate.networks.skin.sim.stack import check as check
from innervate.networks.skin.sim.stack import digest as digest
from innervate.networks.skin.sim.stack import is_off as is_off
from innervate.networks.skin.sim.stack import local
from innervate.networks.skin.sim.stack import on_change as on_change
from innervate.networks.skin.sim.stack import on_deliver as on_deliver
from innervate.networks.skin.sim.stack import on_input as on_input
from innervate.networks.skin.sim.stack import on_report as on_report
from innervate.networks.skin.sim.stack import on_stop as on_stop
from innervate.networks.skin.sim.stack import sense as sense
from innervate.networks.skin.sim.stack import take_input as take_input


def on_start(world, node, now, cause):
    """Switch a cell or the PC on at its own clock's `now`, us."""
    if node == world.run[0].cells:
        skin_sink.on_start(world.pc, world.params[0], now, cause, world.out)
    else:
        skin_static.on_start(world.cells[node], world.params[0], now, cause, world.out)


def on_frame(world, node, time, port, frame):
    """Hand a node a frame."""
    now = local(world, node, time)
    if node == world.run[0].cells:
        skin_static.sink_frame(world.pc, world.params[0], now, port, frame, world.out)
    else:
        skin_static.on_frame(world.cells[node], world.params[0], now, port, frame, world.out)


def on_timer(world, node, now, timer):
    """A timer of a cell or the PC fires at its own clock's `now`, us."""
    if node == world.run[0].cells:
        skin_static.sink_timer(world.pc, world.params[0], now, timer, world.out)
    else:
        skin_static.on_timer(world.cells[node], world.params[0], now, timer, world.out)
