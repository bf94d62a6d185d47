"""Whom a baseline's packet has to reach, and what DCF keeps free for the answer."""

import pytest

from innervate.networks.radio.scenario.baselines import TOLD_OF, Granted, baseline
from innervate.networks.radio.scenario.plan import RadioFault
from innervate.networks.radio.sim.simulate import simulate
from innervate.scenario import summary
from innervate.scenario.actions.channel import KILL
from innervate.scenario.given import load
from tests.networks.radio.baseline_runs import SLOT_US, TAU_US
from tests.networks.radio.runs import START_US, radio_plan

TURN_US = 2000
APART_US = 6 * SLOT_US  # packets of 5 slots do not overlap; 9.6 slots pass before one is heard


def offered(mac="dcf", at=(0, APART_US), n=3, told="everybody", answers="instant", **more):
    """The first stations have a packet each, so many us behind the first."""
    starts = [[START_US + later] for later in at] + [[]] * (n - len(at))
    plan = radio_plan(n, 5, TURN_US, protocol=mac, arrivals=starts, wanted=len(at),
                      real=(TAU_US, TAU_US), **more)  # fmt: skip
    plan.params = baseline(mac, n, plan.params, granted=Granted(told, answers))
    return plan


def run(*args, **more):
    return simulate(offered(*args, **more), plain=True)


@pytest.mark.parametrize("mac", ["dcf", "csma-cd-d2", "csma-cd-d2p"])
def test_two_that_collide_only_for_each_other(mac):
    """Each decides before it can hear the other, and is deaf while the other's packet passes."""
    anybody = run(mac, told="anybody")
    assert anybody.packets["receivers"].tolist() == [1, 1]
    assert anybody.packets["tries"].tolist() == [1, 1]
    assert anybody.counts["partial"] == 2
    everybody = run(mac)
    assert everybody.packets["receivers"].tolist() == [2, 2]
    assert everybody.packets["tries"].max() > 1
    assert everybody.counts["partial"] == everybody.counts["silent"] == 0
    assert everybody.counts["again"] > 0  # the third has one twice


def test_who_does_not_hear_a_sender_or_is_off_is_not_waited_for():
    hidden = offered(at=(0,))
    hidden.delays_us[0][2] = hidden.delays_us[2][0] = -1
    dead = offered(at=(0,), faults=[RadioFault(START_US // 2, KILL, 2, 0, 0)])
    for plan in (hidden, dead):
        result = simulate(plan, plain=True)
        assert result.packets["tries"].tolist() == result.packets["receivers"].tolist() == [1]


def test_alone_nobody_has_it():
    assert run(n=1, at=(0,), duration_s=2.0).counts["completed"] == 0


@pytest.mark.parametrize("told", TOLD_OF)
def test_frame_errors_are_made_good_only_if_all_must_have_a_packet(told):
    found = run(at=tuple(range(0, 900_000, 90_000)), n=10, told=told, loss_q15=6000, duration_s=9.0)
    assert found.counts["completed"] == 10
    assert (found.counts["partial"] == 0) == (told == "everybody")


SWITCHED_US = 2 * (TURN_US + TAU_US) + SLOT_US


@pytest.mark.parametrize(
    ("answers", "kept"), [("instant", 2 * SLOT_US), ("turnaround", SWITCHED_US)]
)
def test_a_receiver_answers_a_sifs_behind_the_end_and_others_leave_time_for_it(answers, kept):
    """IEEE 802.11-1999, 9.2.8; DIFS passes behind the answer, or behind a frame nobody could read.

    The second packet comes while the first is on the air.
    """
    plan = offered(at=(0, TURN_US + 2 * SLOT_US), answers=answers)
    assert plan.params["answer_us"] == kept
    plan.params["cw_min"] = 1  # no backoff
    first, second = simulate(plan, plain=True).sent["time"].tolist()
    gap = plan.params["gap_us"]
    assert second - (first + 5 * SLOT_US) == TAU_US + gap + kept + TURN_US


def test_only_dcf_keeps_time_for_answers():
    params = radio_plan(3, 5, TURN_US).params
    assert baseline("tdma", 3, params, granted=Granted(answers="turnaround"))["answer_us"] == 0


def said(mac, **protocol):
    tables = {"kind": "radio", "stations": 3, "protocol": {"mac": mac, **protocol}}
    return next(line for line in summary(load(tables)).splitlines() if "protocol" in line)


def test_check_says_what_is_taken_for_received():
    assert said("dcf").endswith(
        "dcf, a packet counts as received once anybody has it, time for its answers: without a "
        "turnaround"
    )
    here = said("dcf", received_by="everybody", answers="turnaround")
    assert "everybody has it, time for its answers: a turnaround there and back" in here
    assert said("tdma").endswith("tdma")
    assert said("tdma", received_by="everybody").endswith("once everybody has it")
