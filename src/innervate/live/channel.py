"""A shared channel as a process: superposes transmissions in real time [radio 3].

Everybody hears everybody. A station that sends is deaf until it listens again, a turnaround after
its end; it receives a frame that was the only signal from start to end while it listened. Stations
and medium run on one machine: what happened is stamped with the clock that they share.
"""

import asyncio
import socket
from collections import deque
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any

from innervate.live.channel_radio import DATAGRAM_MAX, HEARD, JOIN, LEASE_US, PLUG, SEND, WHO
from innervate.live.engine import clock_us
from innervate.live.errors import LiveError
from innervate.live.machine import machine
from innervate.live.nodefile import address

LOGGED = 4096  # transmissions
SLOT_US = 10_000
SLOT_US_MIN, SLOT_US_MAX = 2_000, 1_000_000  # the least is what a PC keeps
TURNAROUND_US = 5_000
TURNAROUND_US_MAX = 10_000_000
STATIONS = 1024
SLOTS_MAX = 4095
HEAD_BYTES = 32  # a frame may have so many more than its slots, a byte each
EARLY_US, LATE_US = 1_000_000, 10_000_000  # when a station can have decided, from now
DELAY_US = 500  # from a station to every other: who has sent listens again before an answer comes


@dataclass(slots=True)
class Air:
    """A transmission.

    Attributes:
        station: who sends.
        start: first moment on the air, us.
        end: the moment after its last.
        data: the frame.
    """

    station: int
    start: int
    end: int
    data: bytes


@dataclass(slots=True)
class Ear:
    """What a station's radio does.

    Attributes:
        station: whose.
        where: its address.
        joined_at: when it said last that it is there, us.
        ends: when its newest transmission is over, us.
        plugged: False while its aerial is out: it hears nothing, and nobody hears it.
        deaf_until: it sends, or turns round, until then, us; 0 = it listens.
        candidate: the signal that it may receive, None = none or disturbed.
        told: the carrier as told last.
        told_at: when its plug's changes were told last, us; they are told once a slot at most.
        owed: one is to be told when the slot is over.
    """

    station: int
    where: Any
    joined_at: int
    ends: int = 0
    plugged: bool = True
    deaf_until: int = 0
    candidate: Air | None = None
    told: tuple[bool, bool] = (False, False)
    told_at: int = -LATE_US
    owed: bool = False


@dataclass(slots=True)
class Medium:
    """A channel; `open` binds its socket, then stations may join.

    Attributes:
        slot_us: a slot on the air.
        turnaround_us: from deciding to send to being on the air, and back.
        log: the newest transmissions: (start, end, station, frame).
        collisions: signals that began while another was on the air.
        late: transmissions that should have begun before they were known here.
        unsound: datagrams that no station on this channel can have sent.
    """

    slot_us: int = SLOT_US
    turnaround_us: int = TURNAROUND_US
    log: deque[tuple[int, int, int, bytes]] = field(default_factory=lambda: deque(maxlen=LOGGED))
    collisions: int = 0
    late: int = 0
    unsound: int = 0
    _ears: dict[int, Ear] = field(default_factory=dict)
    _present: list[Air] = field(default_factory=list)
    _socket: socket.socket | None = None

    def open(self, where: tuple[str, int]) -> tuple[str, int]:
        """Bind the socket; the address that stations have to name.

        Raises:
            LiveError: the address cannot be used.
        """
        sock = machine().socket(socket.AF_INET, socket.SOCK_DGRAM)
        sock.setblocking(False)
        try:
            sock.bind(where)
        except OSError as error:
            sock.close()
            raise LiveError(f"cannot use {where[0]}:{where[1]}: {error.strerror}") from None
        self._socket = sock
        asyncio.get_running_loop().add_reader(sock.fileno(), self._readable)
        host, port = sock.getsockname()
        return host, port

    def close(self) -> None:
        """Stop what is on the air, and listen no more."""
        if self._socket is not None:
            asyncio.get_running_loop().remove_reader(self._socket.fileno())
            self._socket.close()
            self._socket = None

    def _readable(self) -> None:
        assert self._socket is not None
        try:
            data, where = self._socket.recvfrom(DATAGRAM_MAX)
        except OSError:
            return
        self.take(data, where)

    def take(self, data: bytes, where: Any) -> None:
        """A station says that it joins, or sends; what is neither is dropped."""
        done = False
        if data[:1] == b"J" and len(data) == JOIN.size:
            done = self._join(JOIN.unpack(data)[1], where)
        elif data[:1] == b"P" and len(data) == PLUG.size:
            _, station, plugged = PLUG.unpack(data)
            if plugged <= 1 and self._is_at(station, where):
                self._plug(self._ears[station], bool(plugged))
                done = True
        elif data[:1] == b"T" and len(data) > SEND.size:
            _, station, at, slots = SEND.unpack_from(data)
            if self._is_at(station, where):
                done = self._transmit(station, at, slots, data[SEND.size :])
                if not done and not self._ears[station].deaf_until:
                    self._listens(self._ears[station], b"L", clock_us())
        self.unsound += not done

    def _is_at(self, station: int, where: Any) -> bool:
        return station in self._ears and self._ears[station].where == where

    def _join(self, station: int, where: Any) -> bool:
        """A station joins, again and again, so that a channel started later hears of it, too."""
        now = clock_us()
        known = self._ears.get(station)
        if known is not None and known.where == where:
            known.joined_at = now
            self._send(where, WHO + self._who(now))
            return True
        if station >= STATIONS or (known is not None and now - known.joined_at < LEASE_US):
            return False
        if not self._makes_room(where, now):
            return False
        self._ears[station] = ear = Ear(station, where, now)
        self._listens(ear, b"L", now)  # it may have sent when no channel was there
        return True

    def _who(self, now: int) -> bytes:
        """The numbers of stations that are there, as many as a message holds."""
        found = [ear.station for ear in self._ears.values()
                 if ear.plugged and now - ear.joined_at < LEASE_US]  # fmt: skip
        return b"".join(one.to_bytes(2, "big") for one in found[: DATAGRAM_MAX // 2 - 1])

    def _makes_room(self, where: Any, now: int) -> bool:
        """An address is one station: another number there has to be gone for a while."""
        for station, ear in self._ears.items():
            if ear.where == where:
                if now - ear.joined_at < LEASE_US:
                    return False
                del self._ears[station]
                return True
        return True

    def _plug(self, ear: Ear, plugged: bool) -> None:
        if plugged == ear.plugged:
            return
        ear.plugged, ear.candidate = plugged, None
        if ear.owed:
            return
        wait_us = ear.told_at + self.slot_us - clock_us()
        if wait_us <= 0:
            self._tell_plug(ear)
        else:  # a plug that comes and goes all the time is told of no more often than slots are
            ear.owed = True
            asyncio.get_running_loop().call_later(wait_us / 1e6, self._tell_plug, ear)

    def _tell_plug(self, ear: Ear) -> None:
        ear.owed, ear.told_at = False, clock_us()
        if not ear.deaf_until and ear in self._ears.values():
            ear.told = self._carrier(ear)
            self._say(ear, b"C", ear.told_at, b"")

    def _carrier(self, ear: Ear) -> tuple[bool, bool]:
        """What a station hears of others: somebody, just one. Its own signal may still be under
        way to them when it listens again.
        """
        others = sum(air.station != ear.station for air in self._present)
        return ear.plugged and others > 0, ear.plugged and others == 1

    def _transmit(self, station: int, at: int, slots: int, data: bytes) -> bool:
        """A station sends: one frame at a time, decided now; False if that cannot be."""
        ear = self._ears[station]
        now = clock_us()
        start = max(now, at + self.turnaround_us)
        if not -LATE_US <= at - now <= EARLY_US or not 1 <= slots <= SLOTS_MAX or start < ear.ends:
            return False
        if len(data) > slots + HEAD_BYTES:
            return False
        self.late += start > at + self.turnaround_us
        air = Air(station, start, start + slots * self.slot_us, data)
        ear.candidate, ear.ends = None, air.end
        ear.deaf_until = air.end + self.turnaround_us
        if ear.plugged:
            self.log.append((air.start, air.end, station, data))
            self._later(air.start + DELAY_US, self._begin, air)
            self._later(air.end + DELAY_US, self._end, air)
        self._later(
            ear.deaf_until, self._ready, station, ear.deaf_until, b"R" if ear.plugged else b"L"
        )
        return True

    def _later(self, at: int, what: Any, *args: Any) -> None:
        loop = asyncio.get_running_loop()
        loop.call_at(loop.time() + max(0, at - clock_us()) / 1e6, what, *args)

    def _begin(self, air: Air) -> None:
        if self._present:
            self.collisions += 1
        self._present.append(air)
        for ear in self._ears.values():
            if ear.station != air.station:
                _, alone = self._carrier(ear)
                ear.candidate = air if alone and not ear.deaf_until else None
        self._tell(air.start + DELAY_US)

    def _end(self, air: Air) -> None:
        self._present.remove(air)
        for ear in self._ears.values():
            if ear.candidate is air:
                ear.candidate = None
                self._say(ear, b"F", air.end + DELAY_US, air.data)
        self._tell(air.end + DELAY_US)

    def _tell(self, at: int) -> None:
        """Who listens hears that the carrier has changed."""
        for ear in self._ears.values():
            carrier = self._carrier(ear)
            if not ear.deaf_until and ear.told != carrier:
                ear.told = carrier
                self._say(ear, b"C", at, b"")

    def _ready(self, station: int, at: int, what: bytes) -> None:
        ear = self._ears.get(station)
        if ear is not None and ear.deaf_until == at:
            ear.deaf_until = 0
            self._listens(ear, what, at)

    def _listens(self, ear: Ear, what: bytes, at: int) -> None:
        """A station's radio listens from now on; what it sent was on the air ("R"), or not."""
        ear.told = self._carrier(ear)
        self._say(ear, what, at, b"")

    def _say(self, ear: Ear, what: bytes, at: int, data: bytes) -> None:
        self._send(ear.where, HEARD.pack(what, at, *map(int, ear.told)) + data)

    def _send(self, where: Any, data: bytes) -> None:
        if self._socket is None:  # closed while transmissions were under way
            return
        with suppress(OSError):  # a station that is gone hears nothing
            self._socket.sendto(data, where)


async def run(where: str, slot_us: int, turnaround_us: int) -> None:
    """A medium until it is cancelled.

    Raises:
        LiveError: no station can keep such times, or the address cannot be used.
    """
    for name, value, low, high in (
        ("slot", slot_us, SLOT_US_MIN, SLOT_US_MAX),
        ("turnaround", turnaround_us, 0, TURNAROUND_US_MAX),
    ):
        if not low <= value <= high:
            raise LiveError(f"medium: a {name} of {value} us cannot be; {low} to {high} us can")
    medium = Medium(slot_us, turnaround_us)
    host, port = medium.open(address(where, "medium"))
    print(f"medium: {host}:{port}, slots of {slot_us} us", flush=True)
    try:
        await asyncio.Event().wait()
    finally:
        medium.close()
