"""A compiled loop over worlds of tables, which it is lent."""

import sys
from collections import namedtuple
from concurrent.futures import ThreadPoolExecutor
from functools import partial

import numpy as np
import pytest

from innervate.kernel import compilation
from innervate.kernel.tables import Lending

World = namedtuple("World", "counts seen")
KIND = np.dtype([("count", np.int64)], align=True)


def counting(world, until, budget):
    for _ in range(budget):
        world.counts[0].count += until
    world.seen[len(world.seen) - 1] += 1


def a_world(length, kind=np.int64):
    return World(np.zeros(1, KIND), np.zeros(length, kind))


@pytest.fixture(scope="module")
def loop():
    return Lending(compilation.compiled(counting))


def told(world):
    return int(world.counts["count"][0]), world.seen.tolist()


def test_each_call_is_of_the_world_that_it_is_given(loop):
    """By turns, one with longer tables in its place, one of other numbers, none at all."""
    one, other, narrow = a_world(2), a_world(3), a_world(2, np.int32)
    loop(one, 5, 2)
    loop(other, 1, 1)
    loop(one, 1, 1)
    loop(narrow, np.int32(2), np.int16(1))  # of whatever kind numbers are
    grown = one._replace(seen=np.zeros(4, np.int64))
    loop(grown, 100, 1)
    loop(one, 1, 0)
    assert told(one) == (111, [0, 3])
    assert told(grown) == (111, [0, 0, 0, 1])
    assert told(other) == (1, [0, 0, 1])
    assert told(narrow) == (2, [0, 1])
    assert len(loop.compiled.overloads) == 2


def test_threads_have_worlds_of_their_own(loop, request):
    request.addfinalizer(partial(sys.setswitchinterval, sys.getswitchinterval()))
    sys.setswitchinterval(1e-6)
    worlds = [a_world(1) for _ in range(4)]

    def run(world):
        for _ in range(2000):
            loop(world, 1, 1)

    with ThreadPoolExecutor(len(worlds)) as threads:
        list(threads.map(run, worlds))
    assert [told(world) for world in worlds] == [(2000, [2000])] * len(worlds)


def test_a_table_needs_its_memory_in_one_piece(loop):
    with pytest.raises(ValueError, match="contiguous"):
        loop(World(np.zeros(1, KIND), np.zeros(4, np.int64)[::2]), 1, 1)
