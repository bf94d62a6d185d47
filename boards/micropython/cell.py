"""A cell of the skin on a board: the protocol's four ports are four UARTs.

The protocol (`node`) knows no clock and no wire; here its timers run on time.ticks_us, its frames
travel as on any serial line of innervate: COBS, a zero behind each frame, 8N1.
"""

import time

import node
import records
from outbox import Outbox

from innervate.networks.skin import frames as skin
from innervate.wire import cobs

MASK30 = (1 << 30) - 1  # the protocol's clock; ticks_us wraps there, or at a multiple of it
HALF30 = 1 << 29
SEND = 1  # actions and flags: dialect/outbox.py
SET_TIMER = 2
DELIVER = 3
REPORT = 4
URGENT = 1
FLUSH = 2
SAMPLE = 1
TIMERS = 2
ROOM = 12  # most actions of one call: four broken ports, a new parent, four beacons, a timer
QUEUE = 8  # frames that wait for a port
AT_ONCE = 64  # bytes read from a port in one go


class Port:
    """One end of a cable.

    `uart` has any(), readinto(buffer) and write(bytes), none of which waits; write returns how many
    bytes it took, or None for none.
    """

    def __init__(self, uart):
        self.uart = uart
        self.decoder = cobs.Decoder(skin.SIZE_MAX)
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


class Cell:
    """A cell.

    Args:
        number: in its data frames, 0 to 65535; every cell has another.
        uarts: four, in order W, E, up, down; None for a free socket.
        seed: 1 to 1_072_496_638, different on every cell, not near each other (rng.py).
        sense: called with a frame to fill with what the sensors say; None = no sensors.
        sample_us: between two samples.
        ticks_us: the clock, us, wrapping at a multiple of 2^30.
        obey: called with a frame's code and value for every command of the PC; None = nobody obeys.
    """

    def __init__(
        self, number, uarts, seed, sense=None, sample_us=0, ticks_us=time.ticks_us, obey=None
    ):
        self.ports = [uart and Port(uart) for uart in uarts]
        self.sense = sense
        self.obey = obey
        self.sample_us = sample_us
        self.ticks_us = ticks_us
        self.state = records.State()
        self.params = records.Params()
        self.out = Outbox(records.Frame, ROOM)
        self.frame = records.Frame()  # what came in
        self.sample = records.Frame()  # what the sensors say
        self.buffer = bytearray(AT_ONCE)
        self.due = [-1] * TIMERS
        self.dropped = 0  # pieces of a line that were no frame
        self.moves = 0  # reports of another parent
        self.state.number = number
        self.state.rng = seed
        self.state.choice = -1
        self.sampled = self.now()

    def now(self):
        """The protocol's clock."""
        return self.ticks_us() & MASK30

    def start(self, again=1):
        """Switch on; 1 waits some periods, until neighbours that know us from before give us up.

        0 takes the first route that is heard: only where all cells are switched on at once.
        """
        now = self.now()
        node.on_start(self.state, self.params, now, again, self.out)
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
        for timer in range(TIMERS):
            at = self.due[timer]
            if at >= 0 and (now - at) & MASK30 < HALF30:
                self.due[timer] = -1
                node.on_timer(self.state, self.params, now, timer, self.out)
                self.drain()
        if self.sample_us and (now - self.sampled) & MASK30 >= self.sample_us:
            self.sampled = now
            if self.sense:
                self.sense(self.sample)
            node.on_input(self.state, self.params, now, SAMPLE, self.sample, self.out)
            self.drain()

    def hear(self, number, data):
        """A piece of a line has come in on a port."""
        if skin.decode(data, self.frame) != skin.OK:
            self.dropped += 1
            return
        node.on_frame(self.state, self.params, self.now(), number, self.frame, self.out)
        self.drain()

    def drain(self):
        """Carry out what a handler wants done."""
        out = self.out
        if out.overflow[0]:
            raise RuntimeError("a handler put out more than its outbox holds")
        for i in range(out.count[0]):
            act = out.action[i]
            if act.kind == SEND:
                port = self.ports[act.a]
                if port:
                    port.send(cobs.encode(skin.encode(out.frame[i])), act.c)
                    port.pump()
            elif act.kind == SET_TIMER:
                self.due[act.a] = act.b
            elif act.kind == DELIVER and self.obey:
                self.obey(out.frame[i].dist, out.frame[i].proximity)
            elif act.kind == REPORT and act.a == 1:
                self.moves += 1
        out.clear()
