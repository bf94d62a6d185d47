"""A radio station on a live channel, as an engine runs it: practical CSMA/CD-R."""

from typing import Any

from innervate.dialect import plain
from innervate.dialect.rng import seeded
from innervate.live.engine import NEVER
from innervate.live.stack import CabledStack, filled
from innervate.networks.radio import frames as wire
from innervate.networks.radio.protocol import fields as fields
from innervate.networks.radio.protocol import practical

OUTBOX = 8
TIMERS = 2

Frame = plain.make("Frame", fields.FRAME)
Params = plain.make("Params", fields.PARAMS)
Station = plain.make("Station", fields.STATION, fields.PRACTICAL)

TIMING = ("slot_us", "packet_slots", "ta_us", "dmax_us")


class StationStack(CabledStack):
    """One station with practical CSMA/CD-R; what it sends goes to its radio, not out of a port.

    Its `number` in data frames is 0 .. 1023, `params` are named as `radio_fields.PARAMS`, and no
    two stations may have the same `seed`.
    """

    timers = TIMERS
    reasons: tuple[str, ...] = wire.REASONS
    coder = wire
    silent_us = NEVER  # a channel may be silent for as long as it likes

    def __init__(self, number: int, params: dict[str, int], seed: int) -> None:
        self.station = Station()
        self.station.number, self.station.rng, self.station.choice = number, seeded(seed), -1
        given = filled(Params(), params)
        super().__init__(practical, self.station, given, Frame, OUTBOX, [0])

    def on_carrier(self, now: int, cd: bool, voc: bool) -> None:
        """The carrier came or went."""
        self.do.on_carrier(self.node, self.params, now, int(cd), int(voc), self.out)

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
