"""Timers of a node in a field, in its own clock: its protocol's, then those of what is below."""

from innervate.dialect.arith import MASK30
from innervate.sim.field.queue import TIMER, key_of, push


def set_timer(world, node, timer, at, time, now):
    """A timer of a node fires at its clock reading `at`."""
    when = time + max(0, ((at - now + (1 << 29)) & MASK30) - (1 << 29))
    place = node * world.run[0].timers + timer
    if world.due[place] != when:
        world.due[place] = when
        push(world.heap, key_of(when, TIMER, node, timer))
