"""What is proved of a network that says nothing of proofs."""

import pytest

from innervate.network import networks
from innervate.prove.theory import prove


@pytest.fixture
def outcome():
    ring = networks()["tokenring"]
    (theory,) = ring.prove.theories(ring)
    return prove(theory)


def test_all_that_can_leave_its_range_is_found(outcome):
    """A node hands on more tokens than it declares, after the 200th."""
    refuted = {bad.goal: bad for one in outcome.checked for bad in one.refuted}
    assert set(refuted) == {"every field stays in its declared range: state.passed"}
    (bad,) = refuted.values()
    assert bad.values["state.passed"] == 200
    assert "state.passed 200" in bad.sentences[0]
    assert "state.passed 201" in bad.sentences[2]


def test_every_branch_is_reached(outcome):
    assert outcome.unreached == []
    assert len({way for one in outcome.checked for way in one.reached}) == 8
