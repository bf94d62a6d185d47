"""Openings of slow radios end with their packet: whoever had begun too is heard behind it."""

from itertools import product

import pytest

from innervate.networks.radio.protocol.constants import OPEN
from innervate.networks.radio.sim.simulate import simulate
from innervate.scenario.actions.channel import JOIN
from innervate.scenario.declared.channel import Fault
from tests.networks.radio.baseline_runs import SLOT_US
from tests.networks.radio.runs import START_US, radio_plan

TURN_US = 2000
DEAF_US = TURN_US + 104  # from deciding until all hear it


def run(*starts, n=5, seed=1, **more):
    """Stations begin so many us after the first, each with a packet of 5 slots."""
    at = [[START_US + start] for start in starts] + [[]] * (n - len(starts))
    plan = radio_plan(n, 5, TURN_US, seed=seed, arrivals=at, wanted=len(starts), **more)
    return simulate(plan)


def check(result, tries_least):
    counts = result.counts
    assert counts["silent"] == counts["partial"] == 0, result.plan.arrivals
    assert counts["completed"] == result.plan.wanted
    assert result.packets["tries"].min() >= tries_least, result.plan.arrivals


def test_an_opening_is_as_long_as_its_packet():
    result = run(0)
    (opening,) = result.sent[result.sent["kind"] == OPEN]
    assert opening["slots"] == 5
    assert result.packets["end"][0] - START_US == TURN_US + 5 * SLOT_US


@pytest.mark.parametrize("seed", range(1, 4))
def test_of_two_that_begin_before_they_hear_each_other_neither_is_proved(seed):
    """Also where one packet has ended before the other begins, and third stations read both."""
    apart = 0
    for later in range(0, TURN_US + 52, 8):
        result = run(0, later, seed=seed)
        check(result, 2)
        apart += later > 6 * SLOT_US
    assert apart > 50


@pytest.mark.parametrize("behind", [None, 2 * SLOT_US])
def test_what_begins_right_at_another_openings_end_had_begun_with_it(behind):
    """Its carrier never went; with a third behind it nobody could read what began there."""
    for later in range(5 * SLOT_US - 52, 5 * SLOT_US + 53):
        check(run(0, later, *([] if behind is None else [later + behind])), 2)


def test_behind_two_that_overlap_a_third_is_not_proved_for_being_alone():
    for second, third in product(range(0, 900, 100), range(1000, TURN_US, 50)):
        check(run(0, second, third), 2)


def test_of_a_chain_that_begins_within_what_is_heard_none_is_proved():
    for seed in range(1, 60):
        check(run(0, 5 * SLOT_US + 60, TURN_US - 100, n=6, seed=seed), 2)


def test_who_begins_once_it_can_be_heard_waits():
    result = run(0, DEAF_US + 1)
    check(result, 1)
    assert result.packets["tries"].tolist() == [1, 1]


FAR = [(1, 300), (4, 100), (13, 200), (26, 500), (26, 1000)]


@pytest.mark.parametrize(("bit_us", "delay_us"), FAR)
def test_an_opener_proves_nothing_of_who_began_with_it(bit_us, delay_us):
    """Of far stations its radio listens again before their openings come, and reads them whole."""
    away = [[0 if i == j else delay_us for j in range(4)] for i in range(4)]
    for second, third in product(range(1000, TURN_US + delay_us, 97), repeat=2):
        at = [[START_US], [START_US + second], [START_US + third], []]
        plan = radio_plan(4, 3, TURN_US, bit_us=bit_us, delay_us=(delay_us, delay_us),
                          delays_us=away, arrivals=at, wanted=3)  # fmt: skip
        counts = simulate(plan).counts
        assert counts["silent"] == counts["partial"] == 0, at
        assert counts["completed"] == 3


def test_who_switches_on_between_two_that_collide_proves_neither():
    """It may have missed the first, which the second has missed."""
    for later, joins in product(range(1100, 2050, 50), range(0, 7000, 100)):
        on = [Fault(START_US + joins, JOIN, 3)]
        at = [[START_US], [START_US + later], [], []]
        plan = radio_plan(4, 5, TURN_US, arrivals=at, wanted=2, absent=[0, 0, 0, 1], faults=on)
        assert simulate(plan).packets["tries"].tolist() == [2, 2], (later, joins)


def test_a_collision_is_forgotten_however_long_nobody_sends():
    """Clocks of 2^30 us: half of that later everything seems to lie ahead."""
    for pause_s in (1, 500, 560, 900):
        starts = [[START_US], [START_US + 6 * SLOT_US], [START_US + pause_s * 10**6], [], []]
        plan = radio_plan(5, 5, TURN_US, arrivals=starts, wanted=3, duration_s=2000.0)
        result = simulate(plan)
        check(result, 1)
        (tries,) = result.packets[result.packets["node"] == 2]["tries"]
        assert tries == 1, pause_s
