"""What is tried on the skin's protocol; what finds it is in tests/verify/test_mutants.py."""

import pytest

from innervate.networks.skin.verify import mutants


def test_there_are_enough_mutants():
    assert len(mutants.MUTANTS) >= 20


def test_a_text_that_is_not_there_is_no_mutant():
    with pytest.raises(ValueError, match="stands 0 times"):
        mutants.copy_of(mutants.Mutant("none", "no such text", ""))
