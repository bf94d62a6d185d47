"""A station of any baseline; params.mac says which. One stack, so that it compiles once.

CSMA/CD and DCF stand in contend.py, ALOHA, CSMA and TDMA in slots.py, splitting in tree.py, token
ring and polling in passing.py.
"""

from innervate.dialect.access import CLOCK, FORCE, LEAVE, PACKET, RESULT
from innervate.networks.radio.baselines import contend, passing, slots, tree
from innervate.networks.radio.baselines.common import LISTEN, SEND, STOPPED, TOLD
from innervate.networks.radio.protocol.constants import MAIN
from innervate.networks.radio.protocol.station import enqueue, hand_up, leave, reset
from innervate.networks.radio.scenario.baselines import DCF as LAST_WITHOUT_CLOCK
from innervate.networks.radio.scenario.baselines import TOKEN_RING
from innervate.networks.radio.scenario.baselines import TREE as TREE_MAC


def on_start(station, params, now, cause, out):
    """Switch on and listen, then as the protocol `params.mac` begins."""
    reset(station)
    station.mode = LISTEN
    station.armed = 0
    station.tries = 0
    if params.mac <= LAST_WITHOUT_CLOCK:
        contend.begin(station, params, now, out)
    elif params.mac >= TOKEN_RING:
        passing.begin(station, params, now, out)


def on_input(station, params, now, kind, item, out):
    """PACKET: one more to send. LEAVE. RESULT, CLOCK: what the simulator grants a baseline."""
    if kind == PACKET or kind == FORCE:
        if enqueue(station, item, out) and station.queued == 1:
            if params.mac <= LAST_WITHOUT_CLOCK:
                contend.offer(station, params, now, out)
            elif params.mac < TREE_MAC:
                slots.offer(station, params, now, out)
    elif kind == LEAVE:
        leave(station, out)
    elif kind == CLOCK:
        slots.set_clock(station, now, item, out)
        if params.mac == TREE_MAC:
            tree.begin(station, params, now, out)
    elif kind == RESULT and params.mac >= TOKEN_RING:
        passing.told(station, 1 if item.handle > 0 else 0, out)
    elif kind == RESULT and station.mode == TOLD:
        received = 1 if item.handle > 0 else 0
        if params.mac <= LAST_WITHOUT_CLOCK:
            contend.told(station, params, now, received, out)
        elif params.mac == TREE_MAC:
            tree.told(station, received, out)
        else:
            slots.told(station, params, now, received, out)


def on_frame(station, params, now, port, frame, out):
    """A packet was received whole; the carrier's end is reported after it."""
    station.decoded = 1
    station.heard = tree.READ
    if frame.count:
        hand_up(frame, out)
    if params.mac >= TOKEN_RING:
        passing.heard(station, params, now, frame, out)


def on_carrier(station, params, now, cd, voc, out):
    """The carrier came or went, or our radio listens again after sending."""
    came = cd and not station.cd
    went = station.cd and not cd
    station.cd = cd
    if came:
        station.rise = now
        station.decoded = 0
        station.heard = max(station.heard, tree.NOISE)
    if went:
        station.fall = now
    mode = station.mode
    if mode == STOPPED or (mode == SEND and not (came and params.full_duplex)):
        station.decoded = 0
        if params.mac <= LAST_WITHOUT_CLOCK:
            contend.ready(station, params, now, out)
        elif params.mac >= TOKEN_RING:
            passing.ready(station, params, now, out)
        else:
            tree.ready(station)
    elif params.mac <= LAST_WITHOUT_CLOCK:
        if came:
            contend.rise(station, params, now, out)
        elif went:
            contend.fall(station, params, now, out)
    elif params.mac >= TOKEN_RING:
        if came:
            passing.rise(station)
        elif went:
            passing.fall(station, params, now, out)
    elif params.mac != TREE_MAC:
        if came:
            slots.rise(station, params)
        elif went:
            slots.fall(station, params, now, out)


def on_timer(station, params, now, timer, out):
    """MAIN: a pause, a backoff or a slot. ACT: the clock."""
    if timer != MAIN:
        slots.sync(station, params, now)
        slots.keep_clock(station, now, out)
    elif station.armed:
        station.armed = 0
        if params.mac <= LAST_WITHOUT_CLOCK:
            contend.fire(station, params, now, out)
        elif params.mac >= TOKEN_RING:
            passing.fire(station, params, now, out)
        elif params.mac == TREE_MAC:
            tree.fire(station, params, now, out)
        else:
            slots.fire(station, params, now, out)
