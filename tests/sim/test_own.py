"""What a network says itself: invariants, which is broken first, by whom; what messages are."""

from types import SimpleNamespace as Of

import pytest

from innervate.scenario.cables import Happening, Input
from innervate.sim import own
from innervate.sim.own import OWN_BROKEN, check_of, message_times, words_of


def low(state, params, now):
    return state.value >= params.least


def even(state, params, now):
    return state.value % 2 == 0 and now < 100


def checked(value, now=50, **run):
    world = Of(run=[Of(**{"checks": 1, "broken": 0, "broken_node": -1} | run)],
               stations=[Of(value=0), Of(value=value)], params=[Of(least=0)])  # fmt: skip
    check_of([low, even], "stations")(world, 1, now)
    return world.run[0].broken, world.run[0].broken_node


@pytest.mark.parametrize(("value", "now", "run", "found"), [
    (4, 50, {}, (0, -1)), (-2, 50, {}, (OWN_BROKEN, 1)), (3, 50, {}, (OWN_BROKEN + 1, 1)),
    (4, 100, {}, (OWN_BROKEN + 1, 1)), (-3, 50, {}, (OWN_BROKEN, 1)),  # the first of two
    (-3, 50, {"checks": 0}, (0, -1)), (-3, 50, {"broken": 2, "broken_node": 7}, (2, 7)),
])  # fmt: skip
def test_the_first_invariant_that_does_not_hold_is_noted(value, now, run, found):
    assert checked(value, now, **run) == found


def test_each_is_told_by_its_title_and_its_number(monkeypatch):
    titles = {"a value is too low": low, "a value is odd": even}
    monkeypatch.setattr(
        own, "invariants_of", lambda network, name: titles if name == "node_" else {}
    )
    monkeypatch.setattr(own, "networks", lambda: {"mine": None})
    assert words_of("mine") == {
        OWN_BROKEN: "a value is too low: {node}", OWN_BROKEN + 1: "a value is odd: {node}",
    }  # fmt: skip


def test_without_invariants_there_is_nothing_to_check():
    world = Of(run=[Of(checks=1, broken=0)], cells=[None], params=[None])
    check_of([], "cells")(world, 0, 0)
    assert world.run[0].broken == 0


@pytest.mark.parametrize(("fields", "times"), [
    (Of(), [20, 30, 30]), (Of(MESSAGES=(1,)), [20, 30]), (Of(MESSAGES=()), []),
])  # fmt: skip
def test_inputs_are_messages_but_of_kinds_that_are_none_and_own_words(monkeypatch, fields, times):
    monkeypatch.setattr(own, "networks", lambda: {"geo": Of(fields=fields)})
    inputs = [Input(30, 0, 1, {}), Input(20, 1, 1, {}), Input(30, 1, 2, {}),
              Happening(40, 1, 1, {})]  # fmt: skip
    assert message_times(Of(kind="geo", inputs=inputs)) == times
