"""CSMA/CD-R as published, on a channel of microseconds; the paper's sentences as printed."""

import random

import pytest

from innervate.dialect.access import REPORT_DELIVERED
from innervate.networks.radio.protocol.constants import (
    CRR,
    DATA,
    LAST,
    OTHER,
    REPORT_COLLISION,
    REPORT_COUNT,
    REPORT_ROLE,
    REPORT_TURN,
    REPORTER,
)
from tests.networks.radio.paper_runs import (
    R1,
    R2,
    R3,
    R4,
    SEEDS,
    SLOT,
    TAU,
    aired,
    figure_1,
    forced,
    is_ordered,
    natural,
    order,
    paper,
    said,
)


# [CSMA/CD-R 2.2, Fig. 1] "Robot3 waits for T_c1 after receiving a first CR - R, and sends its
# second CR - R. Robot4 waits for T_c2 ..., and sends its third CR - R."
def test_figure_1_is_exact_in_all_its_22_events():
    result = figure_1()
    assert aired(result, DATA) == [
        (R4, 0, 5200),
        (R3, 624, 5824),
        (R2, 1040, 6240),
        (R1, 1248, 6448),
        (R4, 11856, 17056),
        (R3, 17160, 22360),
        (R2, 22464, 27664),
        (R1, 27768, 32968),
    ]
    assert aired(result, CRR) == [(R2, 6552, 6760), (R3, 7280, 7488), (R4, 7904, 8112)]
    assert result.counts["silent"] == result.counts["partial"] == 0


# [CSMA/CD-R 2.2 rule 5] "A node which receives n CR - R after it sends a CR - R, transmits its
# signal at n + 1 turns. The last robot to finish a transmission, which transmits no CR - R and
# receives n CR - Rs, transmits its signal at n + 1 turns."
def test_rule_5_turns_come_from_counting():
    result = figure_1()
    assert said(result, REPORT_COUNT) == {R4: [(0, 3)], R3: [(1, 3)], R2: [(2, 3)], R1: [(3, 3)]}
    assert said(result, REPORT_TURN) == {R4: [(1, 4)], R3: [(2, 4)], R2: [(3, 4)], R1: [(4, 4)]}


# "the second latest node (Robot2) should send a collision report", "The latest node ... does not
# send a CR - R and receives CR - Rs from the other nodes"
def test_roles_after_a_collision():
    result = figure_1()
    roles = {R1: [(LAST, 0)], R2: [(REPORTER, 0)], R3: [(OTHER, 0)], R4: [(OTHER, 0)]}
    assert said(result, REPORT_ROLE) == roles
    assert {len(told) for told in said(result, REPORT_COLLISION).values()} == {1}
    assert sorted(said(result, REPORT_DELIVERED)) == [R1, R2, R3, R4]


# "The second latest node transmits a CR - R at the moment that CD becomes 0."
def test_the_reporter_sends_when_it_hears_the_last_end():
    (first, *_rest) = aired(figure_1(), CRR)
    assert first == (R2, 6448 + TAU, 6448 + TAU + SLOT)


def closed_form_us(starts, packet_slots):
    """T_D of a collision that is resolved [radio 4], from the first start to the last end."""
    n, packet = len(starts), packet_slots * SLOT
    ends = sorted(start + packet for start in starts)
    window = packet - (ends[-1] - ends[-2])
    return ends[-1] + 2 * TAU + SLOT + window + n * packet + (n - 1) * TAU


def check_closed_form(starts, packet_slots):
    result = forced(*starts, packet_slots=packet_slots)
    fifo = sorted(range(len(starts)), key=lambda i: starts[i])
    assert order(result) == fifo
    assert is_ordered(result)
    assert max(end for _node, _start, end in aired(result, DATA)) == closed_form_us(
        starts, packet_slots
    )
    assert result.counts["silent"] == 0


# "After a collision, it is possible for each node to retransmit its signal according to a priority
# scheme (First In First Out)", "T_D ... in a CSMA/CD-R protocol, proportional to a n linearly"
@pytest.mark.parametrize("n", range(2, 21))
def test_duration_where_ends_are_more_than_a_slot_apart(n):
    check_closed_form([209 * i for i in range(n)], 25)


@pytest.mark.parametrize("seed", range(60))
def test_duration_where_ends_are_apart_by_chance(seed):
    chance = random.Random(seed)
    n = chance.randint(2, 20)
    starts = [0]
    for _ in range(n - 1):
        starts.append(starts[-1] + chance.randint(SLOT + 1, max(SLOT + 1, 4900 // (n - 1))))
    chance.shuffle(starts)
    check_closed_form(starts, 25)


@pytest.mark.parametrize("gaps", [(209,), (500,), (209, 250), (300, 209, 220)])
def test_duration_of_short_packets(gaps):
    check_closed_form([sum(gaps[:i]) for i in range(len(gaps) + 1)], 5)


# F1: with carrier sense all begin within tau, half a CR-R: so do their CR-Rs.
@pytest.mark.parametrize(("n", "least"), [(2, 40), (3, 40), (4, 38)])
def test_f1_up_to_four_stations_are_put_in_order(n, least):
    assert sum(is_ordered(natural(n, seed=seed)) for seed in SEEDS) >= least


@pytest.mark.parametrize("n", [5, 6, 8, 12])
def test_f1_five_never_are_but_all_get_through(n):
    for seed in SEEDS:
        result = natural(n, seed=seed)
        assert not is_ordered(result)
        assert result.counts["completed"] == n
        assert result.counts["silent"] == 0


# Rules (2), (3) to the letter: whoever hears a valid signal after its own reports the collision,
# and whatever is heard is one CR-R. The last and the second to last then each hear the other's
# tail, report, and count the other's report.
@pytest.mark.parametrize("n", [2, 3, 4, 5])
def test_f1_as_worded_nobody_is_put_in_order(n):
    for seed in SEEDS:
        result = natural(n, seed=seed, tail_rule=False, overlap_rule=False)
        assert not is_ordered(result)
        assert len(aired(result, CRR)) >= n
        assert result.counts["completed"] == n


# T4 alone helps as well: a tail shorter than tau is no CR-R, so the two reports count differently.
@pytest.mark.parametrize("n", [2, 3, 4])
def test_f1_counting_tails_by_length_puts_up_to_four_in_order_too(n):
    assert sum(is_ordered(natural(n, seed=seed, tail_rule=False)) for seed in SEEDS) >= 38


def test_f1_without_counting_by_length_it_ends_at_three():
    ordered = [
        sum(is_ordered(natural(n, seed=seed, overlap_rule=False)) for seed in SEEDS)
        for n in (2, 3, 4)
    ]
    assert ordered == [40, 40, 0]


# F2, [CSMA/CD-R 4] "It takes 2ms to change a mode of a commercial communication module"
@pytest.mark.parametrize(("n", "lost"), [(2, 78), (5, 196)])
def test_f2_with_2_ms_collisions_go_unnoticed(n, lost):
    ta = 2000
    results = [paper(n, ta=ta, seed=seed, spread=TAU + ta - 1) for seed in SEEDS]
    assert sum(r.counts["silent"] for r in results) == lost
    assert sum(r.counts["completed"] for r in results) == n * len(SEEDS)
    for result in results:
        *_earlier, second, last = sorted(end for _node, _start, end in aired(result, DATA)[:n])
        if last - second < ta - TAU:
            assert result.counts["silent"] >= 2


# Beyond the paper [radio 8].
def saturated_throughput(n, **more):
    """S where everybody draws within tau, so that all collide in every round."""
    result = paper(n, traffic="saturated", packets=100, wait_us=TAU - 1, **more)
    arrived = result.packets[result.packets["receivers"] > 0]
    return int(arrived["slots"].sum()) * SLOT / result.ended_us


def test_a_short_window_is_enough_for_stations_that_begin_within_tau():
    assert saturated_throughput(2) == pytest.approx(0.475, abs=0.02)
    assert saturated_throughput(2, window_slots=2) == pytest.approx(0.603, abs=0.02)
    assert all(is_ordered(natural(n, seed=s, window_slots=2)) for n in (2, 3, 4) for s in SEEDS)


def test_stretching_tc_over_the_window_puts_more_than_four_in_order():
    stretch = 2 * 25 - 6
    assert saturated_throughput(10) == pytest.approx(0.437, abs=0.04)
    assert saturated_throughput(10, dilate=stretch) == pytest.approx(0.692, abs=0.02)
    assert sum(is_ordered(natural(5, seed=s, dilate=stretch)) for s in SEEDS) >= 36
    assert sum(is_ordered(natural(10, seed=s, dilate=stretch)) for s in SEEDS) >= 15
