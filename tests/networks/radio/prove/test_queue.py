"""A station's queue beside its formula; that it is proved is in tests/cli/test_prove.py."""

import pytest

from innervate.networks.radio.prove import theories


def test_drawn_calls_leave_the_same_state():
    assert [one.calls(300, 1) for one in theories.twins()] == ["", ""]


@pytest.mark.slow
@pytest.mark.parametrize("number", range(2))
def test_a_hundred_thousand_drawn_calls_do(number):
    assert theories.twins()[number].calls(50_000, 2) == ""
