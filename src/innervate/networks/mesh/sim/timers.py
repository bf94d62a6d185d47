"""Timers of a mesh node, in its own clock."""

from innervate.dialect.arith import MASK30
from innervate.networks.mesh.sim.world import TIMERS
from innervate.sim.field.queue import TIMER, key_of, push


def set_timer(world, node, timer, at, time, now):
    """A timer of a node fires at its clock reading `at`."""
    when = time + max(0, ((at - now + (1 << 29)) & MASK30) - (1 << 29))
    if world.due[node * TIMERS + timer] != when:
        world.due[node * TIMERS + timer] = when
        push(world.heap, key_of(when, TIMER, node, timer))
