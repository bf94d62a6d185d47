"""Single calls of baselines: clocks, packets that come to an empty queue, carriers."""

import pytest

from innervate.dialect import plain
from innervate.dialect.access import CLOCK, FORCE, PACKET
from innervate.dialect.arith import MASK30
from innervate.dialect.outbox import DELIVER, SET_TIMER
from innervate.dialect.outbox import SEND as SEND_IT
from innervate.dialect.rng import seeded
from innervate.networks.radio.baselines import contend, passing, slots, tree
from innervate.networks.radio.baselines import station as entry
from innervate.networks.radio.baselines.common import LISTEN, SEND, STOPPED
from innervate.networks.radio.baselines.fields import BASELINE
from innervate.networks.radio.protocol import fields
from innervate.networks.radio.protocol.station import enqueue
from innervate.networks.radio.scenario.baselines import NUMBERS

Station = plain.make("Station", fields.STATION, BASELINE)
Params = plain.make("Params", fields.PARAMS)
Item = plain.make("Item", fields.PACKET)
TIMING = {"period_us": 100, "stations": 5, "slot_us": 208, "ta_us": 20, "dmax_us": 5}


class Alone:
    """A station of a protocol, which listens on an idle channel."""

    def __init__(self, mac, number=2, **state):
        self.params, self.station = Params(), Station()
        for name, value in (TIMING | {"mac": NUMBERS[mac]}).items():
            setattr(self.params, name, value)
        self.station.number, self.station.rng = number, seeded(1)
        self.out = plain.Outbox(plain.make("Frame", fields.FRAME), 8)
        entry.on_start(self.station, self.params, 0, 0, self.out)
        for name, value in state.items():
            setattr(self.station, name, value)

    def given(self, now, kind, **words):
        item = Item()
        for name, value in words.items():
            setattr(item, name, value)
        entry.on_input(self.station, self.params, now, kind, item, self.out)
        return self.station

    def carrier(self, now, cd):
        entry.on_carrier(self.station, self.params, now, cd, 0, self.out)
        return self.station


@pytest.mark.parametrize("mac", ["tdma", "p-persistent", "slotted-aloha", "tree"])
def test_a_slot_began_so_long_ago_as_the_clock_says(mac):
    station = Alone(mac).given(1000, CLOCK, handle=3, ago=30)
    assert (station.mark, station.step) == (970, 3)


@pytest.mark.parametrize(
    ("period_us", "ahead"),
    [(1 << 26, 2), (1 << 25, 6), (1 << 20, 254), (1 << 18, 1022), (100, 1024)],
)
def test_dice_are_thrown_for_so_many_slots_as_a_timer_reaches(period_us, ahead):
    alone = Alone("p-persistent")
    alone.params.period_us, alone.params.p_q15 = period_us, 0
    slots.throw(alone.station, alone.params, 700, alone.out)
    acts = [alone.out.action[i] for i in range(alone.out.count[0])]
    assert acts[-1].kind == SET_TIMER
    assert (acts[-1].b, alone.station.attempt) == (700 + ahead * period_us, 0)


@pytest.mark.parametrize("before", [tree.NOTHING, tree.NOISE, tree.READ])
def test_whatever_was_before_its_clock_was_set_a_station_of_the_tree_knows_of_no_resolution(before):
    alone = Alone("tree", heard=before, told=before, depth=3, branches=5)
    tree.begin(alone.station, alone.params, 700, alone.out)
    known = (alone.station.heard, alone.station.told, alone.station.depth, alone.station.branches)
    assert known == (tree.NOTHING, tree.NOTHING, tree.OUT, 0)


@pytest.mark.parametrize("kind", [PACKET, FORCE])
@pytest.mark.parametrize("mac", ["csma-cd-d1", "csma-cd-d2", "csma-cd-d2p", "dcf"])
def test_a_packet_for_an_idle_channel_is_sent_at_once_whatever_was_waited_for_before(mac, kind):
    station = Alone(mac, open=1, due=9000).given(5000, kind, slots=5)
    assert (station.mode, station.start) == (SEND, 5020)
    waiting = Alone(mac, open=0, due=9000).given(5000, PACKET, slots=5)
    assert (waiting.mode, waiting.queued) == (LISTEN, 1)


@pytest.mark.parametrize(
    ("mac", "armed"), [("p-persistent", 0), ("slotted-aloha", 1), ("tdma", 1), ("nonpersistent", 1)]
)
def test_only_who_throws_dice_stops_waiting_when_a_carrier_comes(mac, armed):
    alone = Alone(mac)
    alone.given(1000, CLOCK, handle=0, ago=0)
    assert alone.given(1010, PACKET, slots=5).armed == 1
    assert alone.carrier(1020, 1).armed == armed


@pytest.mark.parametrize("mac", NUMBERS)
def test_a_turn_that_a_frame_names_is_taken_where_turns_are_handed_on(mac):
    """By whom it is for; a packet in the frame is handed up, whatever the protocol."""
    has_turns = mac in ("token-ring", "polling")
    item = Item()
    item.slots = 5
    for span, count in ((3, 0), (3, 1), (4, 1)):
        alone = Alone(mac, decoded=0, heard=0)
        enqueue(alone.station, item, alone.out)
        before = alone.out.count[0]
        frame = plain.make("Frame", fields.FRAME)()
        frame.span, frame.count = span, count
        entry.on_frame(alone.station, alone.params, 1_000, 0, frame, alone.out)
        assert (alone.station.decoded, alone.station.heard) == (1, tree.READ)
        takes = has_turns and span == 3
        assert (alone.station.mode == SEND) == takes
        kinds = [alone.out.action[k].kind for k in range(before, alone.out.count[0])]
        assert kinds.count(DELIVER) == count
        assert (SEND_IT in kinds) == takes


@pytest.mark.parametrize(("queued", "most", "count"), [(0, 2, 0), (1, 0, 0), (1, 2, 1)])
def test_who_hands_the_turn_on_has_sent_what_it_had_and_no_more(queued, most, count):
    """Whatever it sent before that it was not told of; the turn goes on in two slots."""
    alone = Alone("token-ring", count=5)
    for _ in range(queued):
        alone.given(500, PACKET, slots=7)
    passing.grant(alone.station, alone.params, 1_000, 4, most, alone.out)
    station = alone.station
    assert (station.count, station.mode, station.step) == (count, SEND, 4)
    assert station.end == 1_000 + 20 + (2 + 7 * count) * 208
    assert max(frame.span for frame in alone.out.frame) == 5


def test_moments_of_baselines_are_of_a_clock_of_30_bits():
    moments = {name: (low, high) for name, _, low, high, unit, _ in BASELINE if unit == "us"}
    assert set(moments) == {"start", "since", "due", "mark"}
    assert set(moments.values()) == {(0, MASK30)}


def test_a_station_remembers_as_many_packets_as_a_frame_can_have():
    (ours,) = (row[2:4] for row in BASELINE if row[0] == "count")
    assert ours == next(row[2:4] for row in fields.FRAME if row[0] == "count") == (0, 15)


@pytest.mark.parametrize("cd", [0, 1])
def test_who_broke_off_waits_no_longer_than_the_channel_is_busy(cd):
    """As soon as its radio listens again and hears nobody, it may go on: there is no gap."""
    alone = Alone("csma-cd-d1", mode=STOPPED, cd=cd, end=1_000, due=900)
    before = alone.out.count[0]
    contend.ready(alone.station, alone.params, 1_020, alone.out)
    assert alone.station.mode == LISTEN
    asked = alone.out.action[before : alone.out.count[0]]
    assert [(one.kind, one.b) for one in asked] == ([] if cd else [(SET_TIMER, 1_020)])
