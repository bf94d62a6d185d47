"""Practical CSMA/CD-R, windows of somebody else: ask for a place in a minislot, read the report."""

from innervate.dialect.arith import MASK30, after
from innervate.dialect.rng import draw
from innervate.networks.radio.protocol import modes
from innervate.networks.radio.protocol.bounds import adopt
from innervate.networks.radio.protocol.constants import MINISLOTS, NO_PROOF, NONE, POSITIONS
from innervate.networks.radio.protocol.idle import end_sequence
from innervate.networks.radio.protocol.modes import (
    ACTIVE,
    QUIET,
    age_kept,
    arm,
    arm_act,
    count_kept,
    disprove,
    note_joined,
)
from innervate.networks.radio.protocol.reporter import bit
from innervate.networks.radio.protocol.station import send_crr
from innervate.networks.radio.protocol.times import (
    frame_from,
    guard,
    least_delay,
    minislot,
    most_delay,
    split_into,
)
from innervate.networks.radio.protocol.turn import enter_turn


def enter_first(station, params, now, window, ack, out):
    """A window that no report announced: kept places have their own minislots in it."""
    age_kept(station, params)
    kept = min(count_kept(station), window)
    station.slot = NONE
    if 0 <= station.pos < kept and station.live[station.pos] >= QUIET:
        station.slot = station.pos
    enter_window(station, params, now, window, window - kept, window - kept, ack, out)


def asks(station):
    """1 if we have a packet, and nothing on the air that waits for its proof."""
    return station.queued > 0 and station.pending == 0


def enter_window(station, params, now, window, fresh, span, ack, out):
    """A frame announced a window; if we want a place, take a minislot, else pulse if asked to.

    `span` is what to draw from for its last minislots; what is before them is for those that
    collided, who have chosen already.
    """
    station.mode = modes.WINDOW
    station.window = window
    station.ack = ack
    station.ref = now
    station.heard = 0
    station.act = 0
    if asks(station) and station.pos == NONE and span > 0 and station.slot == NONE:
        place = draw(station, span)
        if place < fresh:
            station.slot = window - fresh + place
    wait = guard(params, station.used)
    if station.slot != NONE:
        arm_act(station, now, wait + station.slot * minislot(params, station.used), out)
    elif ack:
        arm_act(station, now, wait + window * minislot(params, station.used), out)
    last = (window + ack - 1) * minislot(params, station.used)
    farthest = 2 * most_delay(params, station.used) - least_delay(params, station.used)
    arm(station, now, wait + params.ta_us + last + farthest + 1, out)


def use_slot(station, params, now, out):
    """Send our CR-R or pulse; deaf meanwhile, we only wait for the report.

    Never over a frame: its sender would take that for an answer to its own.
    """
    if station.cd and after(station.rise, station.ref):
        if ((now - station.rise) & MASK30) >= frame_from(params, station.used):
            return
    elif station.cd and station.joint:
        return  # it began as the opening ended
    if station.slot != NONE and not asks(station):
        station.slot = NONE
        if station.ack:
            behind = station.window * minislot(params, station.used)
            arm_act(station, station.ref, guard(params, station.used) + behind, out)
        return
    expect_report(station, params, out)
    station.mode = modes.SEND_SLOT
    send_crr(out)


def expect_report(station, params, out):
    """Set the second deadline: a report, if there is one, has begun by then."""
    station.heard = 2
    length = (station.window + station.ack) * minislot(params, station.used)
    length = length + 2 * params.ta_us + 2 * most_delay(params, station.used) + params.bit_us
    length = length + guard(params, station.used)
    arm(station, station.ref, length, out)


def pass_deadline(station, params, now, out):
    """Nobody was heard, so the turns go on; else a report must come, or they go on too.

    With a carrier at the second deadline the end of that decides (see carrier_went).
    """
    if station.heard == 1:
        expect_report(station, params, out)
    elif not station.cd:
        go_on(station, params, now, out)


def go_on(station, params, now, out):
    """The window has ended without a report."""
    note_joined(station, 0)
    if station.cur == NONE and station.pending == 0:
        end_sequence(station, params, now, out)
    else:
        enter_turn(station, params, now, station.cur, out)


def hear_report(station, params, now, frame, out):
    """Which minislots are turns now, and what follows."""
    if station.pending:
        disprove(station, NO_PROOF, out)
    adopt(station, params, frame, out)
    mine = station.slot
    station.slot = NONE
    parts = split_into(params)
    places = 0
    groups = 0
    for i in range(MINISLOTS):
        if bit(frame.good, i) and i < frame.kept:
            if i == station.pos and i != mine and station.live[i] >= QUIET:
                station.pos = NONE  # somebody else uses it
            station.live[i] = ACTIVE
        elif bit(frame.good, i):
            if frame.base + places < POSITIONS:
                place = frame.base + places
                station.live[place] = ACTIVE
                if place == station.pos:
                    station.pos = NONE
                if i == mine and station.mode == modes.WINDOW:
                    station.pos = place
            places = places + 1
        elif bit(frame.bad, i):
            if i == mine and station.mode == modes.WINDOW:
                station.pos = NONE  # a kept place of ours is somebody else's, too
            if i == mine and station.mode == modes.WINDOW and frame.split:
                station.slot = parts * groups + draw(station, parts)
            groups = groups + 1
    station.joined = station.joined + places
    if frame.window == 0:
        note_joined(station, 1)
    station.turns = 0
    station.last_ok = 0
    station.collided = 0
    station.cur = frame.pos
    if frame.pos >= POSITIONS:
        station.cur = NONE
    if frame.window:
        fresh = frame.window
        if frame.split:
            fresh = fresh - parts * groups
        enter_window(station, params, now, frame.window, fresh, frame.span, 0, out)
    else:
        enter_turn(station, params, now, station.cur, out)
