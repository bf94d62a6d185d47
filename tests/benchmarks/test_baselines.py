"""What the benchmark compares with does run, and counts what it says."""

import importlib
import pkgutil

import pytest

import benchmarks.live.__main__
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


@pytest.mark.parametrize("option", ["--shapes", "--sides", "--faults"])
def test_a_name_that_is_none_is_refused_with_those_that_are(option, monkeypatch, capsys):
    monkeypatch.setattr("sys.argv", ["benchmarks.live", option, "nonsense"])
    with pytest.raises(SystemExit) as ended:
        benchmarks.live.__main__.main()
    assert ended.value.code == 2
    assert f'argument {option}: no "nonsense"; there are ' in capsys.readouterr().err
