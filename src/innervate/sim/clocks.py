"""Free-running clocks: every node has its own, with an offset and a drift.

A node's clock reads `time + (time * rate >> 30) + offset` at true time `time` (us); `rate` is the
drift in 2^-30 and `inverse` 2^60 / (2^30 + rate). Protocols see that reading modulo 2^30.
"""

from innervate.dialect.arith import HALF30, MASK30


def timer_slot(world, node, timer):
    """The queue slot of a node's timer: all first timers, then all second ones, and so on."""
    return timer * world.run[0].nodes + node


def timer_of(world, slot):
    """Which timer a slot below `run.tx_slots` is; its node is the rest."""
    nodes = world.run[0].nodes
    return (slot >= nodes) + (slot >= 2 * nodes) + (slot >= 3 * nodes)


def reading(clock, time):
    """What the clock shows at true time `time`, before it is taken modulo 2^30."""
    return time + ((time * clock.rate) >> 30) + clock.offset


def true_delay(world, node, time, delay):
    """Least true delay (us) until a node's clock shows `delay` us more, 0 <= delay < 2^29."""
    rate = world.clocks[node].rate
    past = (time * rate) & MASK30  # the clock's exact reading is ahead of the shown one by this
    goal = (delay << 30) - past
    # The estimate is too short by one or two at the most and never too long.
    wait = (delay * world.starts[node].inverse) >> 30
    wait += wait * ((1 << 30) + rate) < goal
    wait += wait * ((1 << 30) + rate) < goal
    return wait


def true_time(world, node, time, now, at):
    """True time at which a timer for clock reading `at` (mod 2^30) fires; overdue ones now.

    `now` is the node's reading at true time `time`.
    """
    delay = (at - now) & MASK30
    if delay >= HALF30:
        return time
    return time + true_delay(world, node, time, delay)
