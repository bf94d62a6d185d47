"""Baselines without a common clock: CSMA/CD after IEEE 802.3 in three variants, 802.11 DCF.

CSMA/CD [radio Q14]: who has a packet sends when the channel is idle and its backoff is over, which
runs on while others send; after k collisions it is drawn from 2^k values (k up to 10).
D1: on a cable, a collision is broken off as soon as it is heard. D2: it lasts as long as packets
do. D2P: who got through draws from 0 and 1 too.
DCF: the backoff stands still while others send; a busy time counts as one of its slots, as in
Bianchi 2000. The time of an answer is kept free behind a packet; the answer is the oracle's.
"""

from innervate.dialect.arith import MASK30, after
from innervate.dialect.outbox import STOP, report, send
from innervate.dialect.rng import draw
from innervate.networks.radio.baselines.common import (
    LISTEN,
    LONGEST_US,
    SEND,
    STOPPED,
    TOLD,
    arm,
    arrived,
    collided,
    transmit,
)
from innervate.networks.radio.protocol.constants import REPORT_STOPPED
from innervate.networks.radio.scenario.baselines import D2P
from innervate.networks.radio.scenario.baselines import DCF as DCF_MAC

DOUBLINGS_MAX = 10


def begin(station, params, now, out):
    """Switch on: listen as after a packet."""
    station.left = 0
    station.due = now
    pause(station, now, params.gap_us + params.answer_us, out)


def pause(station, since, gap, out):
    """The channel is idle since a moment; it may be used `gap` later."""
    station.since = since & MASK30
    station.open = 0
    station.counting = 0
    if after(station.since, station.due):
        station.due = station.since
    arm(station, since + gap, out)


def go(station, params, now, out):
    """The channel may be used: send, or wait for the end of the backoff."""
    if station.queued == 0:
        return
    if params.mac == DCF_MAC:
        if station.left == 0:
            transmit(station, params, now, out)
        else:
            station.counting = 1
            station.start = now
            arm(station, now + min(station.left * params.backoff_us, LONGEST_US), out)
    elif after(now, station.due):
        transmit(station, params, now, out)
    else:
        arm(station, station.due, out)


def offer(station, params, now, out):
    """The first packet of an empty queue."""
    if station.mode != LISTEN:
        return
    station.due = now
    if params.mac == DCF_MAC:
        station.left = 0 if station.open else draw(station, params.cw_min)
    if station.open:
        go(station, params, now, out)


def fire(station, params, now, out):
    """The pause or the backoff is over; D1: nobody disturbed our packet."""
    if station.mode == TOLD:
        told(station, params, now, 1, out)
    elif station.mode == LISTEN:
        if station.open:
            station.counting = 0
            station.left = 0
        station.open = 1
        go(station, params, now, out)


def rise(station, params, now, out):
    """A carrier came: whoever listens stops its wait; full duplex breaks off."""
    if station.mode == SEND:
        if params.full_duplex:
            break_off(station, params, out)
        return
    if station.mode != LISTEN:
        return
    station.armed = 0
    station.open = 0
    if station.counting:
        station.counting = 0
        passed = ((now - station.start) & MASK30) // params.backoff_us
        station.left = max(station.left - passed - 1, 0)


def fall(station, params, now, out):
    """The carrier went: wait for the gap, and for the answer behind a packet."""
    gap = params.gap_us
    if station.decoded:
        gap = gap + params.answer_us
    elif params.full_duplex:
        gap = 0  # what is left of a collision
    if station.mode == LISTEN:
        pause(station, now, gap, out)
    else:
        station.since = now


def ready(station, params, now, out):
    """Our radio listens again after sending."""
    station.since = (station.end + params.dmax_us) & MASK30
    if station.mode == STOPPED:
        station.mode = LISTEN
        if not station.cd:
            pause(station, now, 0, out)
        return
    station.mode = TOLD
    if not params.oracle:
        arm(station, station.since, out)


def break_off(station, params, out):
    """D1: somebody else sends too. A collision lasts a slot, then the backoff begins."""
    send(out, 0, 0, STOP)
    report(out, REPORT_STOPPED, 0, 0)
    collided(station, out)
    station.mode = STOPPED
    wait = backoff(station, params, 1 << min(station.tries, DOUBLINGS_MAX))
    station.due = (station.start + params.slot_us + wait) & MASK30


def backoff(station, params, values):
    """A random wait, us: a draw below `values` times the slot."""
    return min(draw(station, values) * params.backoff_us, LONGEST_US)


def told(station, params, now, received, out):
    """What became of our packet."""
    station.mode = LISTEN
    gap = params.gap_us
    if received:
        gap = gap + params.answer_us
        arrived(station, out)
    else:
        collided(station, out)
    since = station.since
    # When all sense the channel idle; if we are slower than that, now.
    idle = (since + gap) & MASK30
    if station.cd or after(now, idle):
        idle = now
    if params.mac == DCF_MAC:
        window = min(params.cw_min << min(station.tries, DOUBLINGS_MAX), params.cw_max)
        station.left = draw(station, max(window, params.cw_min))
    elif not received:
        wait = backoff(station, params, 1 << min(station.tries, DOUBLINGS_MAX))
        station.due = (idle + wait) & MASK30
    elif params.mac == D2P:
        station.due = (idle + backoff(station, params, 2)) & MASK30
    else:
        station.due = now
    if not station.cd:
        pause(station, since, gap, out)
