"""The outbox: what a handler wants done. Drivers drain it; no driver knows a protocol by name.

`out` has `count[0]` (actions so far), `limit[0]` (room), `overflow[0]` (1 = an action did not
fit, a broken invariant), and two tables of equal length: `action[i]` with kind, a, b, c and
`frame[i]`.
"""

SEND = 1
SET_TIMER = 2
DELIVER = 3
REPORT = 4

# Flags of SEND.
URGENT = 1  # goes to the head of the port's queue, waits only for the frame on the wire
FLUSH = 2  # the port is given up: drop what its queue holds
STOP = 4  # no frame: the one on the air ends here (full duplex only)


def put(out, kind, a, b, c):
    """Append an action; returns its index, so that the caller can fill out.frame[index]."""
    i = out.count[0]
    if i >= out.limit[0]:
        out.overflow[0] = 1
        return i - 1
    act = out.action[i]
    act.kind = kind
    act.a = a
    act.b = b
    act.c = c
    out.count[0] = i + 1
    return i


def send(out, port, delay_us, flags):
    """SEND the frame that the caller fills at out.frame[result]."""
    return put(out, SEND, port, delay_us, flags)


def set_timer(out, timer, at):
    """SET_TIMER: `timer` fires at clock reading `at` (microseconds mod 2^30); replaces."""
    return put(out, SET_TIMER, timer, at, 0)


def deliver(out, kind):
    """DELIVER to the node's own user the frame that the caller fills at out.frame[result]."""
    return put(out, DELIVER, kind, 0, 0)


def report(out, code, a, b):
    """REPORT something to whoever watches: codes belong to the protocol."""
    return put(out, REPORT, code, a, b)
