"""A node on a board: its ports are UARTs; over a field see field.py.

The protocol (`node`) knows no clock and no wire; here its timers run on time.ticks_us, its frames
travel as on any serial line of innervate: COBS, a zero behind each frame, 8N1.
"""

import time

import node
import records
from outbox import Outbox

from innervate.wire import cobs

MASK30 = (1 << 30) - 1  # the protocol's clock; ticks_us wraps there, or at a multiple of it
HALF30 = 1 << 29
SEND = 1  # actions and flags: dialect/outbox.py
SET_TIMER = 2
DELIVER = 3
REPORT = 4
URGENT = 1
FLUSH = 2
QUEUE = 8  # frames that wait for a port
AT_ONCE = 64  # bytes read from a port in one go


class Port:
    """One end of a cable.

    `uart` has any(), readinto(buffer) and write(bytes), none of which waits; write returns how many
    bytes it took, or None for none.
    """

    def __init__(self, uart, size_max):
        self.uart = uart
        self.decoder = cobs.Decoder(size_max)
        self.waiting = []
        self.rest = None  # of the frame that is on the wire
        self.lost = 0  # frames for which there was no room

    def send(self, data, flags):
        """Queue a frame: urgent ones at the head, FLUSH drops what waits."""
        if flags & FLUSH:
            self.waiting.clear()
        if flags & URGENT:
            self.waiting.insert(0, data)
            if len(self.waiting) > QUEUE:
                self.waiting.pop()
                self.lost += 1
        elif len(self.waiting) < QUEUE:
            self.waiting.append(data)
        else:
            self.lost += 1

    def pump(self):
        """Hand the UART what it takes."""
        while self.rest or self.waiting:
            if not self.rest:
                self.rest = self.waiting.pop(0)
            taken = self.uart.write(self.rest) or 0
            self.rest = self.rest[taken:]
            if self.rest:
                return

    def receive(self, buffer):
        """Frames that have come in, as bytes."""
        if not self.uart.any():
            return ()
        count = self.uart.readinto(buffer)
        return self.decoder.feed(memoryview(buffer)[:count]) if count else ()


class Node:
    """A node.

    Args:
        number: who it is; every node has another.
        uarts: one for each port, in order of the protocol's; None for a free socket.
        seed: 1 to 1_072_496_638, different on every node, not near each other (rng.py).
        wire: with encode(frame), decode(data, frame), which returns 0 for a frame, and SIZE_MAX.
        timers: how many the protocol has.
        room: most actions of one call.
        ticks_us: the clock, us, wrapping at a multiple of 2^30.
        receive: called with every frame that the protocol delivers to its user; None = nobody.
    """

    def __init__(
        self, number, uarts, seed, wire, timers, room, ticks_us=time.ticks_us, receive=None
    ):
        self.wire = wire
        self.ports = [uart and Port(uart, wire.SIZE_MAX) for uart in uarts]
        self.receive = receive
        self.ticks_us = ticks_us
        self.number = number
        self.state = records.State()
        self.params = records.Params()
        self.out = Outbox(records.Frame, room)
        self.frame = records.Frame()  # what came in
        self.buffer = bytearray(AT_ONCE)
        self.due = [-1] * timers
        self.dropped = 0  # pieces of a line that were no frame
        self.reports = {}  # how many of each code
        for name, value in (("number", number), ("rng", seed), ("choice", -1)):
            if hasattr(self.state, name):
                setattr(self.state, name, value)

    def now(self):
        """The protocol's clock."""
        return self.ticks_us() & MASK30

    def start(self, cause=0):
        """Switch on; what causes there are is the protocol's."""
        node.on_start(self.state, self.params, self.now(), cause, self.out)
        self.drain()

    def give(self, kind, item):
        """The node's user hands something down: a frame record with what the kind needs."""
        node.on_input(self.state, self.params, self.now(), kind, item, self.out)
        self.drain()

    def poll(self):
        """Look at ports and timers once; to be called for ever, at least every millisecond."""
        for number in range(len(self.ports)):
            port = self.ports[number]
            if port:
                for data in port.receive(self.buffer):
                    self.hear(number, data)
                port.pump()
        now = self.now()
        for timer in range(len(self.due)):
            at = self.due[timer]
            if at >= 0 and (now - at) & MASK30 < HALF30:
                self.due[timer] = -1
                node.on_timer(self.state, self.params, now, timer, self.out)
                self.drain()

    def hear(self, number, data):
        """A piece of a line has come in on a port."""
        if self.wire.decode(data, self.frame) != 0:
            self.dropped += 1
            return
        self.take(number, self.frame)

    def take(self, number, frame):
        """A frame was heard on a port."""
        node.on_frame(self.state, self.params, self.now(), number, frame, self.out)
        self.drain()

    def carry(self, act, frame):
        """Send a frame, by the port that an action names."""
        port = self.ports[act.a] if act.a < len(self.ports) else None
        if port:
            self.put(port, act, frame)

    def put(self, port, act, frame):
        """Hand a port what is to leave by it."""
        port.send(cobs.encode(self.wire.encode(frame)), act.c)
        port.pump()

    def drain(self):
        """Carry out what a handler wants done."""
        out = self.out
        if out.overflow[0]:
            raise RuntimeError("a handler put out more than its outbox holds")
        for i in range(out.count[0]):
            act = out.action[i]
            if act.kind == SEND:
                self.carry(act, out.frame[i])
            elif act.kind == SET_TIMER:
                self.due[act.a] = act.b
            elif act.kind == DELIVER and self.receive:
                self.receive(out.frame[i])
            elif act.kind == REPORT:
                self.reports[act.a] = self.reports.get(act.a, 0) + 1
        out.clear()
