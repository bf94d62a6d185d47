"""Messages longer than a frame: whole, once, in order, or told; under simulated time."""

import random

import pytest

from innervate.live.receipts import DELIVERED
from tests.live import time_by_hand as live_time
from tests.live.net import Mesh

LINE = [(0, 1), (1, 2)]


def lossy(mesh, share, seed=1):
    """Frames are lost on all cables, by a seed."""
    chance = random.Random(seed)
    for a, b in mesh.cables.values():
        for path in (a, b):
            path.take = lambda data, take=path.take: chance.random() < share or take(data)


def listening(node, in_order=True):
    got = []
    node.receive_messages(lambda sender, data: got.append((sender, data)), in_order=in_order)
    return got


def run(story, *given):
    return live_time.run(story(*given))


@pytest.mark.parametrize(("size", "mtu"), [(91, 127), (65_536, 1200), (5000, 64), (164, 127)])
@pytest.mark.parametrize("in_order", [False, True])
def test_a_long_message_arrives_whole(size, mtu, in_order):
    payload = random.Random(size).randbytes(size)

    async def main():
        async with Mesh(3, LINE, mtu=mtu) as mesh:
            got = [listening(mesh.nodes[2], kind) for kind in (False, True)]
            told = await mesh.nodes[0].send_message(2, payload, in_order=in_order).wait()
            return told, got, mesh.nodes[2].status()["in_pieces"]

    told, got, left = run(main)
    assert told == DELIVERED
    assert got == [[(0, payload)]] * 2
    assert left == {"messages": 0, "bytes": 0}


def test_where_frames_are_lost_all_arrive_once_and_in_order():
    async def main():
        async with Mesh(3, LINE) as mesh:
            got = listening(mesh.nodes[2])
            lossy(mesh, 0.2)
            sizes = [10, 3000, 20, 88, 89, 1000, 30]
            sent = [bytes([k]) * size for k, size in enumerate(sizes)]
            receipts = [mesh.nodes[0].send_message(2, one, in_order=True) for one in sent]
            told = [await receipt.wait() for receipt in receipts]
            return told, sent, [data for _, data in got]

    told, sent, got = run(main)
    assert told == [DELIVERED] * len(sent)
    assert got == sent
