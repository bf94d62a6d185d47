"""What all baselines do: arm a timer, send a packet, learn what became of it."""

from innervate.dialect.arith import MASK30
from innervate.dialect.outbox import report, set_timer
from innervate.networks.radio.protocol.constants import (
    DATA,
    MAIN,
    NOT_HEARD,
    REPORT_COLLISION,
    REPORT_FAILED,
)
from innervate.networks.radio.protocol.station import blank, delivered, load_packets

LISTEN = 0
SEND = 1  # deaf (D1: not), until the radio listens again
TOLD = 2  # has sent: what became of it?
STOPPED = 3  # D1: has broken off, until the radio listens again

LONGEST_US = (1 << 28) - 1


def arm(station, at, out):
    """Set the main timer to a moment; one in the past fires at once."""
    station.armed = 1
    set_timer(out, MAIN, at & MASK30)


def transmit(station, params, now, out):
    """Send the oldest packet after the turnaround: deaf until it has ended."""
    frame = blank(out)
    load_packets(station, frame, 1)
    frame.kind = DATA
    station.start = (now + params.ta_us) & MASK30
    station.end = (now + params.ta_us + frame.slots * params.slot_us) & MASK30
    station.armed = 0
    station.mode = SEND


def arrived(station, out):
    """Our oldest packet was received: it is delivered, and tries count anew."""
    station.tries = 0
    delivered(station, 1, out)


def collided(station, out):
    """It was not; it stays at the head of the queue."""
    station.tries = min(station.tries + 1, 16)
    report(out, REPORT_COLLISION, 0, 0)
    report(out, REPORT_FAILED, station.handle[station.head], NOT_HEARD)
