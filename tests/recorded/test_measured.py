"""What the papers' figures are made of is measured as it was kept: of each kind of run a few, one
seed of each. A table as a whole is measured by test_recorded.py, in minutes.
"""

import json

import pytest

from innervate.papers import book
from innervate.papers.experiment import columns
from tests.recorded import pictures, record

SPREAD = 3  # points of each kind, besides the cheapest
CHEAP_S = 0.1


def is_each(point):
    """True where a function is called for every seed."""
    return getattr(point.work, "func", None) is columns


def cost_s(point):
    """Of one seed, or of all that a point is."""
    return point.cost_s / len(point.work.args[2]) if is_each(point) else point.cost_s


def few(points):
    """The cheapest, and some that differ."""
    first = min(points, key=cost_s)
    cheap = [point for point in points if cost_s(point) <= CHEAP_S]
    step = max(1, len(cheap) // SPREAD)
    return list({point.key: point for point in (first, *cheap[::step][:SPREAD])}.values())


def again(point):
    """What a point gives; of its first seed only where it is of many."""
    if not is_each(point):
        return point.work()
    measure, case, seeds = point.work.args
    return columns(measure, case, seeds[:1])


def kept(point, rows):
    """What was kept of that."""
    row = rows[point.key]
    if not is_each(point):
        return row
    return {name: of[:1] for name, of in row.items()} if isinstance(row, dict) else row[:1]


@pytest.mark.parametrize("system", book.papers())
def test_what_is_measured_is_as_kept(system):
    rows, kinds = record.rows(system), {}
    for experiment in pictures.experiments(system):
        for point in experiment.points(True):
            kinds.setdefault((experiment.name, pictures.call(point)[0]), {})[point.key] = point
    assert len(kinds) >= 9
    for points in kinds.values():
        for point in few(list(points.values())):
            found = json.loads(json.dumps(again(point)))
            assert found == kept(point, rows), point.key
