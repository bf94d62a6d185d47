"""What is said of many: mutants, one of them missed; why runs failed; long comparisons."""

import json
from types import SimpleNamespace

import polars
import pytest

from innervate.cli import comparing, sweeping, verifying


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
    assert sweeping.failed_lines(failed()) == []
    assert sweeping.failed_lines(failed("cold", "hot", "hot")) == [
        "3 of 6 runs failed:", "  2 x hot", "  1 x cold",
    ]  # fmt: skip
    many = [f"r{i}" for i in range(sweeping.REASONS_MAX + 2)]
    lines = sweeping.failed_lines(failed(*many))
    assert lines[1:-1] == [f"  1 x {one}" for one in many[: sweeping.REASONS_MAX]]
    assert lines[-1] == "  ... and 2 other reasons, see results.parquet"
    exact = sweeping.failed_lines(failed(*many[:-2]))
    assert exact[-1] == f"  1 x {many[sweeping.REASONS_MAX - 1]}"


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
