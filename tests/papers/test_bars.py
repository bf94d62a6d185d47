"""The issue's bars, with the real numbers of seeds; the whole paper is run once."""

import pytest

from innervate.papers.experiment import FAILS, HOLDS

pytestmark = pytest.mark.slow


def claims(whole, name, words):
    found = [claim for claim in whole.claims[name] if words in claim.claim]
    assert found
    return found


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("fig5", "exactly (k+3) T"),
        ("fig5", "exactly 3 T"),
        ("fig8a", "asked for"),
        ("fig8a", "detection within"),
        ("fig10", "asked for"),
        ("modes", "asked for"),
        ("modes", "of the floor"),
        ("modes", "no cell on a longer way"),
        ("fig11", ""),
    ],
)
def test_what_must_hold(whole, name, words):
    for claim in claims(whole, name, words):
        assert claim.verdict.startswith(HOLDS), claim


def test_what_the_errata_say_does_not_hold(whole):
    for name, words in (
        ("loop", "guarantee a loop-free"),
        ("eq9", "0.6 %"),
        ("eq7", "ceil(h/2)"),
    ):
        for claim in claims(whole, name, words):
            assert claim.verdict == FAILS, claim


def test_feasible_is_inside_the_bands(whole):
    for name in ("fig8a", "eq7"):
        for claim in whole.claims[name]:
            if "feasible" in claim.measurement:
                assert claim.verdict.startswith(HOLDS), claim
