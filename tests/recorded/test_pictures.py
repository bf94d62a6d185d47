"""Pictures are drawn as they were recorded: of runs, of papers (of kept rows), of no run at all.

A change that is meant to draw something else records anew: python -m tests.recorded.pictures, after
a look at what --show leaves.
"""

import pytest

from innervate.papers import book
from tests.recorded import pictures, record

PAPERS = [group for group in pictures.GROUPS if group.startswith("papers")]
# What a paper draws is drawn of kept rows at once, each by itself; runs are drawn together.
OF_PAPERS = [(group, name) for group in PAPERS for name in pictures.recorded(group)]


@pytest.mark.parametrize("group", sorted(pictures.GROUPS.keys() - PAPERS))
def test_pictures_are_as_recorded(group):
    kept = pictures.recorded(group)
    lost, names = [], []
    for name, draw in pictures.GROUPS[group]():
        names.append(name)
        found = pictures.text_of(draw())
        lost += pictures.differences(name, kept.get(name, {}), found)
    assert lost == []
    assert names == list(kept)


@pytest.mark.parametrize("group", PAPERS)
def test_all_of_a_paper_is_recorded(group):
    assert [name for name, _ in pictures.GROUPS[group]()] == list(pictures.recorded(group))


@pytest.mark.parametrize(("group", "name"), OF_PAPERS)
def test_a_papers_picture_is_as_recorded(group, name):
    found = pictures.text_of(dict(pictures.GROUPS[group]())[name]())
    assert pictures.differences(name, pictures.recorded(group)[name], found) == []


@pytest.mark.parametrize("system", book.books())
def test_claims_on_kept_rows_are_as_recorded(system):
    table = (record.TABLES / f"{system}.csv").read_text(encoding="utf-8")
    rows = [claim for claims in pictures.judged(system).values() for claim in claims]
    found = pictures.output.as_csv(rows)
    assert not record.differences(system, record.rows_of(table), record.rows_of(found))
