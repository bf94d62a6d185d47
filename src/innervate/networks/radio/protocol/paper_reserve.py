"""CSMA/CD-R as published, steps 5 and 6: CR-Rs are sent and counted until the window closes."""

from innervate.dialect.arith import MASK30
from innervate.networks.radio.protocol.constants import LAST, OTHER, OUTSIDER, TURNS_MOST
from innervate.networks.radio.protocol.paper_idle import (
    RESERVE,
    SEND_CRR,
    arm,
    arm_act,
    packet_us,
    take_role,
)
from innervate.networks.radio.protocol.paper_turns import enter_turns, garbled, go_on, turn_over
from innervate.networks.radio.protocol.station import send_crr

# What a burst of carrier was.
NOTHING = 0
REPORTS = 1
PACKET_ENDS = 2
NOISE = 3


def burst_begins(station, since, late):
    """A carrier since `since`; `late` if it was there when our own CR-R ended."""
    station.rise = since & MASK30
    station.mark = station.rise
    station.late = late
    station.crrs = 0
    station.clear = 0
    station.data = 0


def count_reports(station, params, noise_us):
    """T4: noise is CR-Rs that overlap. What is heard up to tau after our own ended before it."""
    if not params.overlap_rule:
        noise_us = min(noise_us, params.slot_us)
    elif station.late:
        noise_us = max(min(noise_us, noise_us + params.ta_us - params.dmax_us), 0)
    count = (noise_us + params.slot_us - 1) // params.slot_us
    station.crrs = min(station.crrs + count, TURNS_MOST)


def frame_ends(station, params, now, length_us):
    """A frame was received; what came before it in the same burst is noise."""
    count_reports(station, params, max(((now - station.mark) & MASK30) - length_us, 0))
    station.mark = now
    station.late = 0


def burst_ends(station, params, now, window):
    """What it was. T5: noise as long as a packet is one, garbled or collided.

    Outside an open window CR-Rs come within tau of each other: two slots are a packet cut short.
    """
    noise = (now - station.mark) & MASK30
    longest = packet_us(params)
    if station.late:
        longest = max(longest - params.slot_us - 2 * params.ta_us, 2 * params.slot_us)
    if station.data:
        return PACKET_ENDS
    if not window and not station.clear:
        longest = 2 * params.slot_us
    if noise >= longest:
        return NOISE
    count_reports(station, params, noise)
    if station.crrs:
        return REPORTS
    return NOTHING


def open_window(station, params, first_end, out):
    """The first CR-R ends at `first_end`; the turns begin T - Tc0 later."""
    station.mode = RESERVE
    station.closing = 0
    station.due = 0
    station.act = 0
    length = max(packet_us(params) - station.tc0, 0)
    if params.window_slots:
        length = params.window_slots * params.slot_us
    station.until = (first_end + length) & MASK30
    arm(station, station.until, out)


def report_first(station, params, now, out):
    """Send the first CR-R: as reporter, or in the place of one who does not."""
    station.reports = 0
    open_window(station, params, now + params.ta_us + params.slot_us + params.dmax_us, out)
    send_own(station, out)


def send_own(station, out):
    """[P 2.2 rule 4] "each node involved in a collision transmits a CR - R in T_cn"."""
    station.reports = min(station.reports + 1, TURNS_MOST)
    station.behind = 0
    station.sent = 1
    station.due = 0
    station.act = 0
    station.mode = SEND_CRR
    send_crr(out)


def heard_first(station, params, now, role, out):
    """The first CR-R has ended, and others with it if it was noise."""
    if role != OTHER:
        take_role(station, role, out)
    station.sent = 1 if role == LAST else 0
    station.reports = station.crrs
    station.behind = station.crrs if role == LAST else 0
    if role != OTHER:
        station.tc0 = 0
    open_window(station, params, now, out)
    if role == OTHER:
        arm_act(station, now + station.tc * params.dilate, out)


def try_crr(station):
    """Our moment for a CR-R has come; 1 if it can be sent. Rule S: else when the carrier ends."""
    station.act = 0
    if station.cd:
        station.due = 1
        return 0
    return 1


def sent_crr(station, out):
    """Our CR-R is out; the window may have closed meanwhile."""
    station.mode = RESERVE
    arm(station, station.until, out)


def window_over(station, params, now, out):
    """Begin the turns, unless there is a carrier: then when it ends."""
    if station.cd:
        station.closing = 1
        return
    enter_turns(station, params, out)
    go_on(station, params, now, now, out)


def reserve_burst(station, params, now, what, out):
    """Something was heard in the window: CR-Rs, or a turn, which ends it."""
    if what == PACKET_ENDS:
        enter_turns(station, params, out)
        turn_over(station, params, now, out)
    elif what == NOISE:
        enter_turns(station, params, out)
        garbled(station, params, now, out)
    else:
        station.reports = min(station.reports + station.crrs, TURNS_MOST)
        if station.sent:
            station.behind = min(station.behind + station.crrs, TURNS_MOST)
        if station.closing:
            window_over(station, params, now, out)
        elif station.due:
            send_own(station, out)


def follow(station, params, now, out):
    """Outside a resolution, a CR-R: follow it."""
    station.total = 0
    heard_first(station, params, now, OUTSIDER, out)
