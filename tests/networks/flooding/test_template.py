"""The scenario that somebody starts from: something is sent in it, and arrives."""

from innervate import run, scenario
from innervate.network import networks


def test_what_new_writes_sends_and_all_of_it_is_delivered():
    made = scenario.loads(scenario.template("flooding"))
    plan = scenario.plan(made)
    assert "warning" not in networks()["flooding"].describe(plan)
    done = run(made)
    assert done.summary["messages"]["delivered"] == len(plan.inputs) == 5
