"""CSMA/CD-R as published, in trouble: deaths, newcomers, lost reports, unequal delays, errors."""

import pytest

from innervate.networks.radio.protocol.constants import (
    CRR,
    DATA,
    OUTSIDER,
    REPORT_COLLISION,
    REPORT_ROLE,
)
from innervate.networks.radio.scenario.plan import RadioFault
from innervate.networks.radio.sim.simulate import simulate
from innervate.scenario.actions.channel import FADE, GARBLE, JOIN, KILL
from tests.networks.radio.paper_runs import (
    BIT,
    R1,
    R2,
    R3,
    R4,
    R5,
    SEEDS,
    SLOT,
    TAU,
    aired,
    figure_1,
    is_ordered,
    natural,
    order,
    paper,
    said,
)
from tests.networks.radio.runs import START_US


# Q9, "when only a robot breaks down, the next robot does not share information" is what the
# protocol is to do better than a ring.
def test_q9_a_reporter_that_dies_is_replaced_and_the_last_packet_is_lost_silently():
    result = figure_1((6300, KILL, R2, 0), wanted=3)
    g = 2 * TAU + BIT
    at = 6552 + g + 416
    first_end = at + SLOT + TAU
    assert aired(result, CRR) == [
        (R3, at, at + SLOT),
        (R4, first_end + 1040, first_end + 1040 + SLOT),
    ]
    opens = first_end + 5200 - SLOT
    assert aired(result, DATA)[4:] == [
        (R4, opens, opens + 5200),
        (R3, opens + 5200 + TAU, opens + 10400 + TAU),
    ]
    lost = result.packets[result.packets["receivers"] == 0]
    assert lost["node"].tolist() == [R1]
    assert result.counts["silent"] == 1


def test_q9_the_last_dies_and_the_others_keep_their_turns():
    result = figure_1((6500, KILL, R1, 0), wanted=3)
    assert aired(result, DATA)[4:] == aired(figure_1(), DATA)[4:7]
    assert result.counts["silent"] == 0


def test_q9_a_turn_of_the_dead_passes_after_four_tau():
    result = figure_1((12000, KILL, R3, 0), wanted=3)
    turn = 17056 + TAU + 4 * TAU
    assert aired(result, DATA)[5:] == [
        (R2, turn, turn + 5200),
        (R1, turn + 5200 + TAU, turn + 10400 + TAU),
    ]


# N2: a packet cut short is one that cannot be read.
@pytest.mark.parametrize("after", [500, 2600, 5100])
def test_q9_who_dies_in_its_turn_has_had_it(after):
    at = 17160 + after
    result = figure_1((at, KILL, R3, 0), wanted=3)
    turn = at + TAU + 2 * TAU + BIT
    assert aired(result, DATA)[6:] == [
        (R2, turn, turn + 5200),
        (R1, turn + 5200 + TAU, turn + 10400 + TAU),
    ]


def test_q9_who_dies_after_its_turn_changes_nothing():
    assert aired(figure_1((17100, KILL, R4, 0), wanted=3), DATA) == aired(figure_1(), DATA)


@pytest.mark.parametrize("node", [R1, R2, R3, R4])
def test_q9_whenever_somebody_dies_the_others_get_through(node):
    for at in range(5 + 397 * (node % 2), 34_000, 794):
        result = figure_1((at, KILL, node, 0), wanted=0, duration_s=0.5)
        alive = {R1, R2, R3, R4} - {node}
        assert alive <= set(result.packets["node"].tolist()), at
        assert result.counts["silent"] <= 1, at


# Q7, "Any node can use a communication channel at anytime"
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_q7_a_packet_that_comes_in_a_resolution_is_served_last(seed):
    starts = natural(4, seed=seed).plan.arrivals
    for at in range(200 + 331 * seed, 32_000, 993):
        arrivals = [*starts, [START_US + TAU + at]]
        result = paper(5, seed=seed, arrivals=arrivals)
        assert order(result)[-1] == R5, at
        assert len(aired(result, DATA)) == 9, at
        assert said(result, REPORT_ROLE)[R5] == [(OUTSIDER, 0)]


# Q10, "a robot can be added or removed without any bad influence on the distributed robot system"
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_q10_who_joins_in_a_resolution_is_served_last(seed):
    starts = natural(4, seed=seed).plan.arrivals
    for at in range(200 + 331 * seed, 32_000, 993):
        when = START_US + TAU + at
        result = paper(
            5,
            seed=seed,
            arrivals=[*starts, [when]],
            absent=[0, 0, 0, 0, 1],
            faults=[RadioFault(when, JOIN, R5, 0, 0)],
        )
        assert order(result)[-1] == R5, at
        assert len(aired(result, DATA)) == 9, at
        assert result.counts["silent"] == 0


# Q8: carriers are counted, not what could be read.
def test_q8_garbled_reports_change_nothing():
    result = figure_1(*((0, GARBLE, node, 1) for node in (R2, R3, R4)))
    assert aired(result, DATA) == aired(figure_1(), DATA)
    assert aired(result, CRR) == aired(figure_1(), CRR)


# A fade is one CR-R too few for those who ended later: two turns collide, N1 and T2 mend it.
@pytest.mark.parametrize(
    ("node", "collide", "lost"), [(R2, [R2, R3], 1), (R3, [R2, R3], 0), (R4, [R3, R4], 0)]
)
def test_q8_a_report_that_nobody_hears_costs_a_collision_of_turns(node, collide, lost):
    result = figure_1((0, FADE, node, 1))
    assert sorted(order(result)) == [R1, R2, R3, R4]
    again = [i for i, told in said(result, REPORT_COLLISION).items() if (1, 0) in told]
    assert sorted(again) == collide
    assert result.counts["silent"] == lost  # the last does not learn of the first report (Q9)


# Q11: Robots 1 and 4 do not hear each other. Nothing is promised, but it goes on.
@pytest.mark.parametrize(("n", "pair"), [(4, (R1, R4)), (3, (R1, R2)), (2, (R1, R2))])
def test_q11_hidden_stations_do_not_stop_anybody(n, pair):
    for seed in SEEDS:
        plan = natural(n, seed=seed).plan
        one, other = pair
        plan.delays_us[one][other] = plan.delays_us[other][one] = -1
        result = simulate(plan)
        assert result.counts["completed"] == n
        if n == 2:
            assert result.counts["silent"] == 2


# Delays that differ: outside the paper's model, where tau is the same for all.
@pytest.mark.parametrize("n", [2, 3, 5, 12, 20])
def test_unequal_delays_spoil_the_order_but_stop_nobody(n):
    ordered = 0
    for seed in SEEDS:
        result = natural(n, seed=seed, real=(52, 104))
        assert result.counts["completed"] == n
        ordered += is_ordered(result)
    assert ordered < len(SEEDS)


# Q8, Q12, N2: up to one frame in ten cannot be read by one of its receivers.
@pytest.mark.parametrize("loss", [0.01, 0.05, 0.1])
@pytest.mark.parametrize("n", [2, 3, 4])
def test_frame_errors_leave_every_turn_to_one_station(n, loss):
    for seed in SEEDS:
        result = natural(n, seed=seed, loss_q15=round(loss * 32768))
        assert is_ordered(result)
        assert result.counts["completed"] == n


@pytest.mark.parametrize("n", [5, 8, 20])
def test_frame_errors_and_many_stations_never_lock_up(n):
    for seed in SEEDS:
        result = natural(n, seed=seed, loss_q15=3277)
        assert result.counts["completed"] == n


@pytest.mark.parametrize("ta", [0, 2000])
@pytest.mark.parametrize("n", [1, 2, 5, 12])
def test_saturation_goes_on_with_frame_errors(n, ta):
    result = paper(n, ta=ta, packet_slots=5, traffic="saturated", packets=200, loss_q15=3277)
    assert result.counts["completed"] == 200 * n


# "each robot can retransmit its signal according to a priority": else one keeps the channel.
def test_saturation_is_shared():
    result = paper(5, traffic="saturated", packets=200)
    served = [order(result).count(node) for node in range(5)]
    assert min(served) > 160
    assert result.counts["silent"] == 0
