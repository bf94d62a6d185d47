"""CSMA/CD-R as published, on a channel of microseconds; the paper's sentences as printed."""

import random
from itertools import pairwise

import pytest

from innervate.protocol.radio_words import (
    CRR,
    DATA,
    LAST,
    OTHER,
    OUTSIDER,
    REPORT_COLLISION,
    REPORT_COUNT,
    REPORT_DELIVERED,
    REPORT_ROLE,
    REPORT_TURN,
    REPORTER,
)
from innervate.scenario.radio_plan import FADE, GARBLE, JOIN, KILL, RadioFault
from innervate.sim.radio.simulate import simulate
from tests.radio_runs import START_US, radio_plan

TAU, SLOT, BIT = 104, 208, 26
R1, R2, R3, R4, R5 = range(5)
FIGURE_1 = (1248, 1040, 624, 0)
SEEDS = range(1, 41)


def paper(n, *, ta=0, real=(TAU, TAU), **more):
    """Runs a plan of the paper's constants: one delay for all pairs."""
    return simulate(
        radio_plan(n, ta=ta, protocol="csma-cd-r/paper", real=real, delay_us=(TAU, TAU), **more)
    )


def natural(n, **more):
    """A collision as carrier sense allows it: all begin within tau."""
    return paper(n, spread=TAU - 1, **more)


def forced(*starts, **more):
    """A collision of these starts (us), which carrier sense would forbid."""
    arrivals = [[START_US + start] for start in starts]
    return paper(len(starts), forced=True, arrivals=arrivals, **more)


def figure_1(*faults, packet_slots=25, **more):
    """The paper's Fig. 1, with (us, action, station, value) that happen to it."""
    happen = [RadioFault(START_US + at, what, i, value, 0) for at, what, i, value in faults]
    return forced(*FIGURE_1, faults=happen, packet_slots=packet_slots, **more)


def aired(result, kind):
    """(station, start, end) of what was sent, us from the first start."""
    rows = result.sent[result.sent["kind"] == kind]
    return [(int(r["node"]), int(r["time"]) - START_US, int(r["end"]) - START_US) for r in rows]


def said(result, code):
    """Per station, (a, b) of its reports of a kind."""
    rows = result.rows[result.rows["code"] == code]
    found = {}
    for row in rows:
        found.setdefault(int(row["node"]), []).append((int(row["a"]), int(row["b"])))
    return found


def order(result):
    """Stations in the order in which their packets got through."""
    return [int(node) for node in result.packets[result.packets["end"].argsort()]["node"]]


def overlaps(frames):
    """How many begin before the one before has ended."""
    return sum(b[1] < a[2] for a, b in pairwise(frames))


def is_ordered(result):
    """One collision, one resolution, turns in the order of the ends, and no packet more."""
    n = result.plan.stations
    frames = aired(result, DATA)
    first = [node for node, _start, end in sorted(frames[:n], key=lambda f: f[2])]
    return [f[0] for f in frames[n:]] == first and overlaps(frames[n:]) == 0


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
    for at in range(5, 34_000, 397):
        result = figure_1((at, KILL, node, 0), wanted=0, duration_s=0.5)
        alive = {R1, R2, R3, R4} - {node}
        assert alive <= set(result.packets["node"].tolist()), at
        assert result.counts["silent"] <= 1, at


# Q7, "Any node can use a communication channel at anytime"
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_q7_a_packet_that_comes_in_a_resolution_is_served_last(seed):
    starts = natural(4, seed=seed).plan.arrivals
    for at in range(200, 32_000, 331):
        arrivals = [*starts, [START_US + TAU + at]]
        result = paper(5, seed=seed, arrivals=arrivals)
        assert order(result)[-1] == R5, at
        assert len(aired(result, DATA)) == 9, at
        assert said(result, REPORT_ROLE)[R5] == [(OUTSIDER, 0)]


# Q10, "a robot can be added or removed without any bad influence on the distributed robot system"
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_q10_who_joins_in_a_resolution_is_served_last(seed):
    starts = natural(4, seed=seed).plan.arrivals
    for at in range(200, 32_000, 331):
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


@pytest.mark.parametrize("node", [R2, R3, R4])
def test_q8_a_report_that_nobody_hears_costs_a_collision_of_turns(node):
    result = figure_1((0, FADE, node, 1))
    assert result.counts["completed"] == 4
    delivered = order(result)
    assert sorted(delivered) == [R1, R2, R3, R4]
    if node == R3:
        collided = [i for i, told in said(result, REPORT_COLLISION).items() if (1, 0) in told]
        assert sorted(collided) == [R2, R3]
        assert result.counts["silent"] == 0
