"""A bench for one station of CSMA/CD-R as published: the test is its channel and its clock."""

from innervate.dialect import plain
from innervate.dialect.access import PACKET
from innervate.dialect.outbox import DELIVER, REPORT, SEND, SET_TIMER
from innervate.networks.radio.protocol import fields as radio_fields
from innervate.networks.radio.protocol import paper as radio_paper
from innervate.networks.radio.protocol.constants import CRR, DATA
from innervate.networks.radio.scenario.plan import parameters

TAU, SLOT, BIT, T = 104, 208, 26, 25
LONG = T * SLOT
G, D, F = 2 * TAU + BIT, 4 * TAU, 2 * TAU + BIT

Frame = plain.make("Frame", radio_fields.FRAME)
Packet = plain.make("Packet", radio_fields.PACKET)
Station = plain.make("Station", radio_fields.STATION, radio_fields.PAPER)
Params = plain.make("Params", radio_fields.PARAMS)


class Bench:
    """One station; time goes on only by `at`, the radio's deafness is this bench's business."""

    def __init__(self, cause=0, start=(1 << 30) - 3000, ta=0, **more):
        self.params = Params()
        for name, value in parameters(T, ta, (TAU, TAU), **more).items():
            setattr(self.params, name, value)
        self.station = Station()
        self.station.number, self.station.rng, self.station.choice = 7, 1, 0
        self.zero, self.time = start, 0
        self.due = {}
        self.sent, self.reports, self.handed = [], [], []
        self.call(radio_paper.on_start, cause)

    @property
    def now(self):
        return (self.zero + self.time) & ((1 << 30) - 1)

    def call(self, handler, *args):
        out = plain.Outbox(Frame, 16)
        handler(self.station, self.params, self.now, *args, out)
        for act, frame in zip(out.action[: out.count[0]], out.frame, strict=False):
            if act.kind == SEND:
                self.sent.append((self.time, frame.kind))
            elif act.kind == SET_TIMER:
                ahead = (act.b - self.now) & ((1 << 30) - 1)
                self.due[act.a] = self.time + (ahead if ahead < 1 << 29 else 0)
            elif act.kind == REPORT:
                self.reports.append((act.a, act.b, act.c))
            elif act.kind == DELIVER:
                self.handed.append(frame.handle)
        self.check()

    def check(self):
        for name, length, low, high, *_ in radio_fields.STATION + radio_fields.PAPER:
            value = getattr(self.station, name)
            assert all(low <= v <= high for v in (value if length else [value])), name

    def at(self, time):
        """Let time go on; timers that are due before, or then, fire."""
        while self.due and min(self.due.values()) <= time:
            timer = min(self.due, key=lambda t: (self.due[t], t))
            self.time = max(self.time, self.due.pop(timer))
            self.call(radio_paper.on_timer, timer)
        self.time = time
        return self

    def carrier(self, time, cd, voc=None):
        """The carrier changes; timers of the same moment come after that."""
        self.at(time - 1)
        self.time = time
        self.call(radio_paper.on_carrier, cd, cd if voc is None else voc)
        return self.at(time)

    def offer(self, kind=PACKET, handle=1):
        packet = Packet()
        packet.slots, packet.handle = T, handle
        self.call(radio_paper.on_input, kind, packet)
        return self

    def frame(self, kind):
        """A frame ends now that was alone on the channel; its carrier's end is another call."""
        frame = Frame()
        frame.kind, frame.source, frame.handle = kind, 3, 99
        frame.slots = 1 if kind == CRR else T
        self.call(radio_paper.on_frame, 0, frame)
        return self

    def hear(self, start, kind):
        """A frame with silence before and behind it."""
        end = start + (SLOT if kind == CRR else LONG)
        self.carrier(start, 1).at(end - 1)
        self.time = end
        self.frame(kind).call(radio_paper.on_carrier, 0, 0)
        return self.at(end)

    def noise(self, start, end):
        return self.carrier(start, 1, 0).carrier(end, 0)

    def told(self, code):
        return [(a, b) for what, a, b in self.reports if what == code]


def after_own_packet(**more):
    """A station whose packet of 0..T has just ended; it listens again when told to."""
    bench = Bench(**more)
    bench.offer()
    assert bench.sent == [(0, DATA)]
    return bench


def collided(tail, voc=1, **more):
    """... and hears others until `tail` us later."""
    return after_own_packet(**more).carrier(LONG, 1, voc).carrier(LONG + tail, 0)
