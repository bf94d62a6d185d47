"""Networks over cables in which nothing happens but what users say."""

import pytest

import innervate
from innervate.analysis.headline import DOWN
from tests.own import alone, made, plain

__all__ = ["alone", "plain"]
LATE = [{"at_s": 0.3, "node": 0, "item": {"value": 7}}]


@pytest.fixture
def gossip(alone, plain):
    return made(alone / "gossip", "cables")


def test_what_nobody_is_there_to_hear_counts_as_not_delivered(gossip):
    """All die before the first word, and nothing moves the clock from then on."""
    dead = [{"at_s": 0.0, "action": "kill", "node": node} for node in range(6)]
    found = innervate.run(gossip.scenario, overrides={"input": LATE, "event": dead}).summary
    assert (found["events"], found["messages"]["sent"]) == (0, 1)
    assert found["headline"] == {"level": DOWN, "text": "All 6 nodes are off."}


def test_what_nobody_hands_on_counts_as_not_delivered(gossip):
    head, does = "def {}(node, params, now, {}out):", '\n    """Nothing."""\n    node.version = 0\n'
    gossip.rewrite("on_start", head.format("on_start", "cause, ") + does)
    gossip.rewrite("on_input", head.format("on_input", "kind, item, ") + does)
    found = innervate.run(gossip.scenario, overrides={"input": LATE, "event": []}).summary
    assert found["headline"] == {"level": DOWN, "text": "The only message was not delivered."}
