"""How long an end-to-end ack is waited for, and how long a message is tried [mesh RELIABLE]."""

from innervate.dialect.arith import MASK30
from innervate.networks.mesh.protocol.constants import ALARM, TABLES

LONGEST_US = 1 << 27
TICK_MAX_US = 1 << 22
UNTOLD = 2  # doublings more of who has no table


def timeout(node, params, w):
    """How long to wait for the end-to-end ack of the message in place w, us.

    Twice as long after every further retry, but for alarms: who is not there is searched
    everywhere each time. Longer where there is no table yet: searches keep tables from coming.
    """
    wait = timeout_min(node, params)
    double = max(0, node.wait_tries[w] - 2)
    if params.e2e_adapt:
        double = max(0, node.wait_tries[w] - 1)
        if params.mode == TABLES and node.version == 0:
            double = double + UNTOLD
    if node.wait_kind[w] != ALARM:
        wait = wait << min(double, 4)
    return min(wait, timeout_max(params))


def timeout_min(node, params):
    """How long an end-to-end ack may take, us."""
    if params.e2e_adapt:
        return min(max(params.e2e_us, 4 * node.round_trip), timeout_max(params))
    return params.e2e_us


def timeout_max(params):
    """Longest wait for an end-to-end ack, us: five of them must fit into a message's life."""
    if params.e2e_adapt:
        return max(params.e2e_us, lifetime(params) >> 3)
    return LONGEST_US


def lifetime(params):
    """How long a message may be tried, us: who hears nothing of us forgets what it had of us.

    The last copy has more time than that to arrive: in full queues it may need it.
    """
    silence = params.forget * min(params.tick_us, TICK_MAX_US)
    return min((silence >> 1) - (silence >> 4), LONGEST_US)


def learn_round_trip(node, params, w, now):
    """The message in place w was acknowledged.

    Of a retried one the time is too long rather than too short, for the ack may be of any of its
    sendings. If it never counted, a network slower than e2e_us would be filled with retries for
    ever; if it counted in full, one lost message would make us wait for the next even longer.
    """
    took = (now - node.wait_at[w]) & MASK30
    if node.wait_tries[w] > 1:
        if not params.e2e_adapt:
            return
        took = min(took, 2 * max(params.e2e_us, node.round_trip))
    if took < 16_777_216:
        if node.round_trip == 0:
            node.round_trip = took
        else:
            node.round_trip = (7 * node.round_trip + took) >> 3
