"""The skin as the medium of cables is told of it (see sim/cables): its functions, its recorder."""

from innervate.dialect.arith import MASK30
from innervate.networks.skin.protocol import cell as skin
from innervate.networks.skin.protocol import constants as const
from innervate.networks.skin.protocol import sink as skin_sink
from innervate.networks.skin.protocol.cell import copy_frame
from innervate.networks.skin.protocol.constants import NONE
from innervate.networks.skin.sim import observer, orders, proved
from innervate.networks.skin.sim.checks import check_route
from innervate.networks.skin.sim.counters import COMMAND_BLOCK
from innervate.networks.skin.sim.observer import on_links_changed as on_change
from innervate.networks.skin.sim.observer import remember as before_change
from innervate.networks.skin.sim.orders import begin as take_input
from innervate.networks.skin.sim.touch import read_sensors as sense
from innervate.sim import delays
from innervate.sim.cables.recorder import check_range
from innervate.sim.cables.wires import DELIVERED
from innervate.sim.clocks import reading
from innervate.sim.wheel import NOW

__all__ = ["before_change", "copy_frame", "on_change", "sense", "take_input"]


def on_start(world, node, now, cause):
    """Switch a cell or the PC on at its own clock's `now`, us."""
    if node == world.run[0].cells:
        skin_sink.on_start(world.pc, world.params[0], now, cause, world.out)
    else:
        skin.on_start(world.cells[node], world.params[0], now, cause, world.out)
    if world.run[0].checks:
        proved.on_started(world, world.wheel.clock[NOW], node, cause)


def on_frame(world, node, time, port, frame):
    """Hand a node a frame. A beacon is taken in as `skin.on_frame` does, but the clock is read
    only for news: reading it costs a twentieth of an arrival.
    """
    params, out = world.params[0], world.out
    if node == world.run[0].cells:
        skin_sink.on_frame(world.pc, params, local(world, node, time), port, frame, out)
    elif frame.kind == const.BEACON:
        if params.rule == const.RULE_STRICT and world.run[0].checks:
            proved.on_beacon(world, time, node, port, frame)
        if skin.hear(world.cells[node], params, port, frame, out):
            skin.announce_soon(world.cells[node], params, local(world, node, time), out)
    else:
        skin.on_frame(world.cells[node], params, local(world, node, time), port, frame, out)


def local(world, node, time):
    """A node's clock as its protocol sees it."""
    return reading(world.clocks[node], time) & MASK30


def on_timer(world, node, now, timer):
    """A timer of a cell or the PC fires at its own clock's `now`, us."""
    if node == world.run[0].cells:
        skin_sink.on_timer(world.pc, world.params[0], now, timer, world.out)
        if timer == const.TICK and world.run[0].checks:
            proved.on_counted(world, world.wheel.clock[NOW])
    else:
        skin.on_timer(world.cells[node], world.params[0], now, timer, world.out)


def on_input(world, node, now, kind):
    """Hand a cell what its sensors say, or the PC a command to send down."""
    params, item, out = world.params[0], world.sample[0], world.out
    if node == world.run[0].cells:
        skin_sink.on_input(world.pc, params, now, kind, item, out)
    else:
        skin.on_input(world.cells[node], params, now, kind, item, out)


def block_of(frame):
    """The block of counters of a frame that is not urgent."""
    return COMMAND_BLOCK if frame.kind == const.COMMAND else 0


def is_off(world, end):
    """Whoever reads captures knows a dead cell by its cables: they are cut."""
    return False


def digest(frame):
    """A frame in one word, for the fingerprint."""
    if frame.kind == const.DATA:
        word = frame.cell | (frame.seq << 16) | (frame.hops << 24) | (frame.proximity << 32)
        word ^= frame.force[0] * 1000003 + frame.force[1] * 70001 + frame.force[2] * 5003
        return word ^ (frame.accel[2] << 40) ^ (frame.temperature << 20)
    if frame.kind == const.COMMAND:
        word = frame.cell | (frame.sq << 16) | (frame.hops << 32) | (frame.kind << 40)
        return word ^ (frame.dist << 44) ^ (frame.proximity << 48)
    word = frame.dist | (frame.sq << 8) | (frame.load << 24) | (frame.size << 36)
    return word | (frame.parent << 48) | (frame.kind << 49)


def on_report(world, time, node, code, a, b):
    """Note a report; one that changes a route is checked at once."""
    observer.on_report(world, time, node, code, a, b)
    if world.run[0].checks == 0:
        return
    if code <= const.REPORT_BALANCE:
        check_route(world, node)
        if code == const.REPORT_PARENT and b != NONE and world.watch.forgot[node] != NONE:
            proved.on_routed(world, time, node)
    elif code == const.REPORT_FORGET:
        proved.on_forgotten(world, node, proved.HOLD)


def on_stop(world, time, node):
    """A node lost its memory or went dark: it has no parent any more."""
    if node < world.run[0].cells and world.run[0].observe:
        observer.follow(world, time, node, NONE)
        proved.on_stopped(world, node)


def check(world, node):
    """Check the ranges of a cell's fields, after every handler."""
    if node < world.run[0].cells:
        check_range(world, node)


def on_deliver(world, time, node, port, frame):
    """The PC's user gets a tactile sample, or a cell's a command."""
    if frame.kind == const.COMMAND:
        orders.reach(world, time, node, frame)
        return
    world.counters[DELIVERED] += 1
    latency_us = (time - frame.made_at) & MASK30
    delays.note(world, port, latency_us)
    run = world.run[0]
    if run.delivery_limit == 0:
        return
    row = world.deliveries[run.deliveries]
    run.deliveries += 1
    row.time, row.port, row.cell = time, port, frame.cell
    row.seq, row.hops, row.latency = frame.seq, frame.hops, latency_us
    row.proximity, row.temperature = frame.proximity, frame.temperature
    for i in range(3):
        row.force[i] = frame.force[i]
        row.accel[i] = frame.accel[i]
