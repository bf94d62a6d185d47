"""CSMA/CD-R as published, steps 2 to 5: did our packet collide, and who are we if it did?"""

from innervate.dialect.arith import MASK30
from innervate.dialect.outbox import report
from innervate.networks.radio.protocol.constants import LAST, OTHER, REPORT_COLLISION, REPORTER
from innervate.networks.radio.protocol.paper_idle import (
    AWAIT,
    QUIET,
    RECOLLISIONS,
    TAIL,
    arm,
    guard,
    rest,
    take_role,
)
from innervate.networks.radio.protocol.paper_reserve import (
    NOISE,
    NOTHING,
    PACKET_ENDS,
    REPORTS,
    heard_first,
    report_first,
)
from innervate.networks.radio.protocol.paper_turns import count_turn, garbled, go_on
from innervate.networks.radio.protocol.station import delivered


def verify(station, params, now, cd, voc, out):
    """Step 2, our radio listens again after our packet.

    [P 2.2 rule 1] "After transmitting a packet, if a packet is received, it is assumed to be
    collided."
    """
    station.known = 0
    if cd:
        station.mode = TAIL
        station.single = 0
        station.valid = now
        note_single(station, params, now, voc)
    else:
        station.mode = QUIET
        arm(station, station.end + guard(params), out)


def note_single(station, params, now, voc):
    """The last moment at which one signal was left: what is valid at once counts from our end."""
    if voc:
        station.valid = now
        if now == (station.end + params.ta_us) & MASK30:
            station.valid = station.end
    station.single = voc


def collided(station, out):
    """We know that our packet collided; again in a row, if it was sent in a turn."""
    station.known = 1
    report(out, REPORT_COLLISION, station.turn, 0)
    if station.turn:
        station.again = min(station.again + 1, RECOLLISIONS)
    else:
        station.again = 0


def tail_ends(station, params, now, out):
    """Step 4: the others have ended; how long after us, and for how long was it only one?"""
    collided(station, out)
    if not station.single:
        station.valid = now
    tail = (now - station.end) & MASK30
    valid = (station.valid - station.end) & MASK30
    if params.tail_rule and tail < params.dmax_us:
        # T1: whoever ended after us is heard for at least tau.
        station.mode = QUIET
        arm(station, station.end + guard(params), out)
        return
    station.tc = max(valid - params.dmax_us, 0)
    if station.tc == 0:
        station.tc0 = max(tail - params.dmax_us, 0)
        take_role(station, REPORTER, out)
        report_first(station, params, now, out)
    else:
        station.tc0 = tail - valid
        take_role(station, OTHER, out)
        station.mode = AWAIT
        arm(station, now + guard(params) + station.tc, out)


def substitute(station, params, now, out):
    """Step 5: nobody reports the collision, so we do; the shortest Tc comes first."""
    report_first(station, params, now, out)


def succeed(station, out):
    """As far as we can tell everybody received our packet."""
    station.again = 0
    delivered(station, 1, out)


def guard_over(station, params, now, out):
    """Step 3: nobody reports a collision. If we know better, try again later."""
    if not station.known:
        succeed(station, out)
    go_on(station, params, station.end + params.dmax_us, now, out)


def quiet_burst(station, params, now, what, out):
    """Step 3: a CR-R says that we collided and ended last; a packet that it was ours alone."""
    if what == REPORTS:
        if not station.known:
            collided(station, out)
        heard_first(station, params, now, LAST, out)
        return
    if not station.known:
        succeed(station, out)
    missed(station, params, now, what, out)


def await_burst(station, params, now, what, out):
    """Step 5: the first CR-R, or a resolution that goes on without us."""
    if what == REPORTS:
        heard_first(station, params, now, OTHER, out)
    elif what == NOTHING:
        arm(station, now + guard(params), out)
    else:
        missed(station, params, now, what, out)


def missed(station, params, now, what, out):
    """A packet: somebody's turn in what we still follow, or nothing that we know of."""
    if station.total == 0:
        rest(station, params, now, out)
    elif what == NOISE:
        garbled(station, params, now, out)
    else:
        if what == PACKET_ENDS:
            count_turn(station, params)
        go_on(station, params, now, now, out)
