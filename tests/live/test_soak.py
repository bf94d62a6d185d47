"""Cuts, heals, restarts and other keys for a long time: nothing leaks, nothing is lost silently."""

import asyncio
import gc
import os
import random
import time
from collections import Counter
from pathlib import Path

import pytest

from innervate.live.keys import Sealer, ring_of
from innervate.live.receipts import DELIVERED, EXPIRED
from innervate.live.state import State
from tests.live.net import Mesh

GRID = [
    (0, 1),
    (1, 2),
    (3, 4),
    (4, 5),
    (6, 7),
    (7, 8),
    (0, 3),
    (3, 6),
    (1, 4),
    (4, 7),
    (2, 5),
    (5, 8),
]
KEYS = {1: bytes(32), 2: bytes(range(32))}


def memory_kib():
    gc.collect()
    return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 1024


async def soak(seconds, seed):
    """Messages all the time; what became of them, errors of the loop, memory after each tenth."""
    chance, errors, sizes = random.Random(seed), [], []
    asyncio.get_running_loop().set_exception_handler(lambda _, context: errors.append(context))
    heard, receipts, outcomes = Counter(), [], Counter()
    mesh = Mesh(9, GRID)
    for i, node in enumerate(mesh.nodes):
        node.sealer = Sealer(ring_of("mesh", KEYS, 1), i, State(None))
        node.receive_messages(lambda _, payload: heard.update([payload]))
    async with mesh:
        began, sent, cut = time.monotonic(), 0, None
        while time.monotonic() - began < seconds:
            a, b = chance.sample(range(9), 2)
            receipts.append(mesh.nodes[a].send_message(b, sent.to_bytes(4, "big")))
            sent += 1
            if sent % 40 == 0:
                if cut is not None:
                    mesh.cut(*cut, cut=False)
                cut = chance.choice(GRID) if cut is None else None
                if cut is not None:
                    mesh.cut(*cut)
            if sent % 150 == 0:
                use = 3 - mesh.nodes[0].sealer.ring.use
                for node in mesh.nodes:
                    node.sealer.load_keys(KEYS, use)
            if len(receipts) >= 200:
                outcomes.update([await receipt.wait() for receipt in receipts])
                receipts.clear()
            if time.monotonic() - began > (len(sizes) + 1) * seconds / 10:
                sizes.append(memory_kib())
            await asyncio.sleep(0.004)
        if cut is not None:
            mesh.cut(*cut, cut=False)
        outcomes.update([await receipt.wait() for receipt in receipts])
        counters = sum((node.counters() for node in mesh.nodes), Counter())
        under_way = [node.status()["under_way"] for node in mesh.nodes]
    return sent, heard, outcomes, errors, sizes, counters, under_way


def check(seconds, seed):
    sent, heard, outcomes, errors, sizes, counters, under_way = asyncio.run(soak(seconds, seed))
    assert not errors
    assert max(heard.values()) == 1
    assert sum(outcomes.values()) == sent == counters["messages accepted"]
    assert set(outcomes) <= {DELIVERED, EXPIRED}
    assert outcomes[DELIVERED] == counters["messages delivered"]
    assert outcomes[DELIVERED] <= len(heard) <= sent
    assert outcomes[DELIVERED] >= 0.999 * sent
    assert under_way == [0] * 9
    return sizes


def test_a_short_soak():
    check(4.0, seed=1)


@pytest.mark.slow
def test_ten_minutes_and_no_leak():
    sizes = check(600.0, seed=2)
    assert sizes[-1] - sizes[2] < 2048  # KiB; what is remembered has bounds
