import asyncio
from itertools import pairwise

import pytest

from innervate.live.channel import SLOT_US, Medium
from innervate.live.channel_radio import MediumRadio
from innervate.live.engine import clock_us
from innervate.live.receipts import ACCEPTED, DELIVERED
from innervate.networks.radio import frames as wire
from innervate.networks.radio.live.node import RadioNode
from innervate.networks.radio.live.parameters import RADIO, radio_parameters
from innervate.networks.radio.live.stack import Frame, StationStack
from innervate.networks.radio.protocol.constants import DATA
from innervate.networks.radio.scenario.plan import parameters
from tests.live import time_by_hand
from tests.live.net import until

STATIONS = 5
# Slow enough that a busy machine keeps up: a slot of 20 ms, 10 ms to turn round.
SLOW = parameters(20, 10_000, (1, 8000), bit_us=2500)


def test_the_profile_follows_from_slot_and_turnaround():
    assert parameters(20, 5000, (1, 3000), bit_us=SLOT_US // 8) == RADIO


def test_five_stations_that_collide_send_in_the_order_that_they_reserved():
    async def main():
        medium = Medium(SLOW["slot_us"], SLOW["ta_us"])
        where = medium.open(("127.0.0.1", 0))
        params = radio_parameters({key: SLOW[key] for key in RADIO})
        heard, nodes = [], []
        for i in range(STATIONS):
            stack = StationStack(i, params, 1_000_003 * (i + 1) ** 5 + 77)
            node = RadioNode(f"s{i}", stack, MediumRadio(i, where))
            await node.start()
            node.receive_packets(lambda source, payload, i=i: heard.append((i, source, payload)))
            nodes.append(node)
        idle = SLOW["join_us"] / 1e6
        await asyncio.sleep(2 * idle)  # a radio channel has no event for "nobody sends"
        receipts = [node.send_packet(b"from %d" % i) for i, node in enumerate(nodes)]
        await until(lambda: all(receipt.state == DELIVERED for receipt in receipts), 30)
        for node in nodes:
            await node.stop()
        medium.close()
        return medium, heard

    medium, heard = asyncio.run(main())
    assert medium.collisions >= STATIONS - 1  # all of them sent at once
    turns = []
    for start, end, station, data in medium.log:
        frame = Frame()
        assert wire.decode(data, frame) == wire.OK
        if frame.kind == DATA:
            turns.append((start, end, station, frame.pos))
    first = turns[:STATIONS]
    assert [pos for *_, pos in first] == list(range(STATIONS))
    assert sorted(station for _, _, station, _ in first) == list(range(STATIONS))
    for (_, end, *_), (start, *_) in pairwise(first):
        assert end < start
    got = {(i, source) for i, source, payload in heard if payload == b"from %d" % source}
    assert got == {(i, k) for i in range(STATIONS) for k in range(STATIONS) if i != k}


def test_a_packet_that_is_too_long_is_refused():
    stack = StationStack(0, radio_parameters({}), 5)
    node = RadioNode("s", stack, MediumRadio(0, ("127.0.0.1", 9)))
    with pytest.raises(ValueError, match="a packet holds 18"):
        node.send_packet(bytes(19))


def test_a_station_whose_aerial_is_out_neither_hears_nor_is_heard():
    async def main():
        medium = Medium(SLOW["slot_us"], SLOW["ta_us"])
        where = medium.open(("127.0.0.1", 0))
        params = radio_parameters({key: SLOW[key] for key in RADIO})
        heard = []
        nodes = [RadioNode(f"s{i}", StationStack(i, params, 97 + i), MediumRadio(i, where))
                 for i in range(3)]  # fmt: skip
        for i, node in enumerate(nodes):
            await node.start()
            node.receive_packets(lambda source, _payload, i=i: heard.append((i, source)))
        await until(lambda: all(node.paths[0].heard_at for node in nodes), 10)
        nodes[0].path_at(0).cut = True
        others = nodes[1].send_packet(b"all")
        await until(lambda: others.state == DELIVERED, 30)
        alone = nodes[0].send_packet(b"nobody")
        await until(lambda: nodes[0].outcomes["frames sent"] > 0, 30)
        assert not nodes[0].status()["paths"][0]["up"]
        assert set(heard) == {(2, 1)}
        assert alone.state != DELIVERED
        assert {station for *_, station, _ in medium.log} == {1, 2}
        nodes[0].path_at(0).cut = False
        await until(lambda: alone.state == DELIVERED, 60)
        for node in nodes:
            await node.stop()
        medium.close()
        return heard

    assert {(1, 0), (2, 0)} <= set(asyncio.run(main()))


class Air:
    """A radio that notes what it is to send."""

    mode = "listening"
    sent = ()

    async def start(self, listener):
        listener.on_carrier(clock_us(), False, False)

    def send(self, at, data, slots):
        self.sent = (*self.sent, (at, slots))

    def stop(self):
        pass


@pytest.mark.parametrize(("is_lost", "state"), [(False, DELIVERED), (True, ACCEPTED)])
def test_an_answer_proves_nothing_of_a_packet_that_was_not_on_the_air(is_lost, state):
    async def main():
        air = Air()
        node = RadioNode("s0", StationStack(0, RADIO, 7), air)
        await node.start()
        await asyncio.sleep(5.0)
        receipt = node.send_packet(b"here")
        await asyncio.sleep(0.001)
        ((at, slots),) = air.sent
        listens = at + slots * RADIO["slot_us"] + 2 * RADIO["ta_us"]
        await asyncio.sleep((listens - clock_us()) / 1e6)
        (node.on_lost if is_lost else node.on_carrier)(listens, False, False)
        begin, end = listens + 1_000, listens + 1_000 + RADIO["slot_us"]
        await asyncio.sleep((end - clock_us()) / 1e6)
        node.on_carrier(begin, True, True)  # somebody answers somebody else
        node.on_frame(end, bytes([wire.CRR_BYTE]))
        node.on_carrier(end, False, False)
        found = receipt.state
        await asyncio.sleep(2.0)
        assert len(air.sent) > 1  # it goes on, with the packet or without
        await node.stop()
        return found

    assert time_by_hand.run(main()) == state
