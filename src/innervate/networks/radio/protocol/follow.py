"""Practical CSMA/CD-R: what the frames of others, or their absence, mean for the round."""

from innervate.dialect.arith import MASK30, after
from innervate.dialect.outbox import report
from innervate.networks.radio.protocol.bounds import TRIP, adopt, notice
from innervate.networks.radio.protocol.constants import (
    HEARD_TAIL,
    LONE_WINDOWS,
    NEXT_NONE,
    NO_PROOF,
    NONE,
    POSITIONS,
    REPORT_COLLISION,
    REPORT_SKIPPED,
    WINDOWS,
)
from innervate.networks.radio.protocol.idle import leave_sequence
from innervate.networks.radio.protocol.modes import (
    LEAD,
    clear_round,
    disprove,
    following,
    is_passed_over,
    note_joined,
    prove,
    window_of,
)
from innervate.networks.radio.protocol.reporter import lead_first
from innervate.networks.radio.protocol.times import guard, join_after, least_delay, most_delay
from innervate.networks.radio.protocol.turn import enter_turn
from innervate.networks.radio.protocol.window import enter_window

TURNS_COUNTED = 65535
TRIP_MOST = 1 << 20  # us; longer ones are clocks that wrapped


def hear_open(station, params, now, frame, out):
    """Somebody opens a sequence: whatever we followed before is over."""
    if station.pending:
        disprove(station, NO_PROOF, out)
    adopt(station, params, frame, out)
    clear_round(station)
    station.collided = 0
    station.tail = 0
    station.last_ok = 1
    station.slot = NONE
    station.joined = 0
    if frame.more:
        station.live[0] = 1
        station.cur = 0
    size = 1
    if LONE_WINDOWS <= frame.next < NEXT_NONE:
        size = window_of(frame.next)
    enter_window(station, params, now, size, size, size, 1, out)


def hear_data(station, params, now, frame, out):
    """A turn of somebody else: proof for the turn before it, and whose turn is next."""
    sender = frame.pos
    behind = frame.next
    if sender >= POSITIONS or behind == NEXT_NONE:
        return
    if station.pending:
        settle(station, params, now, frame, out)
    if station.mode == LEAD:
        note_joined(station)  # the next turn has begun: nobody used our window
    station.collided = 0
    station.tail = 0
    station.last_ok = 1
    station.slot = NONE
    station.turns = min(station.turns + 1, TURNS_COUNTED)
    station.live[sender] = frame.more
    lone = behind >= LONE_WINDOWS
    opens = behind == sender or behind >= WINDOWS
    size = 1
    if WINDOWS <= behind < NEXT_NONE:
        size = window_of(behind)
    if station.pos != NONE:
        skipped = lone or station.pos == sender
        if not skipped and not opens:
            skipped = is_passed_over(sender, behind, station.pos)
        if skipped:
            report(out, REPORT_SKIPPED, station.pos, 0)
            station.pos = NONE
    if lone:
        clear_round(station)
        station.joined = 0
        station.live[sender] = frame.more
        if frame.more:
            station.cur = sender
        enter_window(station, params, now, size, size, size, 1, out)
    elif opens:
        station.turns = 0
        station.joined = 0
        station.cur = following(station, sender)
        enter_window(station, params, now, size, size, size, 0, out)
    else:
        station.live[behind] = 1
        enter_turn(station, params, now, behind, out)


def settle(station, params, now, frame, out):
    """Our packets are delivered iff the station we named says so at its first chance."""
    start = (now - frame.slots * params.slot_us) & MASK30
    trip = (start - station.end - params.ta_us - guard(params, station.used)) & MASK30
    good = frame.ok and frame.pos == station.named
    if good and station.next == frame.pos:
        least = 2 * least_delay(params, station.used)
        if trip + 1 < least or trip > 2 * most_delay(params, station.used):
            notice(station, params, min(trip // 2, TRIP_MOST), TRIP, out)
    if good and after(station.until, start):
        prove(station, out)
    else:
        disprove(station, NO_PROOF, out)


def sent_data(station, params, now, out):
    """Our turn is over and the radio listens again."""
    opens = station.next == station.pos or station.next >= WINDOWS
    size = 1
    if WINDOWS <= station.next < NEXT_NONE:
        size = window_of(station.next)
    alone = station.next >= LONE_WINDOWS
    if not station.live[station.pos]:
        station.pos = NONE
    if station.cd:
        report(out, REPORT_COLLISION, 0, 0)
        disprove(station, HEARD_TAIL, out)
        if alone:
            leave_sequence(station, now, join_after(params, station.used))
        else:
            enter_turn(station, params, now, station.cur, out)
    elif opens:
        station.turns = 0
        station.opener = 0
        lead_first(station, params, now, size, 1 if alone else 0, out)
    else:
        station.turns = min(station.turns + 1, TURNS_COUNTED)
        enter_turn(station, params, now, station.cur, out)


def garbled_turn(station, params, now, out):
    """Somebody's turn could not be read: it proves nothing, and it may have opened a window."""
    disprove(station, NO_PROOF, out)
    station.last_ok = 0
    behind = following(station, station.cur)
    if behind != NONE and behind <= station.cur:
        station.cur = behind
        station.slot = NONE
        enter_window(station, params, now, 1, 0, 0, 0, out)
    else:
        enter_turn(station, params, now, behind, out)


def silent_turn(station, params, now, out):
    """The station whose turn it is says nothing: it is gone."""
    station.last_ok = 0
    station.live[station.cur] = 0
    if station.pending and station.named == station.cur:
        disprove(station, NO_PROOF, out)
    enter_turn(station, params, now, following(station, station.cur), out)
