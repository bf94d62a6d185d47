"""One node of Babel on a bench: it is told what comes, and says what it does."""

from innervate.dialect import plain
from innervate.dialect.outbox import REPORT, SEND, SET_TIMER
from innervate.networks.babel.protocol import fields
from innervate.networks.babel.protocol import node as protocol
from innervate.networks.babel.protocol.constants import (
    HELLO,
    INFINITY,
    ROUTE_REQUEST,
    SEQNO_REQUEST,
    TICK,
    UPDATE,
)
from innervate.networks.babel.protocol.routes import metric_over

C = fields.DEFAULTS["nominal"]
HELLO_US = fields.DEFAULTS["hello_us"]
UPDATE_US = HELLO_US * fields.DEFAULTS["update_hellos"]


class Bench:
    """A node, switched on at 0, whose neighbours are called 10 and the port."""

    def __init__(self, number=1, **settings):
        self.node = plain.make("Node", fields.STATE)()
        self.params = plain.make("Params", fields.PARAMS)()
        for name, value in {**fields.DEFAULTS, **settings}.items():
            setattr(self.params, name, value)
        self.frame = plain.make("Frame", fields.FRAME)
        self.out = plain.Outbox(self.frame, protocol.OUTBOX)
        self.node.number, self.now = number, 0
        self.numbers = {}  # of the next Hello of each port's neighbour
        self.call(protocol.on_start, 0)

    def call(self, handler, *what):
        """What a handler does: [(port, frame)] sent; timers and reports are kept."""
        self.out.count[0] = 0
        handler(self.node, self.params, self.now, *what, self.out)
        assert not self.out.overflow[0]
        sent, self.timers, self.reports = [], {}, []
        for place in range(self.out.count[0]):
            act = self.out.action[place]
            if act.kind == SEND:
                copy = self.frame()
                for name, *_ in fields.FRAME:
                    setattr(copy, name, getattr(self.out.frame[place], name))
                sent.append((act.a, copy))
            elif act.kind == SET_TIMER:
                self.timers[act.a] = act.b
            elif act.kind == REPORT:
                self.reports.append((act.a, act.b, act.c))
        return sent

    def comes(self, port, kind, **filled):
        """A frame of the neighbour on a port."""
        frame = self.frame()
        for name, value in {"kind": kind, "source": 10 + port, **filled}.items():
            setattr(frame, name, value)
        return self.call(protocol.on_frame, port, frame)

    def hello(self, port, skip=0, rxcost=None, **filled):
        """The neighbour's next Hello, after so many that are lost; its IHU says C or `rxcost`."""
        rxcost = self.params.nominal if rxcost is None else rxcost
        number = self.numbers[port] = self.numbers.get(port, 0) + 1 + skip
        known = {"hello_no": number & 0xFFFF, "hello": HELLO_US // 100, "rxcost": rxcost}
        return self.comes(port, HELLO, **known | filled)

    def up(self, *ports):
        """Links that are up."""
        for port in ports:
            for _ in range(3):
                self.hello(port)
        return self

    def update(self, port, seq, metric):
        """An update of the neighbour."""
        return self.comes(port, UPDATE, seq=seq, metric=metric, update=UPDATE_US // 100)

    def request(self, port, seq, hops=64):
        """A seqno request of the neighbour."""
        return self.comes(port, SEQNO_REQUEST, seq=seq, hops=hops)

    def timer(self, timer, after_us=0):
        """A timer is due, so much later."""
        self.now += after_us
        return self.call(protocol.on_timer, timer)

    def tick(self):
        """Our next Hello."""
        return self.timer(TICK, HELLO_US)

    def advertise(self):
        """Hellos until our distance is told; all that is sent."""
        return [sent for _ in range(self.params.update_hellos) for sent in self.tick()]

    @property
    def fd(self):
        """The feasibility distance, None without one."""
        return (self.node.fd_seq, self.node.fd_metric) if self.node.fd_known else None

    def metric(self, port):
        """Of a port's route; None if it is infinite."""
        found = metric_over(self.node, port)
        return None if found == INFINITY else found


def updates(sent):
    """{port: (seqno, metric)} of all updates in what was sent."""
    return {port: (f.seq, f.metric) for port, f in sent
            if f.kind == UPDATE or (f.kind == HELLO and f.has_update)}  # fmt: skip


def requests(sent):
    """{port: (seqno, hops)} of all seqno requests in what was sent."""
    return {port: (f.seq, f.hops) for port, f in sent if f.kind == SEQNO_REQUEST}


def asked_for_routes(sent):
    """Ports on which a route request was sent."""
    return [port for port, f in sent if f.kind == ROUTE_REQUEST]


def routed(*ports, seq=5, metric=C, **settings):
    """A node with a route over each of these ports."""
    bench = Bench(**settings).up(*ports)
    for port in ports:
        bench.update(port, seq, metric)
    return bench
