"""The explorer can fail: it finds small mistakes in the protocol, and nothing in it as it is."""

import pytest

from innervate.networks.skin.verify import mutants

QUICK = (
    "the feasible distance is set once only",
    "older is newer",
    "the distance does not grow",
    "the feasible distance keeps its first number",
)


@pytest.mark.parametrize("name", QUICK)
def test_a_mutant_is_caught(name):
    catch = mutants.hunt(next(m for m in mutants.MUTANTS if m.name == name))
    assert catch.by


@pytest.mark.slow
@pytest.mark.parametrize("mutant", [m for m in mutants.MUTANTS if m.name not in QUICK], ids=str)
def test_every_mutant_is_caught(mutant):
    assert mutants.hunt(mutant).by


@pytest.mark.slow
def test_the_protocol_as_it_is_passes():
    text = mutants.MUTANTS[-1].old
    same = mutants.Mutant("none", text, text)
    assert mutants.hunt(same).by == ""


def test_there_are_enough_mutants():
    assert len({mutant.name for mutant in mutants.MUTANTS}) == len(mutants.MUTANTS) >= 20


def test_a_text_that_is_not_there_is_no_mutant():
    with pytest.raises(ValueError, match="stands 0 times"):
        mutants.copy_of(mutants.Mutant("none", "no such text", ""))
