"""Serial lines: bytes in order at the speed of the line, changed or gone now and then."""

import errno

from tests.livesim.world import SECOND

ROOM = 4096  # bytes that a port takes before they are on the line
BITS = 10  # on the line, of a byte


class Line:
    """Two ends joined; each can be plugged into a machine as a device.

    Attributes:
        ends: both.
        cut: bytes go nowhere.
        change: share of the chunks in which something is changed or missing.
        away: who opens it finds nothing, and who has it is hung up on.
    """

    def __init__(self, world, baud, name):
        self.world, self.baud = world, baud
        self.chance = world.chance(f"line {name}")
        self.loss = self.double = self.change = 0.0
        self.delay_us = self.usual_us = (0, 0)
        self.cut = False
        self.ends = [End(self), End(self)]
        self.ends[0].other, self.ends[1].other = self.ends[1], self.ends[0]

    def heal(self):
        """As it was made."""
        self.loss = self.double = self.change = 0.0
        self.cut = False

    def spoil(self, data):
        """What of these bytes comes out: a line's losses and doublings are damage, too."""
        if not data or self.chance.random() >= self.change + self.loss + self.double:
            return data
        copy = bytearray(data)
        at = self.chance.randrange(len(copy))
        if self.chance.random() < 0.5:
            copy[at] ^= 1 << self.chance.randrange(8)
        else:
            del copy[at : at + self.chance.randint(1, 8)]
        return bytes(copy)


class End:
    """An end of a line, as the device of a machine."""

    def __init__(self, line):
        self.line = line
        self.other = None
        self.port = None
        self.free_at = 0
        self.queued = 0

    def plug_in(self, life, fd):
        """A process opens it."""
        self.port = Port(self, life, fd)
        return self.port

    def carry(self, data):
        """Bytes go to the other end, one after the other."""
        line = self.line
        took = len(data) * BITS * SECOND // line.baud
        self.free_at = max(self.free_at, line.world.now) + took
        self.queued += len(data)
        line.world.at(self.free_at, self._arrive, data)

    def _arrive(self, data):
        self.queued -= len(data)
        port = self.other.port
        if not self.line.cut and port is not None:
            port.take(self.line.spoil(data))
        if self.port is not None:
            self.port.room()


class Port:
    """An open serial port, as `machine.SerialPort`."""

    def __init__(self, end, life, fd):
        self.end, self.life, self.fd = end, life, fd
        self._waiting = bytearray()
        self._closed = False

    def fileno(self):
        return self.fd

    def read(self, count):
        if not self._waiting:
            raise BlockingIOError(errno.EAGAIN, "Resource temporarily unavailable")
        data = bytes(self._waiting[:count])
        del self._waiting[:count]
        return data

    def write(self, data):
        room = ROOM - self.end.queued
        if room <= 0:
            raise BlockingIOError(errno.EAGAIN, "Resource temporarily unavailable")
        part = bytes(data[:room])
        self.end.carry(part)
        return len(part)

    def take(self, data):
        if len(self._waiting) < ROOM and not self._closed:
            self._waiting += data
            self.look()

    def look(self):
        """Tell the loop, if something waits or somebody wants to write."""
        loop = self.life.loop
        if self._waiting:
            loop.ready(loop.readers, self.fd, self._waits)
        self.room()

    def room(self):
        loop = self.life.loop
        if self.fd in loop.writers and self._has_room():
            loop.ready(loop.writers, self.fd, self._wants)

    def _waits(self):
        return bool(self._waiting)

    def _has_room(self):
        return self.end.queued < ROOM

    def _wants(self):
        return self.fd in self.life.loop.writers and self._has_room()

    def close(self):
        self._closed = True
        if self.end.port is self:
            self.end.port = None
