"""A few mesh nodes on perfect links, in plain Python: frames take a fixed time, timers fire."""

import heapq

from innervate.dialect import plain
from innervate.dialect.arith import MASK30
from innervate.dialect.outbox import DELIVER, REPORT, SEND, SET_TIMER, URGENT
from innervate.dialect.rng import seeded
from innervate.kernel.records import Words
from innervate.networks.mesh.protocol import fields as fields
from innervate.networks.mesh.protocol import node as mesh
from innervate.networks.mesh.protocol.constants import ACK, LIST, MESSAGE, SENT
from innervate.networks.mesh.protocol.frames import copy_frame

WIDTH = 32
FRAME_US = 1000
ACK_US = 500

DEFAULTS = dict(
    nodes=0, row=fields.row_bytes(WIDTH), places=32, width=WIDTH, mtu=127, mode=0, discovery=3,
    failover=3, recent=0, avoid_origin=0, on_demand=0, retry=1, reliable=1, activation=0, told=0,
    transmissions=3, ack_us=4000, hop_acks=1, ack_adapt=0, hop_frames=0, gather=0, queue=8, kept=8,
    suspect_us=10_000_000, min_rssi=-93, faint=-92, poor=-94, jitter_us=100_000, copies=2,
    flood_us=12_500, listen_us=300_000, spread_us=400_000, collect_us=1_500_000,
    tick_us=1_000_000, period=10, period_max=60, dead=25, dead_step=5,
    guard_us=0, standby=0, asks=0, jobs=4, job_us=500_000,
    job_tries=3, e2e_us=250_000, e2e_adapt=0, e2e_tries=5, forget=30,
    monitor=254, watch=0, lost=3, flood=1, instances=3, clear_margin=20,
    predict_ms=500, unit_cm=1, points=0, fence=0,
)  # fmt: skip

DECLARED = fields.node(WIDTH)
Node = plain.make("Node", fields.node(WIDTH, fields.PLACES_MAX, fields.PLACES_MAX))
Gate = plain.make("Gate", fields.gate(WIDTH))
Frame = plain.make("Frame", fields.FRAME)
Item = plain.make("Item", fields.ITEM)
Params = plain.make("Params", fields.PARAMS)


class Bench:
    """Nodes joined by `links` [(a, b), ...]; `dead` ones hear and say nothing."""

    def __init__(self, count, links, gateway=0, standbys=(), robots=(), **settings):
        self.params = Params()
        if settings.get("discovery", LIST) != LIST:  # as in scenarios that say nothing of it
            settings.setdefault("faint", -128)
        for name, value in {**DEFAULTS, "nodes": count, **settings}.items():
            setattr(self.params, name, value)
        self.nodes = [Node() for _ in range(count)]
        self.words = [Words(node, DECLARED) for node in self.nodes]
        self.gates = [None] * count
        self.neighbours = {i: set() for i in range(count)}
        for a, b in links:
            self.neighbours[a].add(b)
            self.neighbours[b].add(a)
        self.dead = set()
        self.lost = lambda frame, to: False
        self.now = 0
        self.queue = []
        self.order = 0
        self.due = {}
        self.out = plain.Outbox(Frame, 32 + 4 * self.params.queue)
        self.reports, self.delivered, self.sent = [], [], []
        for i, node in enumerate(self.nodes):
            node.number, node.rng, node.choice = i, seeded(7919 * (i + 1)), -1
            node.rank = 0 if i == gateway else -1
            node.robot = int(i in robots)
            if i in standbys:
                node.rank = 1 + standbys.index(i)
            if node.rank >= 0:
                self.gates[i] = Gate()
        for i in range(count):
            if i != gateway:
                self.start(i)
        self.start(gateway)

    def start(self, i, cause=0):
        self.dead.discard(i)
        params, now = self.params_of(i), self.now & MASK30
        mesh.on_start(self.nodes[i], self.gates[i], params, now, cause, self.out)
        self.drain(i)

    def params_of(self, _i):
        """Parameters of a node: those of all."""
        return self.params

    def push(self, at, what):
        self.order += 1
        heapq.heappush(self.queue, (at, self.order, what))

    def drain(self, i):
        out = self.out
        assert not out.overflow[0], "the outbox overflowed"
        self.check(i)
        for k in range(out.count[0]):
            act = out.action[k]
            if act.kind == SEND:
                frame = Frame()
                copy_frame(frame, out.frame[k])
                self.sent.append((self.now, i, frame))
                took = ACK_US if act.c & URGENT else FRAME_US
                for to in sorted(self.neighbours[i]):
                    if not self.lost(frame, to):
                        self.push(self.now + took, ("frame", to, self.heard(i, to, frame)))
                if self.params.told and not act.c & URGENT:
                    self.push(self.now + took, ("sent", i, 0))
            elif act.kind == SET_TIMER:
                at = self.now + ((act.b - self.now) & MASK30)
                self.due[i, act.a] = at
                self.push(at, ("timer", i, act.a))
            elif act.kind == REPORT:
                self.reports.append((self.now, i, act.a, act.b, act.c))
            elif act.kind == DELIVER:
                frame = Frame()
                copy_frame(frame, out.frame[k])
                self.delivered.append((self.now, i, frame))
        out.count[0] = 0

    def heard(self, i, to, frame):
        """The frame as it is received; an ack tells how loud the frame was that it is for."""
        copy = Frame()
        copy_frame(copy, frame)
        if frame.kind != ACK:
            copy.rssi = self.rssi_of(i, to)
        return copy

    def rssi_of(self, i, to):
        return -60

    def check(self, i):
        """Every field in its range."""
        if self.words[i].are_declared():
            return
        for name, length, low, high, *_ in DECLARED:
            value = getattr(self.nodes[i], name)
            for item in value if length else (value,):
                assert low <= item <= high, f"node {i}: {name} = {item}"

    def run(self, until):
        """Up to a time in us."""
        while self.queue and self.queue[0][0] < until:
            at, _, (kind, i, what) = heapq.heappop(self.queue)
            self.now = at
            if i in self.dead:
                continue
            node, gate, now = self.nodes[i], self.gates[i], self.now & MASK30
            if kind == "frame":
                mesh.on_frame(node, gate, self.params_of(i), now, 0, what, self.out)
            elif kind == "sent":
                item = Item()
                item.ok = 1
                mesh.on_input(node, gate, self.params_of(i), now, SENT, item, self.out)
            elif self.due.get((i, what)) == at:
                del self.due[i, what]
                mesh.on_timer(node, gate, self.params_of(i), now, what, self.out)
            elif kind == "timer":
                continue
            self.drain(i)
        self.now = until

    def send(self, i, dest, text=b"hello", flags=2, handle=0):
        item = Item()
        item.dest, item.flags, item.handle, item.length = dest, flags, handle, len(text)
        item.body[: len(text)] = list(text)
        now = self.now & MASK30
        mesh.on_input(self.nodes[i], self.gates[i], self.params_of(i), now, MESSAGE, item, self.out)
        self.drain(i)

    def of(self, code):
        return [row for row in self.reports if row[2] == code]
