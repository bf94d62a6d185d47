"""Practical CSMA/CD-R: delays that the configured bounds exclude, and what a station does then.

It says so, believes in wider bounds from then on, and tells the others in its openings and reports.
"""

from innervate.dialect.outbox import report
from innervate.networks.radio.protocol.constants import REPORT_BOUNDS, REPORT_WIDER
from innervate.networks.radio.protocol.times import most_delay, wider_for

# Which bound does not hold: b of REPORT_BOUNDS.
EARLY = 0  # a CR-R came before it could
LATE = 1  # ... later than it could
TRIP = 2  # a hand-over took too short or too long
BEHIND = 3  # an answer came behind the window
TOGETHER = 4  # CR-Rs of two minislots ran together


def notice(station, params, delay, which, out):
    """A delay of `delay` us lies outside what this sequence allows for: say so, believe in more.

    Perhaps we have done that already, and no more is needed.
    """
    report(out, REPORT_BOUNDS, delay, which)
    wide = wider_for(params, station.used, delay)
    if wide > station.wide:
        station.wide = wide
        report(out, REPORT_WIDER, most_delay(params, station.wide), 0)


def adopt(station, params, frame, out):
    """An opening or a report says what its sequence allows for: never believe in less."""
    station.used = frame.wide
    if frame.wide > station.wide:
        station.wide = frame.wide
        report(out, REPORT_WIDER, most_delay(params, station.wide), 1)
