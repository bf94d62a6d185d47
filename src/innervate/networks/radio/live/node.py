"""A radio station on a live channel: the medium access protocol over any `Radio`."""

from collections.abc import AsyncGenerator, Callable
from typing import Any

from innervate.dialect import plain
from innervate.dialect.access import PACKET, QUEUE, REPORT_DELIVERED
from innervate.live.on_air import AirNode
from innervate.live.radio import Radio
from innervate.live.receipts import DELIVERED, EXPIRED, REFUSED, STOPPED, Receipt, check_bytes
from innervate.live.streams import Arrivals, Stream, message_line
from innervate.networks.radio import frames as wire
from innervate.networks.radio.live.stack import StationStack
from innervate.networks.radio.protocol import fields as fields

SLOTS_MIN = 3
HANDLES = 65_536

Packet = plain.make("Packet", fields.PACKET)


class RadioNode(AirNode):
    """A station: sends packets to all, receives theirs.

    Args as of any node, and:
        radio: what it sends and hears with.
        channel: what its path is called.
    """

    stack: StationStack

    def __init__(
        self, name: str, stack: StationStack, radio: Radio, channel: str = "channel"
    ) -> None:
        super().__init__(name, stack, [])
        self.take_radio(radio, channel)
        self.arrivals = Arrivals(is_spread=True)
        self._packets: dict[int, tuple[bytes, Receipt]] = {}
        self._handle = 0

    def send_request(self, request: dict[str, Any]) -> Receipt:
        """Send the payload of a status request to all stations."""
        return self.send_packet(bytes.fromhex(request["payload"]))

    def streams(self, request: dict[str, Any]) -> list[Stream]:
        """Packets of other stations, for those who follow them by the status socket."""
        return [(self.receive_packets(), message_line)]

    def receive_packets(
        self, callback: Callable[[int, bytes], None] | None = None
    ) -> AsyncGenerator[tuple[int, bytes], None]:
        """Sender and payload of packets as they come: to a callback, and as an async iterator."""
        return self.arrivals.receive(callback)

    def send_packet(self, payload: bytes) -> Receipt:
        """Send a packet to all; its receipt says "delivered" when another station proved it.

        Raises:
            ValueError: the payload is longer than a packet.
            TypeError: the payload is not bytes.
        """
        check_bytes(payload)
        slots = max(SLOTS_MIN, len(payload) + 2)
        most: int = self.stack.params.packet_slots
        if slots > most:
            raise ValueError(f"payload of {len(payload)} bytes; a packet holds {most - 2}")
        receipt = Receipt()
        why = self.idle() or ("queue full" if self.stack.station.queued >= QUEUE else "")
        if self.engine is None or why:
            receipt.move(REFUSED, why)
            return receipt
        item = Packet()
        item.slots, item.handle, item.ago = slots, self._handle, 0
        self._packets[self._handle] = (payload, receipt)
        self._handle = (self._handle + 1) % HANDLES
        self.outcomes["packets accepted"] += 1
        self.engine.input(PACKET, item)
        return receipt

    async def stop(self) -> None:
        """Switch the radio off, then the node; packets without a proof have expired."""
        await super().stop()
        packets, self._packets = self._packets, {}
        for _, receipt in packets.values():
            self.outcomes["packets expired"] += 1
            receipt.move(EXPIRED, STOPPED)

    def status(self) -> dict[str, Any]:
        """What is known here, and what the radio does: "off", "listening" or "sending"."""
        return {**super().status(), "radio": self.radio.mode}

    def on_lost(self, at: int, cd: bool, voc: bool) -> None:
        """A frame of ours did not go out: of packets in it nobody can prove that he has them.

        What has none is like one that went out and was heard by nobody: told as a collision it
        would make a reporter believe in wider delays.
        """
        if self.stack.station.pending:
            super().on_lost(at, cd, voc)
        else:
            self.on_carrier(at, cd, voc)

    def packed(self, frame: Any) -> bytes:
        """The bytes of a frame, with the packets that it carries."""
        payload = b""
        for k in range(frame.count):
            payload += self._packets[(frame.handle + k) % HANDLES][0]
        return wire.encode(frame, payload)

    def _deliver(self, kind: int, frame: Any) -> None:
        self.outcomes["packets received"] += 1
        self.arrivals.put((frame.source, wire.payload_of(self.heard)))

    def _reported(self, code: int, a: int, b: int) -> None:
        if code == REPORT_DELIVERED:
            for k in range(b):
                _, receipt = self._packets.pop((a + k) % HANDLES)
                receipt.move(DELIVERED)
                self.outcomes["packets delivered"] += 1
