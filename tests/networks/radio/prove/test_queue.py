"""A station's queue beside its formula; that it is proved is in tests/cli/test_prove.py."""

import pytest

from tests.networks.radio.prove import twins


def test_drawn_calls_leave_the_same_state():
    assert [one.calls(300, 1) for one in twins.twins()] == ["", ""]


@pytest.mark.slow
@pytest.mark.parametrize("number", range(2))
def test_a_hundred_thousand_drawn_calls_do(number):
    assert twins.twins()[number].calls(50_000, 2) == ""


DELAYS = ("least_delay", "most_delay", "guard", "turn_timeout")  # the others take long to make


@pytest.mark.parametrize("name", DELAYS)
def test_drawn_calls_of_what_turns_rest_on_leave_the_same_state(name):
    assert twins.turn_twin(name).calls(300, 1) == ""


def test_a_formula_of_another_wait_differs():
    wrong = ("+ 4 * most_delay(params, wide) + minislot(params, wide)", "+ minislot(params, wide)")
    assert "in the formula" in twins.turn_twin("turn_timeout", wrong).calls(300, 1)


@pytest.mark.slow
@pytest.mark.parametrize("name", twins.TURNS)
def test_many_drawn_calls_of_what_turns_rest_on_do(name):
    assert twins.turn_twin(name).calls(15_000, 2) == ""
