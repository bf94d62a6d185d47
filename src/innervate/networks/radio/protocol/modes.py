"""Modes of a station in practical CSMA/CD-R, its timers, and its places in the round."""

from innervate.dialect.arith import MASK30
from innervate.dialect.outbox import report, set_timer
from innervate.networks.radio.protocol.constants import (
    ACT,
    KEPT,
    MAIN,
    NONE,
    POSITIONS,
    REPORT_FAILED,
    WINDOWS,
)
from innervate.networks.radio.protocol.station import delivered
from innervate.networks.radio.protocol.times import (
    asking,
    is_few,
    is_slow,
    keeps,
    pass_slots,
    split_into,
)

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
BUSY_MOST = 15
EARNED = 48  # of a packet; a turn without one costs the square of the places
EARNED_MOST = 1600
WORTH = 30  # turns without a packet that one packet a turn is worth, shared by the places
FLOWING = 500  # slots: from here on many places keep their turns, too
FLOW_MOST = 1000
CALM = 2  # windows without newcomers: all who send have places
CALM_MOST = 7
BUSY = 10  # from here on it is worth a minislot for each to keep places over an idle channel
SIZES = 3  # of announced windows
ACTIVE = 1  # a place whose turn comes in each round
QUIET = 2  # one that is kept for a window; more: windows since it was used
QUIET_MOST = 99  # ... and after so many it is free


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
    station.calm = 0
    station.flow = 0


def rest(station, params, place):
    """A station has sent all that it had: its place is kept, if a minislot can be its own."""
    station.live[place] = QUIET if place < keeps(params) else 0


def rest_round(station, params):
    """The round is over: nobody has a turn, and places that can be kept are."""
    for i in range(POSITIONS):
        if station.live[i] == ACTIVE:
            rest(station, params, i)
    if station.pos >= keeps(params):
        station.pos = NONE
    station.cur = NONE
    station.turns = 0


def count_kept(station):
    """How many minislots kept places need: one each, in the order of their numbers."""
    count = 0
    for i in range(KEPT):
        if station.live[i] >= QUIET:
            count = i + 1
    return count


def count_places(station):
    """How many places are somebody's, with turns or without."""
    count = 0
    for i in range(POSITIONS):
        if station.live[i]:
            count = count + 1
    return count


def earn(station, packets):
    """Slow radios: packets were sent in the round, by whomever."""
    station.credit = min(station.credit + EARNED * packets, EARNED_MOST)


def spend(station):
    """Slow radios: a turn of ours had no packet. The dearer a round, the sooner it ends."""
    places = count_places(station)
    station.credit = max(station.credit - places * places, 0)


def goes_on(station, params):
    """1 if slow radios hand on turns without packets: few have places, and nobody else sends."""
    if not is_slow(params) or station.credit == 0 or station.calm < CALM:
        return False
    return is_few(params, count_places(station)) or is_flowing(station, params)


def is_flowing(station, params):
    """1 if so many packets come that a round of many places is quicker than windows, too.

    Only where a turn may have several packets: a longer round carries no less then.
    """
    if params.per_turn == 1 or station.calm < CALM_MOST:
        return False
    return station.flow >= FLOWING


def note_flow(station, params, packets):
    """Slow radios: a turn is over, whoever had it. Packets are worth the time between them."""
    turn = params.ta_us // params.slot_us + pass_slots(params)
    if packets:
        worth = packets * (WORTH * turn // max(count_places(station), 1))
        station.flow = min(station.flow + worth, FLOW_MOST)
        turn = turn - pass_slots(params)
    station.flow = max(station.flow - turn, 0)


def age_kept(station, params):
    """A window for kept places begins: they are one window older, and free when too old."""
    spent = asking(params, count_kept(station)) // params.slot_us
    station.flow = max(station.flow - spent, 0)
    for i in range(KEPT):
        if station.live[i] >= QUIET:
            station.live[i] = station.live[i] + 1
            if station.live[i] > QUIET_MOST:
                station.live[i] = 0
                if station.pos == i:
                    station.pos = NONE


def first_free(station, params):
    """The first free place that can be kept; NONE if none is."""
    for i in range(keeps(params)):
        if station.live[i] == 0:
            return i
    return NONE


def following(station, pos):
    """The next place after `pos` that has turns, round the circle, `pos` itself last; or NONE."""
    for step in range(1, POSITIONS + 1):
        place = pos + step
        if place >= POSITIONS:
            place = place - POSITIONS
        if station.live[place] == ACTIVE:
            return place
    return NONE


def next_turn(station, params, pos):
    """Whose turn follows that of `pos`; while the round goes on kept places have theirs, too."""
    if not goes_on(station, params):
        return following(station, pos)
    for step in range(1, POSITIONS):
        place = pos + step
        if place >= POSITIONS:
            place = place - POSITIONS
        if station.live[place]:
            return place
    return pos


def is_passed_over(first, last, place):
    """1 if going round from `first` to `last` passes over `place`, both ends left out."""
    if first < last:
        return first < place < last
    return place > first or place < last


def window_of(params, code):
    """How many minislots the window has that a code in `next` announces.

    One for newcomers behind 5, 10 or 20 of kept places; 3, 6 or 12 where none are kept.
    """
    step = (code - WINDOWS) % SIZES
    if is_slow(params):
        return 1 + (5 << step)
    return 3 << step


def code_for(params, minislots):
    """The code of the smallest such window that is no smaller, or of the largest."""
    code = WINDOWS
    while code < WINDOWS + SIZES - 1 and window_of(params, code) < minislots:
        code = code + 1
    return code


def wanted_window(station, params):
    """How many minislots suit those who mostly wait for a window."""
    return 3 * station.crowd * split_into(params) // 16


def note_joined(station, asked):
    """A window is over, with all that followed from it: how many wait for the next?"""
    if asked:
        station.busy = min(station.busy + 2, BUSY_MOST)
    else:
        station.busy = max(station.busy - 1, 0)
    station.calm = 0 if station.joined else min(station.calm + 1, CALM_MOST)
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
