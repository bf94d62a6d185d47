"""Unslotted CSMA-CA: wait a random time, send if the channel is idle then [mesh 5].

The medium access below a router. The driver keeps the frame; SEND without a frame lets it go on
the air, REPORT_GAVE_UP returns it. Acknowledgements and retransmissions are the router's.
"""

from innervate.dialect.arith import MASK30
from innervate.dialect.outbox import URGENT, deliver, report, send, set_timer
from innervate.dialect.rng import draw

# Inputs.
PACKET = 1  # item: see csma_fields.ITEM

# Timers.
BACKOFF = 0
TIMERS = 1

# Reports.
REPORT_GAVE_UP = 1  # the frame found the channel busy a times


def on_start(station, params, now, cause, out):
    """The station is switched on: nothing waits."""
    station.waiting = 0
    station.carrier = 0


def on_frame(station, params, now, port, frame, out):
    """A frame was received: the router's."""
    deliver(out, 0)


def on_input(station, params, now, kind, item, out):
    """The router hands down a frame; only urgent ones may come while another waits."""
    if item.urgent:
        send(out, 0, 0, URGENT)
        return
    station.waiting = 1
    station.busy = 0
    station.exponent = min(params.exponent_min + item.attempt, params.exponent_max)
    back_off(station, params, now, out)


def on_timer(station, params, now, timer, out):
    """The backoff is over: the channel is idle, or the next one may be longer."""
    if not station.waiting:
        return
    if not station.carrier:
        station.waiting = 0
        send(out, 0, 0, 0)
        return
    station.busy += 1
    if station.busy >= params.busy_max:
        station.waiting = 0
        report(out, REPORT_GAVE_UP, station.busy, 0)
        return
    station.exponent = min(station.exponent + 1, params.exponent_max)
    back_off(station, params, now, out)


def on_carrier(station, params, now, cd, voc, out):
    """The channel has become busy or idle; drivers tell it before a timer at the latest."""
    station.carrier = cd


def back_off(station, params, now, out):
    """Look at the channel after a random number of units."""
    units = draw(station, 1 << station.exponent)
    set_timer(out, BACKOFF, (now + units * params.backoff_us) & MASK30)
