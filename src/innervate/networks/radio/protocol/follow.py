"""Practical CSMA/CD-R: what the frames of others, or their absence, mean for the round."""

from innervate.dialect.arith import MASK30, after
from innervate.dialect.outbox import report
from innervate.networks.radio.protocol.constants import (
    ALONE,
    HEARD_TAIL,
    NO_PROOF,
    NONE,
    POSITIONS,
    REPORT_BOUNDS,
    REPORT_COLLISION,
    REPORT_SKIPPED,
)
from innervate.networks.radio.protocol.idle import rest
from innervate.networks.radio.protocol.modes import clear_round, disprove, following, is_over, prove
from innervate.networks.radio.protocol.reporter import lead
from innervate.networks.radio.protocol.turn import enter_turn
from innervate.networks.radio.protocol.window import enter_window

TURNS_COUNTED = 65535


def hear_open(station, params, now, frame, out):
    """Somebody opens a sequence: whatever we followed before is over."""
    if station.pending:
        disprove(station, NO_PROOF, out)
    clear_round(station)
    station.collided = 0
    station.tail = 0
    station.last_ok = 1
    station.slot = NONE
    if frame.more:
        station.live[0] = 1
        station.cur = 0
    enter_window(station, params, now, 1, 1, 1, 1, out)


def hear_data(station, params, now, frame, out):
    """A turn of somebody else: proof for the turn before it, and whose turn is next."""
    sender = frame.pos
    behind = frame.next
    if sender >= POSITIONS or (behind >= POSITIONS and behind != ALONE):
        return
    if station.pending:
        settle(station, params, now, frame, out)
    station.collided = 0
    station.tail = 0
    station.last_ok = 1
    station.slot = NONE
    station.turns = min(station.turns + 1, TURNS_COUNTED)
    station.live[sender] = frame.more
    lone = behind == ALONE
    opens = behind == sender
    if station.pos != NONE:
        skipped = lone or station.pos == sender
        if not skipped and not opens:
            skipped = is_over(sender, behind, station.pos)
        if skipped:
            report(out, REPORT_SKIPPED, station.pos, 0)
            station.pos = NONE
    if lone:
        clear_round(station)
        station.live[sender] = frame.more
        if frame.more:
            station.cur = sender
        enter_window(station, params, now, 1, 1, 1, 1, out)
    elif opens:
        station.turns = 0
        station.cur = following(station, sender)
        enter_window(station, params, now, 1, 1, 1, 0, out)
    else:
        station.live[behind] = 1
        enter_turn(station, params, now, behind, out)


def settle(station, params, now, frame, out):
    """Our packets are delivered iff the station we named says so at its first chance."""
    start = (now - frame.slots * params.slot_us) & MASK30
    trip = (start - station.end - params.ta_us) & MASK30
    if frame.ok and frame.pos == station.named and after(station.until, start):
        if station.next == frame.pos and (
            trip + 1 < 2 * params.dmin_us or trip > 2 * params.dmax_us
        ):
            report(out, REPORT_BOUNDS, trip // 2, 2)
        prove(station, out)
    else:
        disprove(station, NO_PROOF, out)


def sent_data(station, params, now, out):
    """Our turn is over and the radio listens again."""
    opens = station.next == ALONE or station.next == station.pos
    ack = 1 if station.next == ALONE else 0
    if not station.live[station.pos]:
        station.pos = NONE
    if station.cd:
        report(out, REPORT_COLLISION, 0, 0)
        disprove(station, HEARD_TAIL, out)
        if station.next == ALONE:
            rest(station, now, params.join_us)
        else:
            enter_turn(station, params, now, station.cur, out)
    elif opens:
        station.turns = 0
        station.opener = 0
        station.rest = 0
        station.span = 1
        station.split = 0
        lead(station, params, now, 1, ack, out)
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
