"""What is proved of a skin, and that it is refuted where the protocol is wrong."""

import pytest

from innervate.network import networks
from innervate.networks.skin.prove import feasible, theories
from innervate.networks.skin.prove.neighbours import TICKS
from innervate.prove.check import check
from innervate.prove.errors import ProveError
from innervate.prove.faults import faults_of, hunt
from innervate.prove.mutants import Mutant
from tests.prove.outcomes import held

SKIN = networks()["skin"]
# Of the explorer's; those of MUTANTS are in tests/networks/skin/verify/test_assumptions.py, and all
# are tried in `make full`.
QUICK = (
    "penalties grow beyond 2",
    "the PC says that it is a hop away",
    "every neighbour is told that it is the parent",
)


@pytest.mark.parametrize("number", range(3))
def test_every_claim_holds_and_no_branch_is_left_out(number):
    outcome = held(theories.theories(SKIN)[number])
    assert len({way for one in outcome.checked for way in one.reached}) > 15


def fault(name):
    return next(one for one in faults_of(SKIN) if one.name == name)


@pytest.mark.parametrize("name", QUICK)
def test_a_mistake_is_refuted(name):
    _, goal = hunt(SKIN, fault(name))
    assert goal, name


@pytest.mark.slow
@pytest.mark.parametrize("one", faults_of(SKIN), ids=lambda one: one.name)
def test_every_mistake_is_refuted(one):
    _, goal = hunt(SKIN, one)
    assert goal, one.name


def test_a_refuted_step_is_told_of_two_cells():
    wrong = fault("who has a route does not ask the rule at its tick")
    tick = next(one for one in feasible.steps((wrong.old, wrong.new)) if TICKS in one.args)
    claim = theories.theories(SKIN)[1]
    step = tick()
    step.goals = [goal for goal in step.goals if goal.name.startswith("I5")]
    found = check(step, claim.tell, claim.simple(step), reach=False)
    (story,) = [bad.sentences for bad in found.refuted]
    assert story[0].startswith("Cell A: ")
    assert "cell B: feasible distance" in story[1]
    assert story[-1] == "This breaks: I5 fd is strictly worse than the parent's."


def test_a_mistake_that_is_nowhere_is_no_mistake():
    with pytest.raises(ProveError, match="in no source"):
        hunt(SKIN, Mutant("x", "cell.fd_dist = distance_of_nobody", "pass"))
