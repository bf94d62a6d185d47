"""Openings that begin all but together: nobody takes for delivered what not all have got."""

import pytest

from tests.networks.radio.aimed import RANGES, search

RUNS = 300


@pytest.mark.parametrize("of", RANGES)
def test_of_openings_aimed_at_each_other_none_is_proved_too_soon(of):
    found, where = search(of, range(1, RUNS + 1))
    assert found["packets"] > 4 * RUNS
    assert not where, found
