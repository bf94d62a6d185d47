"""The scenario that somebody starts from: something is sent in it, and arrives."""

from innervate import run, scenario
from innervate.network import networks


def test_what_new_writes_sends_and_all_of_it_is_delivered():
    made = scenario.loads(scenario.template("flooding"))
    plan = scenario.plan(made)
    assert "warning" not in networks()["flooding"].describe(plan)
    done = run(made)
    assert done.summary["messages"]["delivered"] == len(plan.inputs) == 5
    headline = done.summary["headline"]
    assert headline["level"] == "ok"
    assert headline["text"].startswith("All 5 messages are delivered once, ")
    assert headline["text"].endswith(" receptions are lost.")


def test_a_flood_that_does_not_come_that_far_is_told_as_a_loss():
    """Without a hop from the corner nobody but its neighbours hears it."""
    done = run(scenario.loads(scenario.template("flooding").replace("hops      = 3", "hops = 0")))
    assert done.summary["headline"]["level"] == "down"
    assert done.summary["headline"]["text"] == "None of 5 messages was delivered."
