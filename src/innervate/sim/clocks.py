"""Free-running clocks: every node has its own, with an offset and a drift.

A node's clock reads `time + (time * rate >> 30) + offset` at true time `time` (us); `rate` is the
drift in 2^-30. Protocols see that reading modulo 2^30.
"""

from innervate.protocol.arith import HALF30, MASK30


def reading(clock, time):
    """What the clock shows at true time `time`, before it is taken modulo 2^30."""
    return time + ((time * clock.rate) >> 30) + clock.offset


def true_delay(clock, time, delay):
    """Least true delay (us) from `time` until the clock has moved on by `delay` >= 0."""
    target = time + ((time * clock.rate) >> 30) + delay
    wait = (delay << 30) // ((1 << 30) + clock.rate)
    later = time + wait
    while later > time and (later - 1) + (((later - 1) * clock.rate) >> 30) >= target:
        later -= 1
    while later + ((later * clock.rate) >> 30) < target:
        later += 1
    return later - time


def true_time(clock, time, at):
    """True time at which a timer for clock reading `at` (mod 2^30) fires; overdue ones now."""
    delay = (at - reading(clock, time)) & MASK30
    if delay >= HALF30:
        return time
    return time + true_delay(clock, time, delay)
