"""Links as they are: slow, uneven and lossy; under simulated time, so that seconds cost little."""

import asyncio
import random
from collections import Counter

import pytest

from innervate.live.receipts import DELIVERED
from innervate.networks.mesh.protocol.constants import DATA, REPORT_SUSPECT
from tests.live.net import Mesh
from tests.live.time_by_hand import run

PAIR = [(0, 1)]
DISCOVERY_PER_S = 4  # frames: two requests, a response and tables every 2 s
LINE = [(0, 1), (1, 2)]
BAUD, BITS = 115_200, 10  # on a serial line, of a byte and its start and stop


class SlowMesh(Mesh):
    """A mesh with the profile's own timers, whose cables take their time and lose frames."""

    def __init__(self, count, links, one_way_ms, spread_ms=0.0, loss=0.0, **settings):
        super().__init__(count, links, **{"ack_us": 5000, "e2e_us": 30_000, **settings})
        self.chance = random.Random(1)
        self.one_way_ms, self.spread_ms, self.loss = one_way_ms, spread_ms, loss
        self.carried = 0
        for ends in self.cables.values():
            for path in ends:
                path.take = self.slowly(path.take)

    def slowly(self, take):
        def carry(data):
            self.carried += 1
            if self.chance.random() >= self.loss:
                off_ms = self.chance.uniform(-self.spread_ms, self.spread_ms)
                wait_s = (self.one_way_ms + off_ms) / 1000
                asyncio.get_running_loop().call_later(wait_s, take, data)

        return carry


class SerialMesh(Mesh):
    """A mesh on serial lines: what is sent waits for what was sent before."""

    def __init__(self, count, links):
        super().__init__(count, links, ack_us=5000, e2e_us=30_000)
        self.carried = Counter()
        for ends in self.cables.values():
            for path in ends:
                path.take = self.one_by_one(path.take)

    def one_by_one(self, take):
        free_at = 0.0

        def carry(data):
            nonlocal free_at
            self.carried[data[0] & 15] += 1
            loop = asyncio.get_running_loop()
            free_at = max(free_at, loop.time()) + len(data) * BITS / BAUD
            loop.call_at(free_at, take, data)

        return carry


async def said(mesh, to, count, every_s, back=False, size=2):
    """Of messages from node 0, and back at the same time: states by name, what came how often."""
    ways, heard, receipts = [(0, to), (to, 0)][: 1 + back], Counter(), []
    for _, end in ways:
        mesh.nodes[end].receive_messages(lambda *message: heard.update([message]))
    for k in range(count):
        for begin, end in ways:
            receipts.append(mesh.nodes[begin].send_message(end, k.to_bytes(size, "big")))
        await asyncio.sleep(every_s)
    states = Counter([await receipt.wait() for receipt in receipts])
    return states, heard


@pytest.mark.parametrize("one_way_ms", [0.1, 1, 3, 10, 50, 250])
def test_messages_come_however_long_a_link_takes(one_way_ms):
    async def main():
        async with SlowMesh(2, PAIR, one_way_ms) as mesh:
            await asyncio.sleep(4)
            before = mesh.carried
            every_s = max(0.2, one_way_ms / 250)
            states, heard = await said(mesh, 1, 100, every_s)
            return states, heard, (mesh.carried - before) / (100 * every_s)

    states, heard, frames_per_s = run(main())
    assert states == {DELIVERED: 100}
    assert set(heard.values()) == {1}
    assert len(heard) == 100
    # A message is four frames: itself, its end-to-end ack, an ack of the hop for each.
    assert frames_per_s < 4 * min(5, 250 / one_way_ms) + DISCOVERY_PER_S


def test_an_uneven_link_that_loses_a_fifth_delivers_all():
    async def main():
        async with SlowMesh(2, PAIR, 50, 20, 0.2) as mesh:
            return await said(mesh, 1, 300, 0.2)

    states, heard = run(main())
    assert states == {DELIVERED: 300}
    assert set(heard.values()) == {1}
    assert len(heard) == 300


@pytest.mark.parametrize("one_way_ms", [3, 20])
def test_a_hop_carries_hundreds_a_second_however_long_it_takes(one_way_ms):
    async def main():
        async with SlowMesh(3, LINE, one_way_ms) as mesh:
            await asyncio.sleep(4)
            loop, ends = asyncio.get_running_loop(), Counter()
            end = loop.time() + 2

            async def one_after_the_other():
                while loop.time() < end:
                    ends[await mesh.nodes[0].send_message(2, b"next").wait()] += 1

            await asyncio.gather(*(one_after_the_other() for _ in range(32)))
            return ends

    ends = run(main())
    assert set(ends) == {DELIVERED}
    assert ends[DELIVERED] >= 2 * 200


@pytest.mark.parametrize("one_way_ms", [0.1, 1])
def test_a_quick_link_that_breaks_is_found_out_within_20_ms(one_way_ms):
    async def main():
        async with SlowMesh(2, PAIR, one_way_ms) as mesh:
            await asyncio.sleep(4)
            await said(mesh, 1, 20, 0.01)
            mesh.cut(0, 1)
            loop = asyncio.get_running_loop()
            began, before = loop.time(), mesh.nodes[0].reports[REPORT_SUSPECT]
            mesh.nodes[0].send_message(1, b"into the gap")
            while mesh.nodes[0].reports[REPORT_SUSPECT] == before:
                await asyncio.sleep(0.0005)
            return loop.time() - began

    assert run(main()) <= 0.020


def test_on_a_serial_line_acks_do_not_wait_until_they_were_in_vain():
    async def main():
        async with SerialMesh(2, PAIR) as mesh:
            await asyncio.sleep(4)
            states, heard = await said(mesh, 1, 200, 0.05, back=True, size=64)
            return states, heard, mesh.carried[DATA]

    states, heard, carried = run(main())
    assert states == {DELIVERED: 400}
    assert set(heard.values()) == {1}
    assert len(heard) == 400
    assert carried <= 410
