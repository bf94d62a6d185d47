"""Bundled scenarios, examples and the papers' tables give what was recorded, number by number.

A change that is meant to alter runs records anew: python -m tests.recorded.record
"""

import random

import pytest

from innervate.papers import book
from innervate.papers.store import Store
from innervate.trace.sources import stamp
from tests.recorded import record

SOURCES = record.sources()
# What compares runs loops that no other test wants.
FIGURES = [pytest.param(name, figure, marks=[pytest.mark.slow] * (name == book.COMPARE))
           for name in book.books() for figure in book.book_of(name).FIGURES]  # fmt: skip
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


def test_last_digits_of_floats_do_not_count_and_no_more_than_those():
    kept = {"busy_s": [0.1, {"share": 0.3}], "fingerprint": "00ff"}
    assert record.differences("run", kept, {**kept, "busy_s": [0.1, {"share": 0.1 + 0.2}]}) == []
    for other in ([0.1, {"share": 0.3 + 1e-9}], [0.1], [0.1, {}]):
        assert len(record.differences("run", kept, {**kept, "busy_s": other})) == 1
    assert len(record.differences("run", kept, {**kept, "fingerprint": "00fe"})) == 1


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


def points(system, figure):
    """A figure's pieces of work in its small size, those with the cheapest seeds first."""
    found = book.book_of(system).experiment(figure).points(True)
    return sorted(found, key=lambda point: (record.seed_cost_s(point), point.key))


@pytest.mark.parametrize("system", book.books())
def test_every_piece_of_a_papers_work_is_recorded(system):
    figures = book.book_of(system).FIGURES
    wanted = {point.key for figure in figures for point in points(system, figure)}
    assert set(record.rows(system)) == wanted


@pytest.mark.parametrize(("system", "figure"), FIGURES)
def test_what_is_run_again_of_a_figure_is_as_recorded(system, figure):
    cheap = points(system, figure)
    cheap = cheap[: (len(cheap) + 1) // 2]
    drawn = random.Random(figure).choice(cheap)
    for point in {cheap[0].key: cheap[0], drawn.key: drawn}.values():
        found, kept = record.once_more(point, record.rows(system)[point.key])
        assert not record.differences(point.key, kept, found)


@pytest.mark.slow
@pytest.mark.parametrize("system", book.books())
def test_a_papers_table_and_rows_are_as_recorded(system, tmp_path):
    kept = (record.TABLES / f"{system}.csv").read_text(encoding="utf-8")
    found = record.table(system, tmp_path)
    assert not record.differences(system, record.rows_of(kept), record.rows_of(found))
    values = Store(tmp_path / book.RESULTS, stamp()).values
    assert not record.differences(system, record.rows(system), values)
