"""CSMA/CD-R as published, step 7: the turns of a resolution, ours and those of others."""

from innervate.dialect.outbox import report
from innervate.dialect.rng import draw
from innervate.networks.radio.protocol.constants import (
    LAST,
    NONE,
    OUTSIDER,
    REPORT_COUNT,
    TURNS_MOST,
)
from innervate.networks.radio.protocol.paper_idle import (
    GARBLED,
    TURNS,
    arm,
    arm_act,
    guard,
    packet_us,
    rest,
    take_turn,
    turn_timeout,
)

DELAY_SLOTS = 8  # T2: delays are drawn from so many slots for each re-collision
NESTED_SLOTS = 64  # N1: longest such delay


def enter_turns(station, params, out):
    """The window is over: so many turns go before ours, so many there are in all.

    [P 2.2 rule 5] "A node which receives n CR - R after it sends a CR - R, transmits its signal at
    n + 1 turns. The last robot to finish a transmission, which transmits no CR - R and receives n
    CR - Rs, transmits its signal at n + 1 turns." Turns of an earlier resolution that were still
    owed when one of them collided come behind these.
    """
    station.mode = TURNS
    station.act = 0
    station.armed = 0
    if station.role == LAST:
        station.left = station.reports
    elif station.role == OUTSIDER or not station.sent:
        station.left = NONE
    else:
        station.left = station.behind
    station.place = station.left + 1
    station.places = station.reports + 1
    station.total = min(station.total + station.reports + 1, TURNS_MOST)
    station.limit = turn_timeout(params)
    report(out, REPORT_COUNT, station.behind, station.reports)


def go_on(station, params, since, now, out):
    """Whose turn is it? Ours, nobody's any more, or that of somebody who may be silent."""
    station.armed = 0
    if station.left == 0:
        own_turn(station, params, now, out)
    elif station.total <= 0:
        rest(station, params, since, out)
    else:
        station.mode = TURNS
        if not station.cd:
            arm(station, since + station.limit, out)


def own_turn(station, params, now, out):
    """Send, unless somebody else does. T2: who collided in its turn delays the next one."""
    if station.cd:
        return
    delay = 0
    if station.again:
        delay = draw(station, DELAY_SLOTS * station.again)
    if delay:
        arm_act(station, now + delay * params.slot_us, out)
    else:
        take_turn(station, params, now, out)


def count_turn(station, params):
    """One turn is over, used or not."""
    station.total = max(station.total - 1, 0)
    if station.left > 0:
        station.left = station.left - 1
    station.limit = turn_timeout(params)


def turn_over(station, params, now, out):
    """The end of a packet, or silence for too long; the next turn begins at this moment."""
    count_turn(station, params)
    go_on(station, params, now, now, out)


def turn_begins(station):
    """A carrier: the turn is used. T2: who delays its own gives it up, and contends later."""
    station.armed = 0
    if station.act:
        station.act = 0
        station.left = NONE


def nested(station, params, now, out):
    """N1: a turn collided, and its CR-Rs mean that many turns more; their window is silent."""
    station.mode = TURNS
    station.total = min(station.total + station.crrs, TURNS_MOST)
    if station.left >= 0:
        station.left = min(station.left + station.crrs, TURNS_MOST)
        station.place = min(station.place + station.crrs, TURNS_MOST)
        station.places = min(station.places + station.crrs, TURNS_MOST)
    station.limit = (
        packet_us(params) + (NESTED_SLOTS + 1) * params.slot_us + 2 * params.ta_us
    ) + turn_timeout(params)
    go_on(station, params, now, now, out)


def garbled(station, params, now, out):
    """N2: a packet that we could not read; if it collided, a CR-R follows."""
    station.mode = GARBLED
    arm(station, now + guard(params), out)


def after_garbled(station, params):
    """N2: no CR-R followed: it was a turn."""
    count_turn(station, params)
    station.mode = TURNS
