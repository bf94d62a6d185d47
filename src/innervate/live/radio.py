"""A radio station on a live channel: the medium access protocol over any `Radio`.

A radio has a carrier-detect line, sends and receives frames, and listens or not. The one here is
a channel made of a process (medium.py); a serial modem with such a line is another.
"""

from __future__ import annotations

import asyncio
import random
import struct
import time
from collections import Counter
from collections.abc import AsyncGenerator, Callable
from functools import partial
from typing import Any, Protocol

from innervate.live.errors import LiveError
from innervate.live.links import Path
from innervate.live.node import LiveNode
from innervate.live.receipts import DELIVERED, REFUSED, Receipt
from innervate.live.streams import iterate
from innervate.protocol import plain, radio_practical
from innervate.protocol import radio_fields as fields
from innervate.protocol.radio_words import PACKET, QUEUE, REPORT_DELIVERED
from innervate.protocol.rng import seeded
from innervate.wire import radio as wire

OUTBOX = 8
TIMERS = 2
SLOTS_MIN = 3
HANDLES = 65_536

Frame = plain.make("Frame", fields.FRAME)
Packet = plain.make("Packet", fields.PACKET)
Params = plain.make("Params", fields.PARAMS)
Station = plain.make("Station", fields.STATION, fields.PRACTICAL)


class Listener(Protocol):
    """Who a radio tells what it hears; times are microseconds of the driver's clock."""

    def on_carrier(self, at: int, cd: bool, voc: bool) -> None:
        """The carrier came or went, or the radio listens again: cd = somebody, voc = just one."""

    def on_frame(self, at: int, data: bytes) -> None:
        """A frame was received whole; the carrier's end is told after it."""


class Radio(Protocol):
    """A half-duplex radio.

    Attributes:
        mode: "off", "listening" or "sending"; while it sends and turns round it is deaf.
    """

    mode: str

    async def start(self, listener: Listener) -> None:
        """Switch it on; it tells the listener at once whether there is a carrier."""

    def send(self, at: int, data: bytes, slots: int) -> None:
        """Decide at `at` to send: a frame that lasts so many slots, after a turnaround."""

    def plug(self, plugged: bool) -> None:
        """Pull the aerial's plug, or push it in: without it nothing is heard, nor does it reach."""

    def stop(self) -> None:
        """Switch it off."""


class Aerial(Path):
    """The one path of a station; cut, it neither hears nor is heard."""

    def __init__(self, radio: Radio, name: str) -> None:
        self._radio = radio
        self._is_cut = False
        super().__init__(name, 0)

    @property
    def cut(self) -> bool:
        """True = its plug is out."""
        return self._is_cut

    @cut.setter
    def cut(self, cut: bool) -> None:
        if cut != self._is_cut:
            self._is_cut = cut
            self._radio.plug(not cut)


TIMING = ("slot_us", "packet_slots", "ta_us", "dmax_us")


class StationStack:
    """One station with practical CSMA/CD-R.

    Args:
        number: in its data frames, 0 .. 1023.
        params: the protocol's parameters by name (`radio_fields.PARAMS`).
        seed: any whole number; stations must have different ones.
    """

    timers = TIMERS
    reasons: tuple[str, ...] = wire.REASONS

    def __init__(self, number: int, params: dict[str, int], seed: int) -> None:
        self.params = Params()
        for name, value in params.items():
            setattr(self.params, name, value)
        self.silent_us = 1 << 62  # a channel may be silent for as long as it likes
        self.station = Station()
        self.station.number, self.station.rng, self.station.choice = number, seeded(seed), -1
        self.out = plain.Outbox(Frame, OUTBOX)
        self.inbox = Frame()

    def start(self, now: int, cause: int) -> None:
        """Switch on."""
        radio_practical.on_start(self.station, self.params, now, cause, self.out)

    def frame(self, now: int, port: int) -> None:
        """The frame in the inbox was received."""
        radio_practical.on_frame(self.station, self.params, now, port, self.inbox, self.out)

    def timer(self, now: int, timer: int) -> None:
        """A timer fires."""
        radio_practical.on_timer(self.station, self.params, now, timer, self.out)

    def input(self, now: int, kind: int, item: Any) -> None:
        """A packet to send."""
        radio_practical.on_input(self.station, self.params, now, kind, item, self.out)

    def carrier(self, now: int, cd: bool, voc: bool) -> None:
        """The carrier came or went."""
        radio_practical.on_carrier(self.station, self.params, now, int(cd), int(voc), self.out)

    def encode(self, frame: Any) -> bytes:
        """The bytes of a frame without packets."""
        return wire.encode(frame)

    def decode(self, data: bytes) -> int:
        """Read bytes into the inbox; 0, or why not."""
        return wire.decode(data, self.inbox)

    def objection(self, sender: int | None) -> str:
        """Frames of the radio do not say who sent them where it matters."""
        return ""

    def ports_of(self, port: int, frame: Any, attempt: int) -> list[int] | None:
        """There is one channel."""
        return []

    def status(self, now: int) -> dict[str, Any]:
        """What it is doing, and its place in the round."""
        station = self.station
        return {
            "kind": "radio",
            "role": "station",
            "number": station.number,
            "mode": station.mode,
            "place": None if station.pos < 0 else station.pos,
            "queued": station.queued,
            "timing": {name: getattr(self.params, name) for name in TIMING},
        }


class RadioNode(LiveNode):
    """A station: sends packets to all, receives theirs.

    Args:
        name: as shown to people.
        stack: the medium access protocol.
        radio: what it sends and hears with.
        channel: what its path is called.
    """

    stack: StationStack

    def __init__(
        self, name: str, stack: StationStack, radio: Radio, channel: str = "channel"
    ) -> None:
        super().__init__(name, stack, [])
        self.radio = radio
        self.paths = [Aerial(radio, channel)]
        self.outcomes: Counter[str] = Counter()
        self._packets: dict[int, tuple[bytes, Receipt]] = {}
        self._handle = 0
        self._bytes = b""
        self._inbox: list[tuple[int, bytes]] = []
        self._callbacks: list[Callable[[int, bytes], None]] = []

    async def start(self) -> None:
        """Switch on protocol and radio."""
        await super().start()
        await self.radio.start(self)

    async def stop(self) -> None:
        """Switch off."""
        self.radio.stop()
        await super().stop()

    def receive_packets(
        self, callback: Callable[[int, bytes], None] | None = None
    ) -> AsyncGenerator[tuple[int, bytes], None]:
        """Sender and payload of packets as they come: to a callback, and as an async iterator."""
        queue: asyncio.Queue[tuple[int, bytes]] = asyncio.Queue()
        if callback is None:
            callback = partial(_put, queue)
        self._callbacks.append(callback)
        return iterate(queue, self._callbacks, callback)

    def send_packet(self, payload: bytes) -> Receipt:
        """Send a packet to all; its receipt says "delivered" when another station proved it.

        Raises:
            ValueError: the payload is longer than a packet.
        """
        slots = max(SLOTS_MIN, len(payload) + 2)
        most: int = self.stack.params.packet_slots
        if slots > most:
            raise ValueError(f"payload of {len(payload)} bytes; a packet holds {most - 2}")
        receipt = Receipt()
        if self.engine is None or self.stack.station.queued >= QUEUE:
            receipt.move(REFUSED, "queue full" if self.engine else "node not started")
            return receipt
        item = Packet()
        item.slots, item.handle, item.ago = slots, self._handle, 0
        self._packets[self._handle] = (payload, receipt)
        self._handle = (self._handle + 1) % HANDLES
        self.outcomes["packets accepted"] += 1
        self.engine.input(PACKET, item)
        return receipt

    def on_carrier(self, at: int, cd: bool, voc: bool) -> None:
        """The radio's carrier came or went."""
        assert self.engine is not None
        self.paths[0].heard_at = at
        self.engine.call(lambda now: self.stack.carrier(now, cd, voc), at)

    def on_frame(self, at: int, data: bytes) -> None:
        """The radio received a frame."""
        path = self.paths[0]
        if path.loss and random.random() < path.loss:
            return
        path.counters["received"] += 1
        path.counters["received bytes"] += len(data)
        assert self.engine is not None
        at_ns = time.time_ns() if self.taps else 0
        why = self.engine.read(data)
        if not why:
            self._bytes = data
            self.engine.receive(0, at)
        self._tell(at_ns, 0, False, data, why)

    def status(self) -> dict[str, Any]:
        """What is known here, and what the radio does: "off", "listening" or "sending"."""
        return {**super().status(), "radio": self.radio.mode}

    def counters(self) -> Counter[str]:
        """Handler calls, frames dropped by reason, packets by what became of them."""
        return super().counters() + self.outcomes

    def _transmit(self, port: int, frame: Any, attempt: int, flags: int) -> None:
        payload = b""
        for k in range(frame.count):
            payload += self._packets[(frame.handle + k) % HANDLES][0]
        assert self.engine is not None
        data = wire.encode(frame, payload)
        at_ns = time.time_ns() if self.taps else 0
        self.radio.send(self.engine.now, data, frame.slots)
        self.paths[0].sent(data)
        self._tell(at_ns, 0, True, data, "")
        self.outcomes["frames sent"] += 1

    def _deliver(self, kind: int, frame: Any) -> None:
        self.outcomes["packets received"] += 1
        self._inbox.append((frame.source, wire.payload_of(self._bytes)))

    def _reported(self, code: int, a: int, b: int) -> None:
        if code == REPORT_DELIVERED:
            for k in range(b):
                _, receipt = self._packets.pop((a + k) % HANDLES)
                receipt.move(DELIVERED)
                self.outcomes["packets delivered"] += 1

    def _settled(self) -> None:
        if self._inbox:
            inbox, self._inbox = self._inbox, []
            for source, payload in inbox:
                for callback in self._callbacks:
                    callback(source, payload)


def _put(queue: asyncio.Queue[tuple[int, bytes]], source: int, payload: bytes) -> None:
    queue.put_nowait((source, payload))


# Between stations and the medium: how a message begins.
JOIN = struct.Struct(">cH")  # b"J", station
SEND = struct.Struct(">cHQH")  # b"T", station, when decided (us), slots; then the frame
PLUG = struct.Struct(">cHB")  # b"P", station, 0 or 1: whether its aerial is plugged in
# b"C" carrier, b"R" the radio listens again, b"F" frame: when (us), cd, voc; b"F": the frame
HEARD = struct.Struct(">cQBB")


def read_heard(data: bytes) -> tuple[bytes, int, bool, bool, bytes] | None:
    """What the medium says: (b"C", b"R" or b"F", when, cd, voc, frame); None if it is nothing."""
    if len(data) < HEARD.size:
        return None
    what, at, cd, voc = HEARD.unpack_from(data)
    if what not in (b"C", b"R", b"F") or not voc <= cd <= 1:
        return None
    return what, at, bool(cd), bool(voc), data[HEARD.size :]


def check_parameters(params: dict[str, int]) -> None:
    """Refuse what cannot work in real time.

    Raises:
        LiveError: a slot is shorter than a PC can keep.
    """
    if params["slot_us"] < SLOT_US_MIN:
        raise LiveError(
            f"protocol.slot_us = {params['slot_us']}: a PC keeps slots of {SLOT_US_MIN} us or more"
        )


SLOT_US_MIN = 2000
