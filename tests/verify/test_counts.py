"""What an exploration says of itself: how many states, successors, events deep, how it ended.

Two nodes that have nothing to flood count their own ticks, each round a ring of 64 states: what a
search of them finds is known beforehand.
"""

from types import SimpleNamespace

import pytest

from innervate.network import networks
from innervate.running.exploring import USUAL

RING = 64  # states of a node that is left alone
ALONE = "loss=0,restart=0,input=0"


def explored(states, tell=lambda *_: False, graph="pair"):
    asked = SimpleNamespace(**USUAL | {"graph": graph, "budget": ALONE, "states": states})
    network = networks()["flooding"]
    (one,) = network.verify.explorations(network, asked)
    return one(tell)


def test_all_states_of_two_that_do_not_meet():
    told = []
    case = explored(0, lambda *said: bool(told.append(said)))
    pairs = RING**2
    expected = {
        "states": pairs, "expanded": pairs, "generated": 2 * pairs, "left_out": 0,
        "depth": 2 * (RING - 1), "ended": "complete", "broken": None, "story": None,
    }  # fmt: skip
    assert case.record == {"graph": case.record["graph"], **expected}
    assert case.is_complete
    assert [said[1:] for said in told] == [(0, 0)] * (pairs // 500)
    # Of the first 63 levels, level d has d + 1 states.
    events = [int(what.split()[-3]) for what, _, _ in told]
    assert events[:4] == [31, 44, 54, 62]


@pytest.mark.parametrize("limit", [2, 10, 300])
def test_a_search_ends_with_the_state_that_is_one_too_many(limit):
    found = explored(limit)
    record = found.record
    assert (record["ended"], found.is_complete) == ("limit", False)
    assert limit <= record["states"] <= limit + 1
    assert record["generated"] == 2 * record["expanded"]
    # So many levels are whole; who stands on the next has been found from the one before.
    depth = record["depth"]
    assert depth * (depth + 1) // 2 < record["expanded"] <= (depth + 1) * (depth + 2) // 2


def test_a_search_that_is_ended_early_says_so():
    case = explored(0, lambda *_: True)
    assert (case.record["ended"], case.record["expanded"]) == ("interrupted", 500)
    assert not case.is_complete
    assert not case.is_broken
