"""Wrap-safe comparisons of clocks (30 bits) and sequence numbers (16 bits, RFC 1982)."""

MASK30 = (1 << 30) - 1
HALF30 = 1 << 29
MASK16 = 0xFFFF
HALF16 = 0x8000


def after(a, b):
    """1 if clock reading a is b or later; both in microseconds modulo 2^30, at most 2^29 apart."""
    return ((a - b) & MASK30) < HALF30


def time_left(due, now):
    """Microseconds until a clock reads `due`, at most 2^29; 0 if it has."""
    return 0 if after(now, due) else (due - now) & MASK30


def sooner(soonest, wait):
    """The shorter of two waits, us; the first is -1 where there is none yet."""
    return wait if soonest < 0 or wait < soonest else soonest


def later(a, b):
    """1 if sequence number a is newer than b (RFC 1982, 16 bits); equal numbers are not."""
    ahead = (a - b) & MASK16
    return ahead != 0 and ahead < HALF16
