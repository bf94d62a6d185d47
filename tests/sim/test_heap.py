"""The queue of a channel: the smallest key first, whatever comes in between; what keys say."""

import heapq
import random
from types import SimpleNamespace

import numpy as np
import pytest

from innervate.sim import heap
from innervate.sim.channel.world import Heap
from innervate.sim.queue import first_of, with_command


@pytest.mark.parametrize("seed", range(12))
def test_the_smallest_comes_first_whatever_is_put_in_between(seed):
    draw = random.Random(seed)
    mine, other = Heap([0] * 200, [0]), []
    for _ in range(600):
        key = draw.randrange(40)
        what = draw.random()
        if what < 0.45 and len(other) < 200:
            heap.push(mine, key)
            heapq.heappush(other, key)
        elif what < 0.75 and other:
            assert mine.keys[0] == heapq.heappop(other)
            heap.pop(mine)
        elif other:
            assert mine.keys[0] == heapq.heapreplace(other, key)
            heap.replace(mine, key)
        assert mine.size[0] == len(other)
        assert sorted(mine.keys[: len(other)]) == sorted(other)
    while other:
        assert mine.keys[0] == heapq.heappop(other)
        heap.pop(mine)
    assert mine.size[0] == 0


def test_keys_are_in_order_of_time_then_rank_then_station_then_what():
    most = (1 << heap.STATION_SHIFT) - 1
    events = [
        (time, rank, station, what)
        for time in (0, 1, heap.TIME_MAX - 1) for rank in range(7)
        for station in (0, 1, heap.STATIONS_MAX - 1) for what in (0, 1, most)
    ]  # fmt: skip
    keys = [heap.key_of(*event) for event in events]
    assert keys == sorted(set(keys))
    assert keys[-1] < heap.LAST < 1 << 63
    assert (heap.AIRS, heap.STATIONS_MAX) == (8, 1024)


def test_the_time_of_the_first_event():
    queue = Heap([heap.key_of(77, 6, 1023, 5)], [1])
    assert first_of(queue) == 77
    queue.size[0] = 0
    assert first_of(queue) is None


class World(SimpleNamespace):
    def _replace(self, **changes):
        return World(**{**vars(self), **changes})


@pytest.mark.parametrize(("at", "place", "is_next"), [
    (5, 2, True), (20, 2, True), (30, 3, False), (35, 3, False), (40, 4, False), (99, 4, False),
])  # fmt: skip
def test_a_command_goes_behind_those_of_its_moment(at, place, is_next):
    """Of four commands two are done; the table has room for more than there are."""
    commands = np.zeros(6, [("at", np.int64), ("action", np.int64)])
    commands["at"][:4] = (10, 20, 30, 40)
    commands["action"][:4] = 1
    run = np.zeros(1, [("commands", np.int64), ("next_command", np.int64)])
    run["commands"], run["next_command"] = 4, 2
    made, found = with_command(World(run=run, commands=commands), "at", (at, 2))
    assert made.commands["action"].tolist() == [1] * place + [2] + [1] * (4 - place)
    assert made.commands["at"][place] == at
    assert int(run["commands"][0]) == 5
    assert found == is_next
