"""The issue's bars with the real numbers of seeds: one test, so that the paper is run only once."""

import pytest

from innervate.papers.experiment import FAILS, HOLDS

# Figure and words of its claims: those that have to hold, and those that must not.
MUST_HOLD = (
    ("fig5", "exactly (k+3) T"),
    ("fig5", "exactly 3 T"),
    ("fig6", ""),
    ("fig8a", "asked for"),
    ("fig8a", "detection within"),
    ("fig10", ""),
    ("fig11", ""),
    ("loop", "strict (F1) and feasible (F2)"),
    ("modes", "asked for"),
    ("modes", "of the floor"),
    ("modes", "no cell on a longer way"),
)
MUST_FAIL = (
    ("eq7", "ceil(h/2)"),
    ("eq9", "0.6 %"),
    ("loop", "guarantee a loop-free"),
)


@pytest.mark.slow
def test_what_holds_and_what_does_not(whole):
    wrong = []
    for expected, rows in ((HOLDS, MUST_HOLD), (FAILS, MUST_FAIL)):
        for name, words in rows:
            found = [claim for claim in whole.claims[name] if words in claim.claim]
            assert found, words
            wrong += [claim for claim in found if not claim.verdict.startswith(expected)]
    for name in ("fig8a", "eq7"):
        found = [claim for claim in whole.claims[name] if "rule feasible" in claim.measurement]
        assert found
        wrong += [claim for claim in found if not claim.verdict.startswith(HOLDS)]
    assert wrong == []
