"""What is assumed of turns is so in plans; that they are proved is in tests/cli/test_prove.py."""

from tests.networks.radio.runs import radio_plan


def test_plans_give_dead_turns_as_long_as_is_assumed():
    for turnaround_us in (0, 2000):
        params = radio_plan(3, ta=turnaround_us).params
        most = 2 * params["ta_us"] + 3 * params["dmax_us"] + params["minislot_us"]
        assert params["dmin_us"] <= params["dmax_us"]
        assert params["dead_us"] >= most
