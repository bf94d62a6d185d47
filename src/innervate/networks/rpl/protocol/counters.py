"""Sequence counters [RFC 6550, 7.2] and ranks [RFC 6550, 3.5.1]."""

from innervate.networks.rpl.protocol.constants import WINDOW

CIRCULAR = 128


def following(value):
    """The next of a counter: straight up to 255, then round and round below 128."""
    if value == 255 or value == CIRCULAR - 1:
        return 0
    return value + 1


def is_newer(a, b):
    """True if counter a is greater than b; of those that cannot be compared neither is."""
    if a >= CIRCULAR and b < CIRCULAR:
        return 256 + b - a > WINDOW
    if a < CIRCULAR and b >= CIRCULAR:
        return 256 + a - b <= WINDOW
    ahead = a - b if a >= CIRCULAR else (a - b) & (CIRCULAR - 1)
    return ahead > 0 and ahead <= WINDOW


def dag_rank(rank, step):
    """The whole part of a rank."""
    return rank // step
