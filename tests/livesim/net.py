"""Datagrams between machines: lost, doubled, late, changed; groups; whoever listens and forges."""

import errno
import socket
from collections import deque
from itertools import count

from tests.livesim.world import SECOND

ROOM = 200_000  # bytes that wait in a socket
RECORDED = 400  # datagrams that somebody who listens keeps, over all
GROUP = "239."


class Way:
    """How it is on the way from one address to another.

    Attributes:
        delay_us: least and most.
        loss, double, change: shares of the datagrams to which that happens.
        cut: nothing gets through.
    """

    def __init__(self, delay_us=(100, 400)):
        self.usual_us = self.delay_us = delay_us
        self.loss = self.double = self.change = 0.0
        self.cut = False

    def heal(self):
        """As it was made."""
        self.delay_us = self.usual_us
        self.loss = self.double = self.change = 0.0
        self.cut = False


class Net:
    """All sockets of all machines.

    Attributes:
        ways: by the machines' addresses, (from, to); who has none there reaches nobody.
        sniffers: are told of every datagram as it leaves: (from, to, bytes).
        recorded: what somebody has recorded, at random.
        taken: of each datagram in `recorded`, the processes that took what is sealed in it.
    """

    def __init__(self, world):
        self.world = world
        self.ways = {}
        self.sockets = {}
        self.groups = {}
        self.recorded = []
        self.taken = {}
        self.sniffers = []
        self.sent = 0
        self._chance = world.chance("net")
        self._ports = count(40_000)

    def way(self, here, there, **how):
        """Join two machines, both ways; the two ways."""
        self.ways[here, there], self.ways[there, here] = Way(**how), Way(**how)
        return self.ways[here, there], self.ways[there, here]

    def free_port(self):
        """A port that nobody has."""
        return next(self._ports)

    def send(self, source, target, data):
        """A datagram leaves; to a group it goes to whoever is in it, its sender included."""
        self.sent += 1
        for sniffer in self.sniffers:
            sniffer(source, target, data)
        if target[0].startswith(GROUP):
            for sock in list(self.groups.get(target, ())):
                self._carry(self.ways.get((source[0], sock.interface)), source, sock, data)
            return
        if source[0] == target[0]:
            self.world.at(self.world.now + 20_000, self._arrive, source, target, data)
            return
        self._carry(self.ways.get((source[0], target[0])), source, target, data)

    def _record(self, what):
        if len(self.recorded) < RECORDED:
            self.recorded.append(what)
        else:
            place = self._chance.randrange(RECORDED)
            self.taken.pop(self.recorded[place][2], None)
            self.recorded[place] = what
        self.taken.setdefault(what[2], set())

    def _carry(self, way, source, target, data):
        if way is None or way.cut:
            return
        chance = self._chance
        if way.loss and chance.random() < way.loss:
            return
        low, high = way.delay_us
        now = self.world.now
        times = 1 + (way.double > 0 and chance.random() < way.double)
        for _ in range(times):
            if way.change and chance.random() < way.change:
                data = changed(chance, data)
            delay = int(1000 * (low + (high - low) * chance.random()))
            self.world.at(now + delay, self._arrive, source, target, data)

    def _arrive(self, source, target, data):
        sock = target if isinstance(target, Datagrams) else self.sockets.get(target)
        if sock is not None:
            if self._chance.random() < 0.05:
                self._record((source, target, data, sock.life))
            sock.take(source, data)

    def inject(self, source, target, data):
        """Somebody sends in another's name."""
        self.world.at(self.world.now + 100_000, self._arrive, source, target, data)


def changed(chance, data):
    """Bytes with one to three bits turned over: what a CRC of 16 bits always finds."""
    copy = bytearray(data)
    for bit in chance.sample(range(8 * len(copy)), chance.randint(1, 3)):
        copy[bit // 8] ^= 1 << bit % 8
    return bytes(copy)


class Datagrams:
    """A UDP socket of a simulated machine, with what the live stack asks of one."""

    def __init__(self, life, net, fd):
        self.life, self.net, self.fd = life, net, fd
        self.where = None
        self.target = None
        self.interface = None
        self._waiting = deque()
        self._bytes = 0
        self._closed = False

    def fileno(self):
        return -1 if self._closed else self.fd

    def setblocking(self, _flag):
        pass

    def bind(self, where):
        host, port = where
        where = (host, port or self.net.free_port())
        if host.startswith(GROUP):
            self.where = (None, where[1])
            return
        if where in self.net.sockets:
            raise OSError(errno.EADDRINUSE, "Address already in use")
        if host not in self.life.host.addresses:
            raise OSError(errno.EADDRNOTAVAIL, "Cannot assign requested address")
        self.where = where
        self.net.sockets[where] = self

    def getsockname(self):
        return self.where

    def connect(self, target):
        self.bind((self.life.host.addresses[0], 0))
        self.target = target

    def setsockopt(self, _level, name, value):
        if name == socket.IP_ADD_MEMBERSHIP:
            group = (socket.inet_ntoa(value[:4]), self.where[1])
            self.interface = socket.inet_ntoa(value[4:8])
            self.where = (self.interface, self.where[1])
            members = self.net.groups.setdefault(group, [])
            if self in members:
                raise OSError(errno.EADDRINUSE, "Address already in use")
            members.append(self)

    def getsockopt(self, *_which):
        raise OSError(errno.ENOPROTOOPT, "Protocol not available")

    def send(self, data):
        self.sendto(data, self.target)

    def sendto(self, data, target):
        if self._closed:
            raise OSError(errno.EBADF, "Bad file descriptor")
        if self.life.alive:
            self.net.send(self.where, target, bytes(data))

    def take(self, source, data):
        if self._bytes + len(data) > ROOM or (self.target and source != self.target):
            return
        self._bytes += len(data)
        self._waiting.append((data, source))
        if len(self._waiting) == 1:
            self.look()

    def look(self):
        """Tell the loop, if something waits."""
        if self._waiting:
            loop = self.life.loop
            loop.ready(loop.readers, self.fd, self._waits)

    def _waits(self):
        return bool(self._waiting)

    def recvfrom(self, _size):
        if not self._waiting:
            raise BlockingIOError(errno.EAGAIN, "Resource temporarily unavailable")
        data, source = self._waiting.popleft()
        self._bytes -= len(data)
        return data, source

    def recv(self, size):
        return self.recvfrom(size)[0]

    def close(self):
        self._closed = True
        self._waiting.clear()
        if self.net.sockets.get(self.where) is self:
            del self.net.sockets[self.where]
        for members in self.net.groups.values():
            if self in members:
                members.remove(self)


def us(seconds):
    """Microseconds of a time in ns."""
    return seconds * SECOND // 1000
