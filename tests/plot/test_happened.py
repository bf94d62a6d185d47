"""What is said of events where a network has no words of its own: a sentence, as skins have it."""

import pytest

from innervate.plot.happened import event_words
from innervate.scenario import from_dict, plan

CABLE = {"link": "n0-n1"}


@pytest.mark.parametrize(("kind", "event", "words"), [
    ("babel", {"action": "kill", "node": 3}, "node n3 switched off"),
    ("babel", {"action": "revive", "node": 3}, "node n3 switched on again"),
    ("babel", {"action": "restart", "node": 3}, "node n3 restarted"),
    ("babel", {"action": "cut", **CABLE}, "cable n0 E - n1 W cut"),
    ("babel", {"action": "restore", **CABLE}, "cable n0 E - n1 W put back"),
    ("babel", {"action": "loose", "loss": 0.25, **CABLE}, "cable n0 E - n1 W loose, losing 25 %"),
    ("babel", {"action": "loose", "loss": 0.0, **CABLE}, "cable n0 E - n1 W tight again"),
    ("babel", {"action": "lose", "frames": 1, **CABLE}, "cable n0 E - n1 W loses 1 frame"),
    ("flooding", {"action": "kill", "node": 2}, "node 2 switched off"),
    ("flooding", {"action": "revive", "node": 2}, "node 2 switched on again"),
    ("flooding", {"action": "restart", "node": 2}, "node 2 restarted"),
    ("flooding", {"action": "cut", "node": 0, "other": 1}, "link node 0 - node 1 cut"),
    ("flooding", {"action": "restore", "node": 0, "other": 1}, "link node 0 - node 1 restored"),
    ("flooding", {"action": "jam", "node": 1, "noise_dbm": -60.5},
     "noise of -60.5 dBm at node 1"),
    ("flooding", {"action": "quiet", "node": 1}, "no noise at node 1 any more"),
])  # fmt: skip
def test_each_thing_that_can_happen_is_a_sentence(kind, event, words):
    made = plan(
        from_dict({"kind": kind, "nodes": 4, "duration_s": 2.0, "event": [{"at_s": 1.0, **event}]})
    )
    assert event_words(made, made.faults[0]) == words
