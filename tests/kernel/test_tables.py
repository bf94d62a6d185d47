"""A compiled loop over worlds of tables, which it is lent."""

import sys
from collections import namedtuple
from concurrent.futures import ThreadPoolExecutor
from functools import partial

import numpy as np
import pytest
from numba.core import compiler

from innervate.kernel import compilation, records
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


Records = namedtuple("Records", "near far counts")
DECLARED = (("low", 0, -9, 9, "", ""), ("row", 3, -9, 9, "", ""), ("high", 0, 0, 9, "", ""))


def added(value, more):
    return value + more


def moved(record, more):
    record.low = added(record.low, more)
    for i in range(len(record.row)):
        record.row[i] = added(record.row[i], record.high)


def moving(world, until, budget):
    for i in range(len(world.near)):
        moved(world.near[i], budget)
        moved(world.far[i], until)
        record = world.far[i]
        record.high = added(record.high, 1)
        world.counts[i] = added(world.counts[i], record.low)


@pytest.fixture
def compiles(monkeypatch):
    """Names of the functions that are compiled, each as often as it is."""
    found, compile_extra = [], compiler.CompilerBase.compile_extra

    def noted(self, function):
        found.append(function.__name__)
        return compile_extra(self, function)

    monkeypatch.setattr(compiler.CompilerBase, "compile_extra", noted)
    return found


def test_fields_are_read_and_written_where_they_lie_and_a_function_is_compiled_once(
    compiles, tmp_path, monkeypatch
):
    """In records with and without padding; whoever calls it, with numbers of 32 bits or of 64."""
    monkeypatch.setenv("INNERVATE_CACHE", str(tmp_path))
    compilation.register_functions(added, moved, hot=True)
    near, far = records.zeros(DECLARED, 2), records.zeros(DECLARED, 2, itemsize=64)
    for each in (near, far):
        each["low"], each["row"], each["high"] = [-3, 4], [[1, -2, 3], [-4, 5, -6]], [7, 8]
    world = Records(near, far, np.array([-100, 100], np.int32))
    Lending(compilation.compiled_as_one(moving))(world, 2, 1)
    assert near["low"].tolist() == [-2, 5]
    assert far["low"].tolist() == [-1, 6]
    for each in (near, far):
        assert each["row"].tolist() == [[8, 5, 10], [4, 13, 2]]
    assert (near["high"].tolist(), far["high"].tolist()) == ([7, 8], [8, 9])
    assert world.counts.tolist() == [-101, 106]
    assert [compiles.count(name) for name in ("moving", "moved", "added")] == [1, 1, 1]
