"""What is said of many: mutants, one of them missed; why runs failed; long comparisons."""

import json
import signal
from pathlib import Path
from types import SimpleNamespace

import polars
import pytest

from innervate.cli import comparing, errors, verifying
from innervate.running import fuzz
from innervate.sweeping import words


@pytest.mark.parametrize(("by", "code"), [(("a", "b"), 0), (("a", ""), 1), (("", ""), 1)])
def test_a_mutant_that_is_missed_is_1(monkeypatch, capsys, by, code):
    mutants = [SimpleNamespace(name=f"m{i}") for i in range(len(by))]

    def hunt(mutant):
        found = by[mutants.index(mutant)]
        return SimpleNamespace(mutant=mutant, by=found, where="line" if found else "")

    monkeypatch.setattr(verifying, "_hunts", lambda _system: [(one, hunt) for one in mutants])
    assert verifying._mutants("skin", False) == code
    said = capsys.readouterr().out.splitlines()
    assert said == [f"m{i}: {f'{one} (line)' if one else 'NOT CAUGHT'}" for i, one in enumerate(by)]
    assert verifying._mutants("skin", True) == code
    assert [one["by"] for one in json.loads(capsys.readouterr().out)] == list(by)
    assert verifying._mutants("skin", False, count=1) == (0 if by[0] else 1)
    assert capsys.readouterr().out.splitlines() == said[:1]


def failed(*reasons):
    """A sweep whose runs failed so, and as many more that did not."""
    why = polars.DataFrame({"reason": reasons}, schema={"reason": str})
    return SimpleNamespace(failed=why, results=polars.DataFrame({"point": range(2 * len(reasons))}))


def test_reasons_why_runs_failed_are_counted_the_most_frequent_first():
    assert words.failed_lines(failed()) == []
    assert words.failed_lines(failed("cold", "hot", "hot")) == [
        "3 of 6 runs failed:", "  2 x hot", "  1 x cold",
    ]  # fmt: skip
    many = [f"r{i}" for i in range(words.REASONS_MAX + 2)]
    lines = words.failed_lines(failed(*many))
    assert lines[1:-1] == [f"  1 x {one}" for one in many[: words.REASONS_MAX]]
    assert lines[-1] == "  ... and 2 other reasons, see results.parquet"
    exact = words.failed_lines(failed(*many[:-2]))
    assert exact[-1] == f"  1 x {many[words.REASONS_MAX - 1]}"


def test_long_comparisons_end_and_long_keys_do_not_push_values_away(capsys):
    most = comparing.DIFFERENCES_MAX
    comparing._print("Summary", [(f"k{i:02}", i, None) for i in range(most + 1)])
    lines = capsys.readouterr().out.splitlines()
    assert lines[1] == "  k00  0 -> not set"
    assert (len(lines), lines[-1]) == (most + 2, "  ... and 1 more")
    comparing._print("Summary", [(f"k{i:02}", i, None) for i in range(most)])
    assert len(capsys.readouterr().out.splitlines()) == most + 1
    comparing._print("Summary", [("a" * 50, 1, 2), ("b", 0.1234567, 3)])
    assert capsys.readouterr().out.splitlines()[2] == f"  {'b':<40}  0.123457 -> 3"


@pytest.fixture
def attempts(monkeypatch):
    """Numbers of networks that were tried: from 12 on they break; at the third Ctrl-C comes."""
    tried = []

    def attempt(seed):
        tried.append(seed)
        if seed == 3:
            signal.raise_signal(signal.SIGINT)
        return fuzz.Broken(seed, "a loop", {}, 7) if seed >= 12 else None

    monkeypatch.setattr(fuzz, "attempt", attempt)
    monkeypatch.setattr(fuzz.Broken, "save", lambda self, folder: folder / f"{self.seed}.toml")
    return tried


@pytest.mark.parametrize(("seed", "count", "first", "last"), [
    (None, 2, 1, 2), (0, 2, 0, 1), (5, 1, 5, 5), (10, 2, 10, 11),
])  # fmt: skip
def test_so_many_networks_are_tried_from_a_seed_on(attempts, capsys, seed, count, first, last):
    for as_json in (False, True):
        assert verifying.search(seed, count, as_json, None) == 0
    assert attempts == [*range(first, last + 1)] * 2
    words, told = capsys.readouterr().out.splitlines()
    many = "1 network, 5" if count == 1 else f"{count} networks, {first} to {last}"
    assert words == f"Nothing broken in {many}."
    assert json.loads(told) == {"first": first, "networks": count, "broken": None}


@pytest.mark.parametrize(("out", "file"), [(None, Path("runs/12.toml")), ("o", Path("o/12.toml"))])
def test_the_first_network_that_breaks_is_the_last(attempts, capsys, out, file):
    for as_json in (False, True):
        assert verifying.search(10, 0, as_json, out and Path(out)) == 1
    assert attempts == [10, 11, 12] * 2
    *words, told = capsys.readouterr().out.splitlines()
    assert words == ["Network 12 breaks: a loop",
                     f"Made smaller in 7 tries. Play it: innervate run {file}",
                     "As drawn: innervate verify --random --seed 12 --count 1"]  # fmt: skip
    assert json.loads(told) == {"first": 10, "networks": 3, "broken": "a loop", "seed": 12,
                                "file": str(file)}  # fmt: skip


def test_who_is_stopped_has_tried_what_was_under_way(attempts, capsys):
    assert verifying.search(3, 5, False, None) == errors.INTERRUPTED
    assert verifying.search(3, 1, False, None) == 0  # that was all
    assert attempts == [3, 3]
    assert capsys.readouterr().out == "Nothing broken in 1 network, 3.\n" * 2
