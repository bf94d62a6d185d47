"""Modes of a station in practical CSMA/CD-R, its timers, and its places in the round."""

from innervate.dialect.arith import MASK30
from innervate.dialect.outbox import report, set_timer
from innervate.networks.radio.protocol.constants import (
    ACT,
    MAIN,
    NONE,
    POSITIONS,
    REPORT_FAILED,
    WINDOWS,
)
from innervate.networks.radio.protocol.station import delivered
from innervate.networks.radio.protocol.times import split_into

# Listening.
IDLE = 0  # not in a sequence; opens one when it has a packet and may
LEAD = 1  # reporter: listens to the window behind its own frame
WINDOW = 2  # a window of somebody else
TURN = 3  # waits for the frame of the station whose turn it is
LOST = 4  # a report was garbled: waits for a clean frame
CARRIERS = LOST  # up to here the radio listens
# Deaf, until the radio listens again.
SEND_OPEN = 5
SEND_DATA = 6
SEND_REPORT = 7
SEND_SLOT = 8
CROWD_MOST = 1023
STEPS = 3  # sizes of announced windows


def arm(station, now, delay_us, out):
    """Set the main timer, `delay_us` from now; until `armed` is 0 it means something."""
    station.armed = 1
    set_timer(out, MAIN, (now + delay_us) & MASK30)


def arm_act(station, now, delay_us, out):
    """Set the timer of our minislot."""
    station.act = 1
    set_timer(out, ACT, (now + delay_us) & MASK30)


def clear_round(station):
    """Forget the round: all places are free, it is nobody's turn."""
    for i in range(POSITIONS):
        station.live[i] = 0
    station.pos = NONE
    station.cur = NONE
    station.turns = 0


def following(station, pos):
    """The next taken place after `pos`, round the circle, `pos` itself last; NONE if none is."""
    for step in range(1, POSITIONS + 1):
        place = pos + step
        if place >= POSITIONS:
            place = place - POSITIONS
        if station.live[place]:
            return place
    return NONE


def is_passed_over(first, last, place):
    """1 if going round from `first` to `last` passes over `place`, both ends left out."""
    if first < last:
        return first < place < last
    return place > first or place < last


def window_of(code):
    """How many minislots the window has that a code in `next` announces: 3, 6 or 12."""
    return 3 << ((code - WINDOWS) % STEPS)


def code_for(minislots):
    """The code of the smallest such window that is no smaller, or of the largest."""
    code = WINDOWS
    while code < WINDOWS + STEPS - 1 and window_of(code) < minislots:
        code = code + 1
    return code


def wanted_window(station, params):
    """How many minislots suit those who mostly wait for a window."""
    return 3 * station.crowd * split_into(params) // 16


def note_joined(station):
    """A window is over, with all that followed from it: how many wait for the next?"""
    station.crowd = min(station.crowd // 2 + 2 * station.joined, CROWD_MOST)
    station.joined = 0


def prove(station, out):
    """Somebody has received what we sent last."""
    count = station.pending
    station.pending = 0
    station.fails = 0
    station.lonely = 0
    if count:
        delivered(station, count, out)


def disprove(station, reason, out):
    """Nobody will say that our packets were received: they stay at the head of the queue."""
    if station.pending:
        station.pending = 0
        station.fails = min(station.fails + 1, 255)
        report(out, REPORT_FAILED, station.handle[station.head], reason)
