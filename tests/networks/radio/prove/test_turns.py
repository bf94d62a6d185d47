"""What is proved of turns, of stations that heard the same frames."""

from innervate.network import networks
from innervate.networks.radio.protocol.constants import WIDE_MOST
from innervate.networks.radio.prove import theories, turns
from innervate.prove.theory import prove
from tests.networks.radio.runs import radio_plan

RADIO = networks()["radio"]


def test_only_one_takes_a_turn_and_alone():
    claim = theories.theories(RADIO)[1]
    outcome = prove(claim)
    assert [bad.goal for one in outcome.checked for bad in one.refuted] == []
    assert outcome.is_as_expected
    assert outcome.lemmas == 7 + 2 * (WIDE_MOST + 1)
    assert outcome.as_dict()["assumed"] == list(turns.ASSUMED)


def test_plans_give_dead_turns_as_long_as_is_assumed():
    for turnaround_us in (0, 2000):
        params = radio_plan(3, ta=turnaround_us).params
        most = 2 * params["ta_us"] + 3 * params["dmax_us"] + params["minislot_us"]
        assert params["dmin_us"] <= params["dmax_us"]
        assert params["dead_us"] >= most
