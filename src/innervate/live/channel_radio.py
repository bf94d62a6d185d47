"""The radio of a station on a channel made of a process, and what the two say to each other."""

import asyncio
import socket
import struct
from contextlib import suppress

from innervate.live.engine import clock_us
from innervate.live.errors import LiveError
from innervate.live.machine import machine
from innervate.live.radio import Listener

DATAGRAM_MAX = 2048
JOIN_S = 1.0
LEASE_US = 2_500_000  # who joins no more for so long is gone; so is a channel that says nothing
HEARD_US = 1 << 28  # nothing is told of what was longer ago: the protocol's clock has 30 bits

# Between stations and the medium: how a message begins.
JOIN = struct.Struct(">cH")  # b"J", station
SEND = struct.Struct(">cHQH")  # b"T", station, when decided (us), slots; then the frame
PLUG = struct.Struct(">cHB")  # b"P", station, 0 or 1: whether its aerial is plugged in
# b"C" carrier, b"R" the radio listens again, b"L" so it does, and nothing that it may have sent
# was on the air, b"F" frame: when (us), cd, voc; b"F": the frame
HEARD = struct.Struct(">cQBB")
TOLD = (b"C", b"R", b"L", b"F")
WHO = b"W"  # to who joins again: the numbers of all whose aerials are plugged in, two bytes each


def read_heard(data: bytes) -> tuple[bytes, int, bool, bool, bytes] | None:
    """What the medium says: (one of TOLD, when, cd, voc, frame); None if it is nothing."""
    if len(data) < HEARD.size:
        return None
    what, at, cd, voc = HEARD.unpack_from(data)
    if what not in TOLD or not voc <= cd <= 1:
        return None
    return what, at, bool(cd), bool(voc), data[HEARD.size :]


class MediumRadio:
    """The radio of station `number` on the medium at address `where`."""

    def __init__(self, number: int, where: tuple[str, int]) -> None:
        self.number = number
        self.where = where
        self.mode = "off"
        self.plugged = True
        self._there: tuple[int, ...] = ()
        self._heard_at = -LEASE_US  # the channel said anything, us
        self._socket: socket.socket | None = None
        self._listener: Listener | None = None
        self._again: asyncio.TimerHandle | None = None

    async def start(self, listener: Listener) -> None:
        """Join the channel; `listener` is told of carriers and frames.

        Raises:
            LiveError: there can be none at its address.
        """
        self._listener = listener
        sock = machine().socket(socket.AF_INET, socket.SOCK_DGRAM)
        try:
            sock.setblocking(False)
            sock.connect(self.where)
        except OSError as error:
            sock.close()
            host, port = self.where
            raise LiveError(f"no way to {host}:{port}: {error.strerror}") from None
        self._socket, self._heard_at = sock, clock_us()  # it has as long to answer
        asyncio.get_running_loop().add_reader(sock.fileno(), self._readable)
        self.mode = "listening"
        self._join()

    def _join(self) -> None:
        """Join, and again now and then: the channel may have been started anew."""
        assert self._socket is not None
        with suppress(OSError):  # no channel there yet
            self._socket.send(JOIN.pack(b"J", self.number))
            self._socket.send(PLUG.pack(b"P", self.number, self.plugged))
        self._again = asyncio.get_running_loop().call_later(JOIN_S, self._join)

    def send(self, at: int, data: bytes, slots: int) -> None:
        """Send a frame of so many slots, from the time `at` on, us."""
        assert self._socket is not None
        self.mode = "sending"
        with suppress(OSError):  # no channel there: it is lost
            self._socket.send(SEND.pack(b"T", self.number, at, slots) + data)

    def is_there(self) -> bool:
        """True while the channel answers this station."""
        return clock_us() - self._heard_at < LEASE_US

    def others(self) -> list[int]:
        """Who else is on the channel with an aerial that is plugged in, as it says."""
        return [one for one in self._there if one != self.number] if self.is_there() else []

    def plug(self, plugged: bool) -> None:
        """Have the channel leave this station out, or take it in again."""
        self.plugged = plugged
        if self._socket is not None:
            with suppress(OSError):
                self._socket.send(PLUG.pack(b"P", self.number, plugged))

    def stop(self) -> None:
        """Leave the channel: nothing is heard or sent any more."""
        if self._again is not None:
            self._again.cancel()
        if self._socket is not None:
            asyncio.get_running_loop().remove_reader(self._socket.fileno())
            self._socket.close()
            self._socket = None
        self.mode = "off"

    def _readable(self) -> None:
        assert self._socket is not None
        try:
            data = self._socket.recv(DATAGRAM_MAX)
        except OSError:
            return
        self._heard_at = clock_us()
        if data[:1] == WHO:
            self._there = struct.unpack_from(f">{len(data) // 2}H", data, 1)
            return
        heard = read_heard(data)
        if heard is None or self._listener is None:
            return
        what, at, cd, voc, frame = heard
        if abs(at - clock_us()) > HEARD_US:
            return
        was_lost = what == b"L" and self.mode == "sending"
        if what in (b"R", b"L"):
            self.mode = "listening"
        if self.mode == "sending":
            return  # we decided to send before the medium knew: deaf already
        if what == b"F":
            self._listener.on_frame(at, frame)
        elif was_lost:
            self._listener.on_lost(at, cd, voc)
        else:
            self._listener.on_carrier(at, cd, voc)
