"""When DIOs are sent: the Trickle algorithm [RFC 6206, 4.2]."""

from innervate.dialect.arith import MASK30
from innervate.dialect.outbox import set_timer
from innervate.dialect.rng import draw
from innervate.networks.rpl.protocol import timers

MS = 1000
LONGEST = 19  # bits of an interval, ms: half of what clocks tell apart


def begin_interval(node, params, now, out):
    """Rule 2: an interval begins; t is a random point in its second half."""
    length = MS << min(params.dio_min + node.interval, LONGEST)
    half = length // 2
    at = half + draw(node, half)
    node.counter = 0
    node.phase = 0
    node.rest = length - at
    set_timer(out, timers.TRICKLE, (now + at) & MASK30)


def note_consistent(node):
    """Rule 3: something that agrees was heard."""
    node.counter = min(node.counter + 1, 255)


def reset_trickle(node, params, now, out):
    """Rule 6: something that disagrees was heard."""
    if node.interval > 0:
        node.interval = 0
        begin_interval(node, params, now, out)


def interval_point(node, params, now, out):
    """Rules 4 and 5: time t, or the interval's end; true if something is to be sent."""
    if node.phase:
        node.interval = min(node.interval + 1, params.dio_doublings)
        begin_interval(node, params, now, out)
        return False
    node.phase = 1
    set_timer(out, timers.TRICKLE, (now + node.rest) & MASK30)
    return params.dio_k == 0 or node.counter < params.dio_k
