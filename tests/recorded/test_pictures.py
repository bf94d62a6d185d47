"""Pictures are drawn as they were recorded: of runs, of papers (of kept rows), of no run at all.

A change that is meant to draw something else records anew: python -m tests.recorded.pictures, after
a look at what --show leaves.
"""

import pytest

from innervate.papers import book
from tests.recorded import pictures, record


@pytest.mark.parametrize("group", pictures.GROUPS)
def test_pictures_are_as_recorded(group):
    kept = pictures.recorded(group)
    lost, names = [], []
    for name, draw in pictures.GROUPS[group]():
        names.append(name)
        found = pictures.text_of(draw())
        lost += pictures.differences(name, kept.get(name, {}), found)
    assert lost == []
    assert names == list(kept)


@pytest.mark.parametrize("system", book.books())
def test_claims_on_kept_rows_are_as_recorded(system):
    table = (record.TABLES / f"{system}.csv").read_text(encoding="utf-8")
    rows = [claim for claims in pictures.judged(system).values() for claim in claims]
    found = pictures.output.as_csv(rows)
    assert not record.differences(system, record.rows_of(table), record.rows_of(found))
