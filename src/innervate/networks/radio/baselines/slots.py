"""Baselines with a common clock that send by chance or in turn.

Slotted ALOHA (Roberts 1975), slotted nonpersistent and p-persistent CSMA (Kleinrock and Tobagi
1975), TDMA. A slot of ALOHA and TDMA holds a packet; one of CSMA is long enough to hear a carrier.
Nonpersistent: senses the channel in a slot drawn beforehand. p-persistent: waits for an idle
channel, then sends in each slot with probability p. A packet that finds an empty queue is tried in
the next slot (p-persistent: by chance); after that, ALOHA and nonpersistent try with probability p.
"""

from innervate.dialect.arith import MASK30
from innervate.dialect.outbox import set_timer
from innervate.dialect.rng import draw
from innervate.networks.radio.baselines.common import (
    LISTEN,
    LONGEST_US,
    arm,
    arrived,
    collided,
    transmit,
)
from innervate.networks.radio.protocol.constants import ACT
from innervate.networks.radio.scenario.baselines import NONPERSISTENT, ONE_Q15, P_PERSISTENT
from innervate.networks.radio.scenario.baselines import TDMA as TDMA_MAC

COINS = 1024  # thrown at a time; then a timer, and more


def set_clock(station, now, item, out):
    """The driver says which slot this is, and since when."""
    station.mark = (now - item.ago) & MASK30
    station.step = item.handle
    keep_clock(station, now, out)


def keep_clock(station, now, out):
    """Look at the clock again before its readings wrap."""
    set_timer(out, ACT, (now + LONGEST_US) & MASK30)


def sync(station, params, now):
    """Bring `mark` and `step` to the slot that it is."""
    gone = ((now - station.mark) & MASK30) // params.period_us
    station.mark = (station.mark + gone * params.period_us) & MASK30
    station.step = (station.step + gone) % params.stations


def boundary(station, params, now):
    """The beginning of a slot: now, if one begins, or the next."""
    sync(station, params, now)
    if station.mark == now:
        return now
    return station.mark + params.period_us


def offer(station, params, now, out):
    """The first packet of an empty queue."""
    if station.mode != LISTEN:
        return
    if params.mac == TDMA_MAC:
        wait_turn(station, params, boundary(station, params, now), out)
    elif params.mac != P_PERSISTENT:
        station.attempt = 1
        arm(station, boundary(station, params, now), out)
    elif not station.cd:
        throw(station, params, boundary(station, params, now), out)


def wait_turn(station, params, first, out):
    """TDMA: wait for our slot; `first` is the beginning of the first that may be it."""
    ahead = ((first - station.mark) & MASK30) // params.period_us
    steps = (station.number - station.step - ahead) % params.stations
    steps = min(steps, LONGEST_US // params.period_us - 1)
    arm(station, first + steps * params.period_us, out)


def throw(station, params, first, out):
    """Draw in which slot to send: in each, from the one that begins at `first`, by chance p."""
    most = min(COINS, LONGEST_US // params.period_us - 1)
    station.attempt = 0
    ahead = 0
    while ahead < most and not station.attempt:
        if draw(station, ONE_Q15) < params.p_q15:
            station.attempt = 1
        else:
            ahead = ahead + 1
    arm(station, first + ahead * params.period_us, out)


def fire(station, params, now, out):
    """A slot begins that we have waited for."""
    if station.mode != LISTEN or station.queued == 0:
        return
    if params.mac == TDMA_MAC:
        sync(station, params, now)
        if station.step == station.number:
            transmit(station, params, now, out)
        else:
            wait_turn(station, params, now, out)
    elif not station.attempt:
        throw(station, params, now, out)
    elif params.mac == NONPERSISTENT and station.cd:
        throw(station, params, now + params.period_us, out)
    else:
        transmit(station, params, now, out)


def rise(station, params):
    """A carrier came: p-persistent stations throw no dice meanwhile."""
    if params.mac == P_PERSISTENT and station.mode == LISTEN:
        station.armed = 0


def fall(station, params, now, out):
    """The carrier went: p-persistent stations throw dice from the next slot on."""
    if params.mac == P_PERSISTENT and station.mode == LISTEN and station.queued:
        throw(station, params, boundary(station, params, now), out)


def told(station, params, now, received, out):
    """What became of our packet."""
    station.mode = LISTEN
    if received:
        arrived(station, out)
    else:
        collided(station, out)
    if station.queued == 0:
        return
    first = boundary(station, params, now)
    if params.mac == TDMA_MAC:
        wait_turn(station, params, first, out)
    elif params.mac != P_PERSISTENT or not station.cd:
        throw(station, params, first, out)
