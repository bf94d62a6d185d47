"""What the benchmark compares with does run, and counts what it says."""

import importlib
import pkgutil

import pytest

import benchmarks
from benchmarks import c_heap, simpy_timeouts

ROOMS = [room.name for room in pkgutil.walk_packages(benchmarks.__path__, "benchmarks.")]


@pytest.mark.parametrize("pending", [1, 7, 1000])
def test_the_c_loop_runs_with_both_heaps(pending):
    if c_heap.compiler() is None:
        pytest.skip("no C compiler")
    result = c_heap.measure(pending, seconds=0.02)
    assert set(result["by_arity"]) == {2, 4}
    assert result["events_per_s"] == max(result["by_arity"].values()) > 1e5


def test_without_a_compiler_there_is_no_figure(monkeypatch):
    monkeypatch.setattr(c_heap, "compiler", lambda: None)
    assert c_heap.measure() is None


def test_simpy_runs():
    pytest.importorskip("simpy")
    assert simpy_timeouts.measure(50, seconds=0.02)["events_per_s"] > 1e4


@pytest.mark.parametrize("room", ROOMS)
def test_every_benchmark_finds_what_it_asks_for(room):
    importlib.import_module(room)
