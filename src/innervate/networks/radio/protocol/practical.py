"""CSMA/CD-R for radios as they are: any number of stations, unequal delays, slow turnaround.

A reservation as in [radio 2.2] orders the turns, but three things differ from the paper:
who heads it listens through all of it (the *reporter*), the order comes from minislots instead
of transmission ends, and a packet counts as delivered only when somebody who received it says so.
Windows stand in reporter.py and window.py, turns in turn.py and
follow.py, openings in idle.py.
"""

from innervate.dialect.access import LEAVE, PACKET
from innervate.dialect.arith import MASK30, after
from innervate.networks.radio.protocol import modes
from innervate.networks.radio.protocol.constants import CRR, DATA, MAIN, OPEN, REPORT
from innervate.networks.radio.protocol.follow import (
    garbled_turn,
    hear_data,
    hear_open,
    sent_data,
    silent_turn,
)
from innervate.networks.radio.protocol.idle import (
    await_answers,
    began_together,
    began_with_ours,
    heard_noise,
    listen_first,
    lose_opening,
    note_noise,
    offered,
    open_now,
    retry,
    schedule,
)
from innervate.networks.radio.protocol.modes import arm
from innervate.networks.radio.protocol.reporter import (
    end_burst,
    end_of_window,
    hear_slot,
    opened,
    sent_report,
)
from innervate.networks.radio.protocol.station import carrier_edge, enqueue, hand_up, leave, reset
from innervate.networks.radio.protocol.times import frame_from, join_after, pass_slots, turn_timeout
from innervate.networks.radio.protocol.turn import enter_turn, send_turn
from innervate.networks.radio.protocol.window import hear_report, pass_deadline, use_slot


def on_start(station, params, now, cause, out):
    """Switch on and listen first: a sequence may be under way."""
    reset(station)
    station.wide = 0
    station.rise = now
    station.joint = 0
    note_noise(station, params)
    listen_first(station, params, now, cause, out)


def on_input(station, params, now, kind, item, out):
    """PACKET: one more to send. LEAVE: send what is there, then no more."""
    if kind == PACKET:
        if enqueue(station, item, out):
            offered(station, params, now, out)
    elif kind == LEAVE:
        leave(station, out)


def on_frame(station, params, now, port, frame, out):
    """A frame was received whole; the carrier's end is reported after it."""
    station.decoded = 1
    if frame.kind == CRR:
        hear_slot(station, params, now, out)
    elif frame.kind == DATA:
        if frame.count:
            hand_up(frame, out)
        hear_data(station, params, now, frame, out)
    elif frame.kind == OPEN:
        if frame.count:
            hand_up(frame, out)
        if began_together(station, params, (now - frame.slots * params.slot_us) & MASK30):
            station.decoded = 0
            if station.mode == modes.WINDOW:
                lose_opening(station)
        else:
            hear_open(station, params, now, frame, out)
    elif frame.kind == REPORT:
        hear_report(station, params, now, frame, out)


def on_carrier(station, params, now, cd, voc, out):
    """The carrier came or went, or our radio listens again after sending."""
    mode = station.mode
    if mode <= modes.CARRIERS:
        edge = carrier_edge(station, cd)
        if edge > 0:
            station.rise = now
            station.decoded = 0
            if after(now, station.apart):
                station.joint = 0
            carrier_came(station, params, now, out)
        elif edge < 0:
            if mode == modes.WINDOW and outlasts(station, params, now):
                lose_opening(station)
            station.fall = now
            carrier_went(station, params, now, (now - station.rise) & MASK30, out)
        return
    station.cd = cd
    station.decoded = 0
    station.joint = 0
    if cd:
        station.rise = now
    else:
        station.fall = now
    if mode == modes.SEND_OPEN:
        await_answers(station, params)
        if cd:
            retry(station, params, now, 1, out)
        else:
            opened(station, params, now, out)
    elif mode == modes.SEND_DATA:
        sent_data(station, params, now, out)
    elif mode == modes.SEND_REPORT:
        sent_report(station, params, now, out)
    elif mode == modes.SEND_SLOT:
        station.mode = modes.WINDOW


def outlasts(station, params, now):
    """True if the carrier went on behind the opening's end: another began just then."""
    if not station.joint or after(station.rise, station.ref):
        return False
    return after(now, (station.fall + params.slot_us) & MASK30)


def carrier_came(station, params, now, out):
    """Somebody sends: what silence would have meant does not hold."""
    mode = station.mode
    if mode == modes.IDLE:
        station.armed = 0
        station.tail = 0
    elif mode == modes.WINDOW and station.joint and not after(now, station.ref):
        lose_opening(station)
    elif mode == modes.LEAD and station.joint and began_with_ours(station, params, now):
        retry(station, params, now, 1, out)
    elif mode == modes.WINDOW or mode == modes.LEAD:
        station.heard = max(station.heard, 1)
    else:
        station.armed = 0


def carrier_went(station, params, now, length, out):
    """A burst is over; a frame in it was handled by on_frame."""
    mode = station.mode
    noise = not station.decoded
    if noise and length >= 2 * params.slot_us:
        note_noise(station, params)
    if mode == modes.IDLE:
        if noise:
            heard_noise(station, params, now, length, out)
        else:
            schedule(station, now, out)
    elif mode == modes.LEAD:
        end_burst(station, params, now, length, noise, out)
    elif mode == modes.WINDOW:
        if noise and length >= frame_from(params, station.used) + params.slot_us:
            station.mode = modes.LOST
            arm(station, now, join_after(params, station.used), out)
        elif not station.armed:
            enter_turn(station, params, now, station.cur, out)
    elif mode == modes.TURN:
        if noise and length >= pass_slots(params) * params.slot_us:
            garbled_turn(station, params, now, out)
        else:
            arm(station, now, turn_timeout(params, station.used), out)
    elif mode == modes.LOST:
        arm(station, now, join_after(params, station.used), out)


def on_timer(station, params, now, timer, out):
    """MAIN: a wait or deadline of the present mode. ACT: our minislot."""
    mode = station.mode
    if timer == MAIN:
        if not station.armed:
            return
        station.armed = 0
        if after(now, station.apart):
            station.joint = 0
        if mode == modes.IDLE:
            open_now(station, params, now, out)
        elif mode == modes.LEAD:
            end_of_window(station, params, now, out)
        elif mode == modes.WINDOW:
            pass_deadline(station, params, now, out)
        elif mode == modes.TURN:
            silent_turn(station, params, now, out)
        elif mode == modes.LOST:
            listen_first(station, params, now, 0, out)
    elif station.act:
        station.act = 0
        if mode == modes.WINDOW:
            use_slot(station, params, now, out)
        elif mode == modes.TURN and not station.cd and station.cur == station.pos:
            send_turn(station, params, now, out)
