"""CSMA/CD-R as published: modes, derived times, and the way to the first transmission.

Section numbers [radio ...] are those of docs/radio.md; P stands for the paper's own words.
"""

from innervate.dialect.arith import MASK30
from innervate.dialect.outbox import report, set_timer
from innervate.dialect.rng import draw
from innervate.networks.radio.protocol.constants import (
    ACT,
    DATA,
    MAIN,
    NOBODY,
    NONE,
    REPORT_ROLE,
    REPORT_TURN,
)
from innervate.networks.radio.protocol.station import blank, load_packets

# Listening.
IDLE = 0  # step 1: sends when it has a packet and the channel is idle
JOIN = 1  # switched on late: a resolution may be under way
TAIL = 2  # after our packet there was a carrier at once
QUIET = 3  # after our packet there was none, or it ended before anybody's could who ended later
AWAIT = 4  # collided: waits for the first CR-R
RESERVE = 5  # counts CR-Rs, and sends its own
TURNS = 6  # counts turns, and takes its own
GARBLED = 7  # a turn could not be read: was it one?
# Deaf, until the radio listens again.
SEND_DATA = 8
SEND_CRR = 9

RECOLLISIONS = 8  # T2: no more than so many lengthen the wait


def packet_us(params):
    """T: a packet's time on the air."""
    return params.packet_slots * params.slot_us


def guard(params):
    """G: so long after our end a CR-R must have begun, if there is one."""
    return 2 * params.dmax_us + params.ta_us + params.bit_us


def turn_timeout(params):
    """D: silence after which a turn is given up."""
    return 4 * params.dmax_us + 2 * params.ta_us


def space(params):
    """F: idle time before a packet that has no turn; longer than between two turns."""
    return 2 * params.dmax_us + 2 * params.ta_us + params.bit_us


def arm(station, at, out):
    """Set the main timer to a moment."""
    station.armed = 1
    set_timer(out, MAIN, at & MASK30)


def arm_act(station, at, out):
    """Set the timer of our CR-R, or of our delayed turn, to a moment."""
    station.act = 1
    set_timer(out, ACT, at & MASK30)


def take_role(station, role, out):
    """What we are in the resolution of a collision."""
    station.role = role
    report(out, REPORT_ROLE, role, 0)


def rest(station, params, since, out):
    """Step 1: no resolution; if there is no carrier, the channel is idle since `since`."""
    station.mode = IDLE
    station.role = NOBODY
    station.left = NONE
    station.total = 0
    station.act = 0
    wait(station, params, since, out)


def wait(station, params, since, out):
    """[P 2.2] "If the channel is busy, it waits for a random period of time": F and a draw."""
    station.free = 0
    station.armed = 0
    station.since = since & MASK30
    if station.cd:
        return
    gap = space(params)
    if station.queued:
        gap = gap + draw(station, params.wait_us + 1)
    arm(station, since + gap, out)


def waited(station, params, now, out):
    """The channel stayed idle: send what waits, or from now on send at once."""
    if station.queued:
        transmit(station, params, now, 0, out)
    else:
        station.free = 1


def joined(station, params, now, out):
    """Silence for longer than a packet and a dead turn: there is no resolution under way."""
    station.mode = IDLE
    station.since = now
    station.free = 1
    if station.queued:
        station.free = 0
        arm(station, now + draw(station, params.wait_us + 1), out)


def offered(station, params, now, out):
    """[P 2.2] "If the channel is sensed idle (CD = 0), a ready node transmits ... immediately"."""
    if station.mode != IDLE:
        return
    if station.free:
        transmit(station, params, now, 0, out)
    elif station.queued == 1:
        wait(station, params, station.since, out)


def forced(station, params, now, out):
    """A test's wish: send whatever the carrier says, if the radio can."""
    if station.mode < SEND_DATA:
        transmit(station, params, now, 0, out)


def transmit(station, params, now, turn, out):
    """Send the oldest packet; `turn` says if it is our turn in a resolution."""
    frame = blank(out)
    load_packets(station, frame, 1)
    frame.kind = DATA
    station.end = (now + params.ta_us + frame.slots * params.slot_us) & MASK30
    station.turn = turn
    station.free = 0
    station.armed = 0
    station.act = 0
    station.mode = SEND_DATA


def take_turn(station, params, now, out):
    """Send in our turn; it is one less for all."""
    report(out, REPORT_TURN, station.place, station.places)
    station.left = NONE
    station.total = max(station.total - 1, 0)
    transmit(station, params, now, 1, out)
