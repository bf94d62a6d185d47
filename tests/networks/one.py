"""One node of a network over a field, by itself: its handlers called, what they ask for kept."""

from types import SimpleNamespace

from innervate.dialect import plain
from innervate.dialect.arith import MASK30
from innervate.dialect.outbox import DELIVER, REPORT, SEND, SET_TIMER
from innervate.dialect.rng import seeded


class One:
    """A node; `now` is its clock, us. Frames that it sends are namespaces with `urgent` besides."""

    def __init__(self, network, number, **params):
        self.do, self.fields = network.protocol, network.fields
        self.params = plain.make("Params", self.fields.PARAMS)()
        for name, value in (self.fields.DEFAULTS | params).items():
            setattr(self.params, name, value)
        self.node = plain.make("Node", self.fields.STATE)()
        self.node.number, self.node.rng, self.node.choice = number, seeded(77 * (number + 1)), -1
        self.frame_class = plain.make("Frame", self.fields.FRAME)
        self.out = plain.Outbox(self.frame_class, self.do.OUTBOX)
        self.now = 1_000_000
        self.timers, self.sent, self.delivered, self.reports = {}, [], [], []
        self.start()

    def start(self, cause=0):
        self.timers.clear()
        return self._call(self.do.on_start, cause)

    def hear(self, **values):
        return self._call(self.do.on_frame, 0, self._frame(values))

    def give(self, kind, **item):
        return self._call(self.do.on_input, kind, self._frame(item))

    def told(self, ok=1):
        return self._call(self.do.on_sent, ok)

    def fire(self, timer):
        """Let time pass until a timer fires."""
        self.now = self.timers.pop(timer)
        return self._call(self.do.on_timer, timer)

    def left(self, timer):
        """How long a timer has still to go, us."""
        return (self.timers[timer] - self.now) & MASK30

    def _frame(self, values):
        frame = self.frame_class()
        for name, value in values.items():
            setattr(frame, name, value)
        return frame

    def _call(self, handler, *given):
        """What a handler sends."""
        begun = len(self.sent)
        handler(self.node, self.params, self.now, *given, self.out)
        assert self.out.overflow[0] == 0
        for act, frame in zip(self.out.action[: self.out.count[0]], self.out.frame, strict=False):
            kept = SimpleNamespace(
                urgent=act.c,
                **{name: list(value) if length else value
                   for name, length, *_ in self.fields.FRAME
                   for value in [getattr(frame, name)]},
            )  # fmt: skip
            if act.kind == SEND:
                self.sent.append(kept)
            elif act.kind == DELIVER:
                self.delivered.append(kept)
            elif act.kind == SET_TIMER:
                self.timers[act.a] = act.b
            elif act.kind == REPORT:
                self.reports.append((act.a, act.b, act.c))
        self.out.count[0] = 0
        self._check()
        return self.sent[begun:]

    def _check(self):
        for name, length, low, high, *_ in self.fields.STATE:
            value = getattr(self.node, name)
            assert all(low <= one <= high for one in (value if length else [value])), name
