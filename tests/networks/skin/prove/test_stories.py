"""Two cells that close a ring where a rule or its condition is given up."""

import pytest

from innervate.network import networks
from innervate.networks.skin.invariants import is_worse
from innervate.networks.skin.protocol.constants import RULE_FEASIBLE, RULE_PAPER_LAX
from innervate.networks.skin.prove import stories, theories
from innervate.prove.check import check
from innervate.prove.theory import prove


def outcomes():
    claims = theories.theories(networks()["skin"])
    return {claim.name: prove(claim) for claim in claims if claim.is_example}


def test_paper_and_strict_with_a_restarted_pc_are_refuted_in_sentences():
    found = outcomes()
    assert all(outcome.is_as_expected for outcome in found.values())
    refuted = {name: one for name, one in found.items() if one.is_refuted}
    assert set(refuted) == {"skin, rule paper", "skin, rule paper-lax",
                            "skin, rule strict, the PC restarts"}  # fmt: skip
    for outcome in refuted.values():
        (bad,) = outcome.checked[0].refuted
        assert len(bad.sentences) in (5, 6)
    story = refuted["skin, rule strict, the PC restarts"].checked[0].refuted[0].sentences
    assert "counts from 1" in story[2]
    assert "6 is newer than 1" in story[3]


@pytest.mark.parametrize(("rule", "closes"), [(RULE_FEASIBLE, False), (RULE_PAPER_LAX, True)])
def test_the_same_two_cells_under_other_rules(rule, closes):
    assert bool(check(stories.both_lose(None, rule)()).refuted) == closes


def test_the_simulators_checker_knows_the_order_that_is_proved():
    class Cell:
        def __init__(self, sq, dist):
            self.fd_known, self.fd_sq, self.fd_dist, self.parent = 1, sq, dist, 0

    assert is_worse(Cell(3, 2), Cell(65_535, 9)) is False
    assert is_worse(Cell(65_535, 9), Cell(3, 2)) is True
    assert is_worse(Cell(3, 2), Cell(3, 2)) is False
