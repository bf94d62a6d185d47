"""Packets of a station: how long they may be, how many wait, and what becomes of each."""

import pytest

from innervate.dialect.access import PACKET, QUEUE, REPORT_DELIVERED
from innervate.live.channel import SLOT_US_MIN
from innervate.live.errors import LiveError
from innervate.live.receipts import ACCEPTED, DELIVERED, REFUSED
from innervate.networks.radio import frames as wire
from innervate.networks.radio.live import node as nodes
from innervate.networks.radio.live import words
from innervate.networks.radio.live.node import RadioNode
from innervate.networks.radio.live.parameters import RADIO, check_slots
from innervate.networks.radio.live.stack import Frame, StationStack


class Radio:
    mode = "listening"


class Engine:
    """Keeps what is handed down, as it is then."""

    def __init__(self):
        self.told, self.counters = [], {}

    def input(self, kind, item):
        self.told.append((kind, item.slots, item.handle))


@pytest.fixture
def station():
    made = RadioNode("s3", StationStack(3, RADIO, 7), Radio())
    made.engine = Engine()
    return made


@pytest.mark.parametrize(("size", "slots"), [(0, 3), (1, 3), (2, 4), (18, 20)])
def test_a_packet_lasts_as_many_slots_as_it_has_bytes_and_two_and_three_at_least(
    station, size, slots
):
    receipt = station.send_packet(bytes(size))
    assert (receipt.state, station.engine.told) == (ACCEPTED, [(PACKET, slots, 0)])
    assert station.outcomes == {"packets accepted": 1}


def test_a_packet_that_is_too_long_one_too_many_and_one_too_early(station):
    with pytest.raises(TypeError, match="a payload is bytes, not str"):
        station.send_packet("text")
    with pytest.raises(ValueError, match="payload of 19 bytes; a packet holds 18"):
        station.send_packet(bytes(19))
    station.stack.station.queued = QUEUE
    refused = station.send_packet(b"full")
    assert (refused.state, refused.reason) == (REFUSED, "queue full")
    station.stack.station.queued = QUEUE - 1
    assert station.send_packet(b"last").state == ACCEPTED
    station.engine = None
    refused = station.send_packet(b"early")
    assert (refused.state, refused.reason) == (REFUSED, "node not started")
    assert station.outcomes == {"packets accepted": 1}


def test_packets_are_delivered_in_the_order_they_went_and_handles_go_round(station, monkeypatch):
    monkeypatch.setattr(nodes, "HANDLES", 4)
    station._handle = 3
    receipts = [station.send_packet(bytes([k])) for k in range(3)]
    assert [handle for _, _, handle in station.engine.told] == [3, 0, 1]
    frame = Frame()
    frame.handle, frame.count, frame.kind = 3, 2, wire.DATA
    packed = station.packed(frame)
    assert wire.payload_of(packed) == b"\x00\x01"
    station._reported(REPORT_DELIVERED, 3, 2)
    assert [receipt.state for receipt in receipts] == [DELIVERED, DELIVERED, ACCEPTED]
    assert list(station._packets) == [1]
    station._reported(REPORT_DELIVERED + 1, 1, 1)
    assert receipts[2].state == ACCEPTED
    assert station.outcomes == {"packets accepted": 3, "packets delivered": 2}


def test_what_comes_in_is_handed_up_with_its_sender(station):
    heard, frame = [], Frame()
    station.receive_packets(lambda *one: heard.append(one))
    frame.kind, frame.source = wire.DATA, 9
    station.heard = wire.encode(frame, b"here")
    station._deliver(0, frame)
    station.arrivals.hand_up()
    assert heard == [(9, b"here")]
    assert station.outcomes == {"packets received": 1}


def test_a_station_in_a_line_and_its_status(station):
    station.stack.station.pos = -1
    told = station.status()
    assert (told["place"], told["number"], told["timing"]["slot_us"]) == (None, 3, 10_000)
    assert words.lines(told) == ["  place in the round: none, packets queued 0"]
    assert words.lines({**told, "place": 0, "queued": 2}) == [
        "  place in the round: 0, packets queued 2"
    ]
    assert words.ports(told) == []
    station.stack.station.pos = 0
    assert station.status()["place"] == 0
    assert station.status()["radio"] == "listening"


def test_slots_are_as_long_as_a_pc_can_keep():
    check_slots({"slot_us": SLOT_US_MIN})
    with pytest.raises(LiveError, match=r"protocol\.slot_us = 1999: a PC keeps slots of 2000 us"):
        check_slots({"slot_us": SLOT_US_MIN - 1})
