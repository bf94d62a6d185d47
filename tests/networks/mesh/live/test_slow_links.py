"""Links as they are: slow, uneven and lossy; under simulated time, so that seconds cost little."""

import asyncio
import random
from collections import Counter

import pytest

from innervate.live.receipts import DELIVERED
from innervate.networks.mesh.protocol.constants import REPORT_SUSPECT
from tests.live.net import Mesh
from tests.live.time_by_hand import run

PAIR = [(0, 1)]
DISCOVERY_PER_S = 4  # frames: two requests, a response and tables every 2 s
LINE = [(0, 1), (1, 2)]


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


async def said(mesh, to, count, every_s):
    """Of messages from node 0: states by name, and what came how often."""
    heard = Counter()
    mesh.nodes[to].receive_messages(lambda _, payload: heard.update([payload]))
    receipts = []
    for k in range(count):
        receipts.append(mesh.nodes[0].send_message(to, k.to_bytes(2, "big")))
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
