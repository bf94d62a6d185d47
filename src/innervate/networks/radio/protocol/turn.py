"""Practical CSMA/CD-R, turns: a round of stations that send one after another without a gap.

Every data frame names whose turn follows, and says whether the frame before it was received:
that is the proof which the sender of that frame waits for.
"""

from innervate.dialect.arith import MASK30
from innervate.dialect.outbox import report
from innervate.dialect.rng import draw
from innervate.networks.radio.protocol import modes
from innervate.networks.radio.protocol.constants import (
    ALONE,
    DATA,
    LONE_WINDOWS,
    NO_PROOF,
    NONE,
    REPORT_TURN,
    WINDOWS,
)
from innervate.networks.radio.protocol.idle import leave_sequence, schedule
from innervate.networks.radio.protocol.modes import (
    arm,
    arm_act,
    code_for,
    count_kept,
    count_places,
    disprove,
    earn,
    goes_on,
    next_turn,
    note_flow,
    rest,
    spend,
    wanted_window,
    window_of,
)
from innervate.networks.radio.protocol.station import blank, load_packets
from innervate.networks.radio.protocol.times import (
    guard,
    is_slow,
    join_after,
    minislot,
    most_delay,
    pass_slots,
    retry_within,
    turn_timeout,
)

FAILS_MOST = 3  # packets without proof, then we leave the round
CREDIT = 2  # turns without a packet that one with a packet earns; the first earns one
CREDIT_MOST = 4
RAREST = 4  # times `turns`: between windows that nobody comes to
CROWD_WAITS = 4  # quarters of a station: somebody mostly waits for a window


def enter_turn(station, params, now, cur, out):
    """It is the turn of place `cur`: ours, somebody's, or (NONE) the round is over."""
    if cur == NONE:
        finish(station, params, now, out)
        return
    station.cur = cur
    station.act = 0
    if cur == station.pos:
        if station.pending:
            disprove(station, NO_PROOF, out)
        wait = guard(params, station.used)
        passes = station.queued == 0 and station.credit == 0 and not is_slow(params)
        if passes or station.fails >= FAILS_MOST:
            quit_round(station, params, now, out)
        elif wait:
            station.mode = modes.TURN
            station.armed = 0
            arm_act(station, now, wait, out)
        else:
            send_turn(station, params, now, out)
        return
    station.mode = modes.TURN
    if station.cd:
        station.armed = 0
    else:
        arm(station, now, turn_timeout(params, station.used), out)


def finish(station, params, now, out):
    """The round seems to be over; whoever knows more than we do goes first."""
    if station.pending:
        disprove(station, NO_PROOF, out)
    wait = turn_timeout(params, station.used) + draw(station, retry_within(params, station.used))
    leave_sequence(station, params, now, wait)
    schedule(station, now, out)


def quit_round(station, params, now, out):
    """Give up our place: nothing to send, or nobody seems to receive us."""
    station.live[station.pos] = 0
    station.pos = NONE
    station.fails = 0
    wait = join_after(params, station.used) + draw(station, retry_within(params, station.used))
    leave_sequence(station, params, now, wait)
    schedule(station, now, out)


def is_due(station, params, size):
    """1 if a window of so many minislots is due behind this round: the larger, the rarer.

    With slow radios one for newcomers only is rarer with each that nobody came to.
    """
    due = params.turns + 2 * (size - 1)
    if size == 1 and is_slow(params):
        due = min(count_places(station) << station.calm, RAREST * due)
    return station.turns + 1 >= due or station.crowd >= CROWD_WAITS


def stays(station, params, count, alone):
    """1 if we keep our turns without having more packets; `count` are in this one."""
    if is_slow(params):
        note_flow(station, params, count)
        if count:
            earn(station, count)
        else:
            spend(station)
        return goes_on(station, params) and not alone and not station.leaving
    if count:
        station.credit = min(station.credit + (CREDIT if station.credit else 1), CREDIT_MOST)
    else:
        station.credit = station.credit - 1
    return station.credit > 0 and not alone


def send_turn(station, params, now, out):
    """Send our packets; the last of a round opens a window for newcomers now and then."""
    report(out, REPORT_TURN, station.pos, 0)
    frame = blank(out)
    count = load_packets(station, frame, params.per_turn)
    frame.kind = DATA
    if count == 0:
        frame.slots = pass_slots(params)
    behind = next_turn(station, params, station.pos)
    alone = behind == station.pos or behind == NONE
    more = stays(station, params, count, alone) or station.queued > count
    frame.pos = station.pos
    frame.more = 1 if more else 0
    frame.ok = station.last_ok
    wraps = behind <= station.pos
    station.end = (now + params.ta_us + frame.slots * params.slot_us) & MASK30
    longest = most_delay(params, station.used)
    limit = params.ta_us + 2 * longest + guard(params, station.used)
    if not more:
        rest(station, params, station.pos)
    size = max(wanted_window(station, params), 1) + count_kept(station)
    ends = not more and not is_slow(params)  # a window is soon over
    opens = alone or (wraps and (ends or is_due(station, params, size)))
    station.named = NONE if alone else behind
    if opens:
        frame.next = ALONE if alone else station.pos
        if size > 1:
            frame.next = code_for(params, size)
            size = window_of(params, frame.next)
            if alone:
                frame.next = frame.next + LONE_WINDOWS - WINDOWS
        length = size * minislot(params, station.used)
        limit = limit + params.ta_us + 3 * longest + length
    else:
        frame.next = behind
    station.next = frame.next
    station.until = (station.end + limit) & MASK30
    station.pending = count
    station.last_ok = 0
    station.armed = 0
    station.mode = modes.SEND_DATA
    station.cur = behind
    if alone and not more:
        station.cur = NONE
