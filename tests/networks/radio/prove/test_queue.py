"""What is proved of a radio station, and that mistakes in it are refuted."""

import pytest

from innervate.network import networks
from innervate.networks.radio.prove import theories
from innervate.prove.faults import faults_of, hunt
from innervate.prove.theory import prove

RADIO = networks()["radio"]


def test_what_waits_in_the_queue_stays_there():
    claim = theories.theories(RADIO)[0]
    outcome = prove(claim)
    assert [bad.goal for one in outcome.checked for bad in one.refuted] == []
    assert outcome.is_as_expected


QUICK = ("a full queue takes another", "who is not named takes the turn")
FAULTS = [pytest.param(one, id=one.name, marks=[] if one.name in QUICK else pytest.mark.slow)
          for one in faults_of(RADIO)]  # fmt: skip


@pytest.mark.parametrize("fault", FAULTS)
def test_a_mistake_is_refuted(fault):
    assert hunt(RADIO, fault)[1], fault.name


def test_drawn_calls_leave_the_same_state():
    assert [one.calls(300, 1) for one in theories.twins()] == ["", ""]


@pytest.mark.slow
@pytest.mark.parametrize("number", range(2))
def test_a_hundred_thousand_drawn_calls_do(number):
    assert theories.twins()[number].calls(50_000, 2) == ""
