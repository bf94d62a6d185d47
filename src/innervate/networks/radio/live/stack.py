"""A radio station on a live channel, as an engine runs it: practical CSMA/CD-R."""

from typing import Any

from innervate.dialect import plain
from innervate.dialect.rng import seeded
from innervate.live.engine import NEVER
from innervate.live.stack import filled
from innervate.networks.radio import frames as wire
from innervate.networks.radio.protocol import fields as fields
from innervate.networks.radio.protocol import practical as radio_practical

OUTBOX = 8
TIMERS = 2

Frame = plain.make("Frame", fields.FRAME)
Params = plain.make("Params", fields.PARAMS)
Station = plain.make("Station", fields.STATION, fields.PRACTICAL)

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
        self.params = filled(Params(), params)
        self.silent_us = NEVER  # a channel may be silent for as long as it likes
        self.station = Station()
        self.station.number, self.station.rng, self.station.choice = number, seeded(seed), -1
        self.out = plain.Outbox(Frame, OUTBOX)
        self.inbox = Frame()

    def on_start(self, now: int, cause: int) -> None:
        """Switch the station on at `now`, us; `cause` 0 is the first time."""
        radio_practical.on_start(self.station, self.params, now, cause, self.out)

    def on_frame(self, now: int, port: int) -> None:
        """The frame in the inbox was received."""
        radio_practical.on_frame(self.station, self.params, now, port, self.inbox, self.out)

    def on_timer(self, now: int, timer: int) -> None:
        """A timer of the station's protocol fires at `now`, us."""
        radio_practical.on_timer(self.station, self.params, now, timer, self.out)

    def on_input(self, now: int, kind: int, item: Any) -> None:
        """Hand the station a packet to send, or another input of `kind`."""
        radio_practical.on_input(self.station, self.params, now, kind, item, self.out)

    def on_carrier(self, now: int, cd: bool, voc: bool) -> None:
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
        """Ports that a frame leaves by: none, it goes to the radio."""
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
