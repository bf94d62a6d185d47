"""Faults that are planted in the live stack are found."""

import pytest

from tests.livesim import faults


def test_every_text_that_is_replaced_stands_once():
    counts = {one.what: faults.source_of(one.module).count(one.old) for one in faults.FAULTS}
    assert {what: count for what, count in counts.items() if count != 1} == {}
    assert len(counts) >= 20


@pytest.mark.slow
def test_every_fault_is_found():
    assert faults.main([]) == 0
