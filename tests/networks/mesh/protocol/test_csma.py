"""CSMA by hand: backoffs, busy channels, giving up, acknowledgements that do not wait."""

from collections import Counter

import pytest

from innervate.dialect import plain, rng
from innervate.dialect.outbox import REPORT, SEND, SET_TIMER, URGENT
from innervate.networks.mesh.protocol import csma, csma_fields

STATION = plain.make("Station", csma_fields.STATION)
ITEM = plain.make("Item", csma_fields.ITEM)
PARAMS = plain.make("Params", csma_fields.PARAMS)
NOW = 1_000_000
UNIT_US = 320
DRAWS = 16_000


class Bench:
    """One station; `actions` are those of the newest call."""

    def __init__(self, **more):
        self.station, self.params = STATION(), PARAMS()
        self.station.rng, self.station.choice = rng.seeded(987_654_321), rng.GENERATE
        for name, value in {"exponent_min": 3, "exponent_max": 6, "busy_max": 8, **more}.items():
            setattr(self.params, name, value)
        self.params.backoff_us = UNIT_US
        self.out = plain.Outbox(ITEM, 4)
        csma.on_start(self.station, self.params, NOW, 0, self.out)

    def drain(self):
        actions = [(a.kind, a.a, a.b, a.c) for a in self.out.action[: self.out.count[0]]]
        self.out.count[0] = 0
        return actions

    def packet(self, attempt=0, urgent=0):
        item = ITEM()
        item.attempt, item.urgent = attempt, urgent
        csma.on_input(self.station, self.params, NOW, csma.PACKET, item, self.out)
        return self.drain()

    def timer(self, busy):
        csma.on_carrier(self.station, self.params, NOW, busy, 0, self.out)
        csma.on_timer(self.station, self.params, NOW, csma.BACKOFF, self.out)
        return self.drain()


def units(actions):
    """The backoff that was set, in units."""
    [(kind, timer, at, _)] = actions
    assert (kind, timer) == (SET_TIMER, csma.BACKOFF)
    assert (at - NOW) % UNIT_US == 0
    return (at - NOW) // UNIT_US


@pytest.mark.parametrize(("attempt", "slots"), [(0, 8), (1, 16), (2, 32), (3, 64), (9, 64)])
def test_the_first_backoff_is_uniform_and_grows_with_the_attempt(attempt, slots):
    bench = Bench()
    drawn = Counter(units(bench.packet(attempt)) for _ in range(DRAWS))
    assert set(drawn) == set(range(slots))
    mean = DRAWS / slots
    assert all(abs(count - mean) < 5 * mean**0.5 for count in drawn.values())


def test_an_idle_channel_is_taken_when_the_backoff_ends():
    bench = Bench()
    bench.packet()
    assert bench.timer(busy=0) == [(SEND, 0, 0, 0)]
    assert bench.timer(busy=0) == []  # a timer that fires once more means nothing


def test_a_busy_channel_doubles_the_backoff_until_the_frame_is_given_up():
    bench = Bench()
    bench.packet()
    most = []
    for _ in range(7):
        bench.station.choice = 1 << 20  # the longest
        most.append(units(bench.timer(busy=1)))
    assert most == [15, 31, 63, 63, 63, 63, 63]
    assert bench.timer(busy=1) == [(REPORT, csma.REPORT_GAVE_UP, 8, 0)]
    assert bench.timer(busy=0) == []


def test_the_next_frame_starts_anew():
    bench = Bench(busy_max=1)
    bench.packet()
    assert bench.timer(busy=1)[0][0] == REPORT
    bench.station.choice = 1 << 20
    assert units(bench.packet()) == 7


def test_an_urgent_frame_asks_nobody_and_disturbs_no_backoff():
    bench = Bench()
    bench.packet()
    csma.on_carrier(bench.station, bench.params, NOW, 1, 0, bench.out)
    assert bench.packet(urgent=1) == [(SEND, 0, 0, URGENT)]
    assert bench.timer(busy=0) == [(SEND, 0, 0, 0)]
