"""When two stations have places of their own."""

import pytest

from innervate.networks.radio.protocol.constants import NONE
from innervate.networks.radio.prove.reports import apart
from innervate.prove.terms import Terms


@pytest.mark.parametrize(("a", "b", "are"), [(1, 2, True), (1, 1, False), (NONE, NONE, True),
                                             (NONE, 0, True), (0, NONE, True),
                                             (0, 0, False)])  # fmt: skip
def test_two_stations_have_no_place_in_common(a, b, are):
    terms = Terms()
    store = {(who, "pos", None): terms.number(place) for who, place in (("a", a), ("b", b))}
    assert apart(terms, store, "a", "b") is terms.truth_of(are)
