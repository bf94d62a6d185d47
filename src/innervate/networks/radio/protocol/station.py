"""What every station on a radio channel does: keep its packets, note the carrier, send a frame."""

from innervate.dialect.access import QUEUE, REPORT_DELIVERED, REPORT_LEFT
from innervate.dialect.outbox import deliver, report, send
from innervate.networks.radio.protocol.constants import CRR, REPORT_DROPPED


def copy_frame(to, frm):
    """Copy a frame, field by field."""
    to.kind = frm.kind
    to.slots = frm.slots
    to.source = frm.source
    to.handle = frm.handle
    to.count = frm.count
    to.pos = frm.pos
    to.next = frm.next
    to.more = frm.more
    to.ok = frm.ok
    to.base = frm.base
    to.window = frm.window
    to.span = frm.span
    to.split = frm.split
    to.kept = frm.kept
    to.wide = frm.wide
    for i in range(2):
        to.good[i] = frm.good[i]
        to.bad[i] = frm.bad[i]


def reset(station):
    """As on switching on: no packets, nothing heard. Number and generator are the driver's."""
    station.head = station.queued = station.leaving = station.cd = 0


def carrier_edge(station, cd):
    """What became of the carrier: 1 it came, -1 it went, 0 neither."""
    was = station.cd
    station.cd = cd
    return cd - was


def enqueue(station, packet, out):
    """Keep a packet until it is delivered; 1 if there was room."""
    if station.queued >= QUEUE:
        report(out, REPORT_DROPPED, packet.handle, 0)
        return 0
    place = (station.head + station.queued) & (QUEUE - 1)
    station.size[place] = packet.slots
    station.handle[place] = packet.handle
    station.queued = station.queued + 1
    return 1


def delivered(station, count, out):
    """Forget the oldest packets: they arrived, as far as we can tell."""
    report(out, REPORT_DELIVERED, station.handle[station.head], count)
    station.head = (station.head + count) & (QUEUE - 1)
    station.queued = station.queued - count
    if station.leaving and station.queued == 0:
        report(out, REPORT_LEFT, 0, 0)


def leave(station, out):
    """Send what is queued, then no more."""
    station.leaving = 1
    if station.queued == 0:
        report(out, REPORT_LEFT, 0, 0)


def blank(out):
    """A frame to fill, sent at once: the radio is deaf from now until it listens again."""
    frame = out.frame[send(out, 0, 0, 0)]
    frame.source = frame.handle = frame.count = 0
    frame.pos = frame.next = frame.more = frame.ok = 0
    frame.base = frame.window = frame.span = frame.split = frame.kept = frame.wide = 0
    for i in range(2):
        frame.good[i] = 0
        frame.bad[i] = 0
    return frame


def hand_up(frame, out):
    """Give our user what was received."""
    copy_frame(out.frame[deliver(out, frame.kind)], frame)


def send_crr(out):
    """Send one slot of carrier."""
    frame = blank(out)
    frame.kind = CRR
    frame.slots = 1


def load_packets(station, frame, most):
    """Put the oldest packets into a frame, at most `most`; how many they are."""
    count = min(station.queued, most)
    slots = 0
    for i in range(count):
        slots = slots + station.size[(station.head + i) & (QUEUE - 1)]
    frame.source = station.number
    frame.handle = station.handle[station.head]
    frame.count = count
    frame.slots = slots
    return count
