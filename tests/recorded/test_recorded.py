"""Bundled scenarios, examples and the papers' tables give what was recorded, number by number.

A change that is meant to alter runs records anew: python -m tests.recorded.record
"""

import pytest

from innervate.papers import book
from tests.recorded import record

SOURCES = record.sources()
QUICK = ("line", "loop-three", "setup-4", "demo", "radio-disaster", "mesh-field")


def recorded(name):
    """One recorded summary."""
    return record.recorded_runs()[name]


def test_everything_that_runs_is_recorded():
    assert set(record.recorded_runs()) == set(SOURCES)


def test_a_difference_is_named_with_both_values():
    kept = {"a": 1, "b": {"c": 2.0, "d": None}, "f": 1}
    found = {"a": 1, "b": {"c": 2.5, "e": []}, "f": 1.0}
    assert record.differences("run", kept, found) == [
        "run.b.c: was 2.0, is 2.5",
        "run.b.d: was None, is '(nothing)'",
        "run.b.e: was '(nothing)', is []",
        "run.f: was 1, is 1.0",
    ]


@pytest.mark.parametrize("name", QUICK)
def test_a_run_is_as_recorded(name):
    assert not record.differences(name, recorded(name), record.measure(SOURCES[name]))


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(set(SOURCES) - set(QUICK)))
def test_every_run_is_as_recorded(name):
    assert not record.differences(name, recorded(name), record.measure(SOURCES[name]))


@pytest.mark.slow
@pytest.mark.parametrize("name", record.PLAIN)
def test_a_plain_run_is_as_recorded(name):
    found = record.measure(SOURCES[name], plain=True)
    assert not record.differences(name, recorded(name), found)


@pytest.mark.slow
@pytest.mark.parametrize("system", book.papers())
def test_a_papers_table_is_as_recorded(system, tmp_path):
    kept = (record.TABLES / f"{system}.csv").read_text(encoding="utf-8")
    assert not record.differences(
        system, record.rows_of(kept), record.rows_of(record.table(system, tmp_path))
    )
