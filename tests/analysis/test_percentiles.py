"""Percentiles of few values, by the rules that the documentation names."""

import pytest

from innervate.analysis.intervals import quantile
from innervate.analysis.percentiles import percentiles, usual


@pytest.mark.parametrize(("values", "shares", "linear", "nearest"), [
    ([4.0, 1.0], (50, 99, 100), [2.5, 3.97, 4.0], [1.0, 4.0, 4.0]),
    ([7.0], (0, 50, 99), [7.0] * 3, [7.0] * 3),
    ([1.0, 2.0, 3.0, 10.0], (25, 50, 90), [1.75, 2.5, 7.9], [2.0, 3.0, 10.0]),
    ([], (50, 99), [None, None], [None, None]),
])  # fmt: skip
def test_a_percentile_lies_between_two_values_or_is_the_nearest(values, shares, linear, nearest):
    assert percentiles(values, shares) == pytest.approx(linear)
    assert percentiles(values, shares, nearest=True) == nearest
    if values:  # as of sweeps
        assert [quantile(values, share / 100) for share in shares] == pytest.approx(linear)


def test_usually_told_are_the_median_one_that_few_exceed_and_the_greatest():
    told = pytest.approx({"p50": 2.0, "p99": 3.96, "max": 4.0})
    assert usual([4000, 1000, 2000], 1e-3) == told
    assert usual([]) == {"p50": None, "p99": None, "max": None}
