"""Practical CSMA/CD-R: what the frames of others, or their absence, mean for the round."""

from innervate.dialect.arith import MASK30, after
from innervate.dialect.outbox import report
from innervate.networks.radio.protocol import modes
from innervate.networks.radio.protocol.bounds import TRIP, adopt, notice
from innervate.networks.radio.protocol.constants import (
    HEARD_TAIL,
    KEPT,
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
    ACTIVE,
    QUIET,
    clear_round,
    code_for,
    count_kept,
    disprove,
    earn,
    following,
    is_passed_over,
    note_flow,
    note_joined,
    prove,
    rest,
    rest_round,
    window_of,
)
from innervate.networks.radio.protocol.reporter import lead_first
from innervate.networks.radio.protocol.times import (
    guard,
    is_slow,
    join_after,
    least_delay,
    most_delay,
    silence_behind,
)
from innervate.networks.radio.protocol.turn import enter_turn
from innervate.networks.radio.protocol.window import enter_first, enter_window

TURNS_COUNTED = 65535
TRIP_MOST = 1 << 20  # us; longer ones are clocks that wrapped


def hear_open(station, params, now, frame, out):
    """Somebody opens a sequence: whatever we followed before is over."""
    if station.pending:
        disprove(station, NO_PROOF, out)
    adopt(station, params, frame, out)
    place = frame.pos
    if place >= KEPT:
        clear_round(station)
        place = 0
    rest_round(station, params)
    station.collided = 0
    station.tail = 0
    station.last_ok = 1
    station.joined = 0
    if station.pos == place:
        station.pos = NONE
    if frame.pos < KEPT:
        station.live[place] = QUIET
    if frame.more:
        station.live[place] = ACTIVE
        station.cur = place
    size = 1
    if LONE_WINDOWS <= frame.next < NEXT_NONE:
        size = window_of(params, frame.next)
    silence = silence_behind(params, frame.wide, frame.slots)
    station.apart = (now + silence) & MASK30
    station.joint = 1 if silence else 0
    station.fall = now
    enter_first(station, params, station.apart, size, 1, out)


def hear_data(station, params, now, frame, out):
    """A turn of somebody else: proof for the turn before it, and whose turn is next."""
    sender = frame.pos
    behind = frame.next
    if sender >= POSITIONS or behind == NEXT_NONE:
        return
    if station.pending:
        settle(station, params, now, frame, out)
    if station.mode == modes.LEAD:
        note_joined(station, 0)  # the next turn has begun: nobody used our window
    station.collided = 0
    station.tail = 0
    station.last_ok = 1
    station.slot = NONE
    count_turn(station, params, frame.count)
    note_turn(station, params, sender, frame.more)
    lone = behind >= LONE_WINDOWS
    opens = behind == sender or behind >= WINDOWS
    size = 1
    if WINDOWS <= behind < NEXT_NONE:
        size = window_of(params, behind)
    if station.pos != NONE and is_skipped(station, sender, behind):
        report(out, REPORT_SKIPPED, station.pos, 0)
        station.pos = NONE
    if lone:
        rest_round(station, params)
        station.joined = 0
        note_turn(station, params, sender, frame.more)
        if frame.more:
            station.cur = sender
        enter_first(station, params, now, size, 1, out)
    elif opens:
        station.turns = 0
        station.joined = 0
        station.cur = following(station, sender)
        enter_first(station, params, now, size, 0, out)
    else:
        station.live[behind] = ACTIVE
        enter_turn(station, params, now, behind, out)


def is_skipped(station, sender, behind):
    """1 if a turn says that our place is not ours: somebody else has it, or it has no turn."""
    if station.pos == sender:
        return True
    if station.live[station.pos] != ACTIVE:
        return False
    if behind >= LONE_WINDOWS:
        return True
    opens = behind == sender or behind >= WINDOWS
    return not opens and is_passed_over(sender, behind, station.pos)


def count_turn(station, params, packets):
    """Somebody else has had a turn."""
    station.turns = min(station.turns + 1, TURNS_COUNTED)
    if is_slow(params):
        note_flow(station, params, packets)
        if packets:
            earn(station, packets)


def note_turn(station, params, place, more):
    """The station in a place has sent; does it keep its turns?"""
    if more:
        station.live[place] = ACTIVE
    else:
        rest(station, params, place)


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
        size = window_of(params, station.next)
    alone = station.next >= LONE_WINDOWS
    if not station.live[station.pos]:
        station.pos = NONE
    if station.cd:
        report(out, REPORT_COLLISION, 0, 0)
        disprove(station, HEARD_TAIL, out)
        if alone:
            leave_sequence(station, params, now, join_after(params, station.used))
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
        kept = count_kept(station)
        size = window_of(params, code_for(params, kept + 1)) if kept else 1
        enter_window(station, params, now, size, 0, 0, 0, out)
    else:
        enter_turn(station, params, now, behind, out)


def silent_turn(station, params, now, out):
    """The station whose turn it is says nothing: it is gone."""
    station.last_ok = 0
    station.live[station.cur] = 0
    if station.pending and station.named == station.cur:
        disprove(station, NO_PROOF, out)
    enter_turn(station, params, now, following(station, station.cur), out)
