"""Baselines in which the right to send is handed on: a token ring, and polling by station 0.

Token ring: who holds the token sends up to `per_turn` packets and hands it on, in the same
transmission, by the number of the next station: two slots. Who hears nothing behind that takes the
next one for dead and names the one after; who hears nothing for long makes a new token.
Polling: station 0 asks one after another by two slots; who has packets answers, who has none is
silent, so that the asker has to wait as long as an answer could take to begin.
Numbers are what CSMA/CD-R does without: `span` of a frame holds a station's number plus one.
"""

from innervate.dialect.arith import MASK30
from innervate.dialect.outbox import report
from innervate.networks.radio.baselines.common import LISTEN, SEND, arm
from innervate.networks.radio.protocol.constants import (
    DATA,
    NOT_HEARD,
    REPORT_COLLISION,
    REPORT_FAILED,
)
from innervate.networks.radio.protocol.station import blank, delivered, load_packets
from innervate.networks.radio.scenario.baselines import POLLING, TOKEN_RING, TOKEN_SLOTS


def silence(params):
    """Longer than the channel is silent while the right to send is somewhere, us."""
    return 3 * params.ta_us + 4 * params.dmax_us + TOKEN_SLOTS * params.slot_us


def begin(station, params, now, out):
    """Switch on: listen whether others are at work; the lowest number begins."""
    station.count = 0
    station.step = station.number
    wait_for_others(station, params, now, out)


def wait_for_others(station, params, now, out):
    """Take the right to send when nobody has had it for long."""
    station.counting = 0
    if params.mac == TOKEN_RING:
        arm(station, now + (2 + station.number) * silence(params), out)
    elif station.number == 0:
        arm(station, now + silence(params), out)


def follower(station, params, number):
    """The number behind one, round the circle, that is not our own."""
    found = (number + 1) % params.stations
    if found == station.number:
        found = (found + 1) % params.stations
    return found


def grant(station, params, now, number, most, out):
    """Send up to `most` packets, and behind them give the right to send to a station."""
    frame = blank(out)
    station.count = 0
    if station.queued and most:
        station.count = load_packets(station, frame, most)
    frame.kind = DATA
    frame.slots = frame.slots if station.count else 0
    if number >= 0:
        frame.slots = frame.slots + TOKEN_SLOTS
        frame.span = number + 1
    station.step = max(number, 0)
    station.armed = 0
    station.counting = 1
    station.end = (now + params.ta_us + frame.slots * params.slot_us) & MASK30
    station.mode = SEND


def take(station, params, now, out):
    """It is our turn: send what we have, and hand the turn on."""
    if params.mac == TOKEN_RING:
        grant(station, params, now, follower(station, params, station.number), params.per_turn, out)
    elif station.number == 0:
        follows = follower(station, params, station.step)
        most = params.per_turn if follows == 1 else 0  # once a round, as everybody
        grant(station, params, now, follows, most, out)
    elif station.queued:
        grant(station, params, now, -1, params.per_turn, out)


def heard(station, params, now, frame, out):
    """A frame names whose turn it is."""
    if frame.span == station.number + 1 and station.mode == LISTEN:
        take(station, params, now, out)


def ready(station, params, now, out):
    """Our radio listens again: does whom we named begin?"""
    station.mode = LISTEN
    if params.mac == POLLING and station.number:
        return
    begins = station.end + params.ta_us + 2 * params.dmax_us + params.bit_us
    if not station.cd:
        arm(station, begins, out)


def rise(station):
    """A carrier came: somebody uses the turn, stop counting silence."""
    if station.mode == LISTEN:
        station.armed = 0
        station.counting = 0


def fall(station, params, now, out):
    """It went; a frame in it that gave us the right to send has been handled already."""
    if station.mode != LISTEN:
        return
    if params.mac == POLLING and station.number == 0:
        take(station, params, now, out)
    else:
        wait_for_others(station, params, now, out)


def fire(station, params, now, out):
    """Silence: whom we named is gone or has nothing to send, or nobody has the right."""
    if station.mode != LISTEN:
        return
    if params.mac == TOKEN_RING and station.counting:
        follows = follower(station, params, station.step)
        if follows == follower(station, params, station.number):
            wait_for_others(station, params, now, out)  # nobody else is there
        else:
            grant(station, params, now, follows, 0, out)
    else:
        take(station, params, now, out)


def told(station, received, out):
    """What became of our packets; those of one transmission share it."""
    count = station.count
    station.count = 0
    if count == 0:
        return
    if received:
        delivered(station, count, out)
    else:
        report(out, REPORT_COLLISION, 0, 0)
        report(out, REPORT_FAILED, station.handle[station.head], NOT_HEARD)
