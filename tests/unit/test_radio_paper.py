"""A station of CSMA/CD-R as published, driven by hand: what it hears, and what it does then."""

import pytest

from innervate.protocol import radio_paper
from innervate.protocol.radio_words import (
    ACT,
    CRR,
    DATA,
    FORCE,
    LAST,
    LEAVE,
    MAIN,
    OTHER,
    OUTSIDER,
    REPORT_COLLISION,
    REPORT_COUNT,
    REPORT_DELIVERED,
    REPORT_LEFT,
    REPORT_ROLE,
    REPORT_TURN,
    REPORTER,
)
from tests.radio_paper_bench import LONG, SLOT, TAU, Bench, D, F, G, Packet


def after_own_packet(**more):
    """A station whose packet of 0..T has just ended; it listens again when told to."""
    bench = Bench(**more)
    bench.offer()
    assert bench.sent == [(0, DATA)]
    return bench


def collided(tail, voc=1, **more):
    """... and hears others until `tail` us later."""
    return after_own_packet(**more).carrier(LONG, 1, voc).carrier(LONG + tail, 0)


# [P 2.2 rule 1]
def test_an_idle_channel_is_used_at_once():
    assert Bench().offer().sent == [(0, DATA)]


@pytest.mark.parametrize("drawn", [0, 1, 700])
def test_a_busy_channel_costs_the_space_and_a_draw(drawn):
    bench = Bench(wait_us=700)
    bench.station.choice = drawn
    bench.carrier(10, 1).at(20).offer()
    bench.noise(10, 3000).at(3000 + F + drawn - 1)
    assert bench.sent == []
    assert bench.station.asked == 701
    assert bench.at(3000 + F + drawn).sent == [(3000 + F + drawn, DATA)]


def test_a_packet_within_the_space_waits_like_the_others():
    bench = Bench()
    bench.station.choice = 50
    bench.noise(10, 3000).at(3100).offer().at(3000 + F + 49)
    assert bench.sent == []
    assert bench.at(4000).sent == [(3000 + F + 50, DATA)]


def test_a_packet_after_the_space_goes_at_once():
    bench = Bench().noise(10, 3000).at(3000 + F).offer()
    assert bench.sent == [(3000 + F, DATA)]


def test_a_carrier_cancels_the_wait_and_the_draw():
    bench = Bench()
    bench.station.choice = 500
    bench.noise(10, 3000).at(3001).offer()
    bench.station.choice = 7
    bench.noise(3000 + F + 400, 9000).at(20_000)
    assert bench.sent[0] == (9000 + F + 7, DATA)


def test_a_forced_packet_knows_no_carrier():
    assert Bench().carrier(10, 1).offer(FORCE).sent == [(10, DATA)]


def test_silence_for_the_guard_is_success():
    bench = after_own_packet().carrier(LONG, 0).at(LONG + G - 1)
    assert bench.told(REPORT_DELIVERED) == []
    assert bench.at(LONG + G).told(REPORT_DELIVERED) == [(1, 1)]


# "After transmitting a packet, if a packet is received": of somebody whose turn it was.
def test_a_packet_after_ours_is_success_as_well():
    bench = after_own_packet().carrier(LONG, 0).hear(LONG + 2 * TAU, DATA)
    assert bench.told(REPORT_DELIVERED) == [(1, 1)]
    assert bench.handed == [99]


def test_a_report_after_ours_says_that_we_ended_last():
    bench = after_own_packet().carrier(LONG, 0).hear(LONG + 2 * TAU, CRR)
    assert bench.told(REPORT_COLLISION) == [(0, 0)]
    assert bench.told(REPORT_ROLE) == [(LAST, 0)]
    end = LONG + 2 * TAU + SLOT
    bench.at(end + LONG)
    assert bench.told(REPORT_COUNT) == [(1, 1)]
    bench.hear(end + LONG + TAU, DATA)
    assert bench.told(REPORT_TURN) == [(2, 2)]
    assert bench.sent[-1] == (end + 2 * LONG + TAU, DATA)


# T1: x < tau, nobody ended after us; x = tau, somebody did, or together with us.
@pytest.mark.parametrize(
    ("tail", "role"), [(TAU - 1, None), (TAU, REPORTER), (TAU + 300, REPORTER)]
)
def test_t1_how_long_the_tail_is_says_who_ended_last(tail, role):
    bench = collided(tail)
    assert bench.told(REPORT_COLLISION) == [(0, 0)]
    assert bench.told(REPORT_ROLE) == ([(role, 0)] if role else [])
    assert bench.sent[1:] == ([(LONG + tail, CRR)] if role else [])


def test_t1_whoever_ended_last_and_hears_no_report_tries_again():
    bench = collided(TAU - 1, wait_us=300)
    bench.station.choice = 30
    bench.at(LONG + 100_000)
    assert bench.told(REPORT_DELIVERED) == []
    assert bench.sent[1] == (LONG + TAU + F + 30, DATA)


def test_without_t1_the_last_reports_too():
    assert collided(TAU - 1, tail_rule=False).sent[1:] == [(LONG + TAU - 1, CRR)]


# Step 4: v is the last moment at which one signal was left.
@pytest.mark.parametrize(("valid", "tc"), [(TAU, 0), (TAU + 1, 1), (TAU + 416, 416)])
def test_tc_is_the_time_without_a_valid_signal(valid, tc):
    bench = after_own_packet().carrier(LONG, 1, 0).carrier(LONG + valid, 1, 1)
    bench.carrier(LONG + valid + SLOT, 0)
    assert bench.told(REPORT_ROLE) == [(OTHER if tc else REPORTER, 0)]
    assert bench.station.tc == tc
    assert bench.station.tc0 == valid + SLOT - TAU if tc == 0 else SLOT


def test_ends_at_one_moment_leave_no_valid_signal():
    bench = after_own_packet().carrier(LONG, 1, 0).carrier(LONG + 700, 0)
    assert (bench.station.tc, bench.station.tc0) == (700 - TAU, 0)


def test_an_other_reports_tc_after_the_first_report():
    bench = after_own_packet().carrier(LONG, 1, 0).carrier(LONG + 520, 1, 1)
    bench.carrier(LONG + 728, 0).hear(LONG + 832, CRR).at(LONG + 1040 + 416)
    assert bench.sent[1:] == [(LONG + 1040 + 416, CRR)]
    bench.carrier(LONG + 1040 + 416 + SLOT, 0).at(LONG + 1040 + LONG - 208)
    assert bench.told(REPORT_COUNT) == [(0, 2)]
    assert bench.sent[2:] == [(LONG + 1040 + LONG - 208, DATA)]


# Q9
def test_an_other_reports_first_if_nobody_does():
    bench = after_own_packet().carrier(LONG, 1, 0).carrier(LONG + 520, 1, 1)
    bench.carrier(LONG + 728, 0).at(LONG + 728 + G + 415)
    assert bench.sent[1:] == []
    assert bench.at(LONG + 728 + G + 416).sent[1:] == [(LONG + 728 + G + 416, CRR)]


# T4: "noise burst of length L counts ceil(L / 1 slot)"
@pytest.mark.parametrize(
    ("length", "count"), [(1, 1), (SLOT, 1), (SLOT + 1, 2), (2 * SLOT, 2), (5 * SLOT + 1, 6)]
)
def test_t4_noise_counts_by_its_length(length, count):
    bench = Bench().hear(10, CRR)
    start = 10 + SLOT + 300
    bench.noise(start, start + length).at(10 + SLOT + LONG)
    assert bench.told(REPORT_ROLE) == [(OUTSIDER, 0)]
    assert bench.told(REPORT_COUNT) == [(0, 1 + count)]


# T4: "Burst already present when own CR-R ends"
@pytest.mark.parametrize(
    ("tail", "count"), [(1, 0), (TAU, 0), (TAU + 1, 1), (TAU + SLOT, 1), (TAU + SLOT + 1, 2)]
)
def test_t4_a_tail_after_our_own_report_began_tau_earlier(tail, count):
    bench = collided(TAU + 5)
    out = LONG + TAU + 5 + SLOT
    bench.carrier(out, 1).carrier(out + tail, 0).at(out + 100_000)
    assert bench.told(REPORT_COUNT) == [(count, 1 + count)]


# T5: "noise >= T is a collided packet, not CR-Rs"
def test_t5_a_long_noise_ends_the_window():
    bench = Bench().hear(10, CRR).noise(2000, 2000 + LONG)
    assert bench.told(REPORT_COUNT) == [(0, 1)]
    assert bench.station.total == 2


def my_turn_is_second(**more):
    """A reporter that has counted one CR-R behind its own: one turn, then ours."""
    bench = collided(TAU + 5, **more)
    out = LONG + TAU + 5 + SLOT
    bench.carrier(out, 0).hear(out + 500, CRR)
    opens = out + TAU + LONG - 5
    bench.at(opens)
    assert bench.told(REPORT_COUNT) == [(1, 2)]
    return bench, opens


def test_a_silent_turn_passes_after_d():
    bench, opens = my_turn_is_second()
    assert bench.at(opens + D - 1).sent[2:] == []
    assert bench.at(opens + D).sent[2:] == [(opens + D, DATA)]


# N2: "a garbled packet: wait G. ... Data or silence -> it was a turn."
def test_n2_a_garbled_packet_was_a_turn_if_no_report_follows():
    bench, opens = my_turn_is_second()
    end = opens + TAU + LONG
    bench.noise(opens + TAU, end)
    assert bench.at(end + G - 1).sent[2:] == []
    assert bench.at(end + G).sent[2:] == [(end + G, DATA)]


# N1: "CR-R during TURNS (nested collision): left+1, total+1"
def test_n1_a_report_after_it_is_a_turn_more():
    bench, opens = my_turn_is_second()
    end = opens + TAU + LONG
    bench.noise(opens + TAU, end).hear(end + TAU, CRR)
    bench.hear(end + TAU + SLOT + LONG, DATA)
    assert bench.sent[2:] == []
    bench.hear(end + 3 * TAU + SLOT + 2 * LONG, DATA)
    assert bench.told(REPORT_TURN) == [(3, 4)]
    assert len(bench.sent) == 3


def test_n1_the_limit_of_silence_is_that_of_a_window():
    bench, opens = my_turn_is_second()
    end = opens + TAU + LONG
    bench.noise(opens + TAU, end).hear(end + TAU, CRR)
    limit = LONG + SLOT + D + 64 * SLOT
    heard = end + TAU + SLOT
    bench.at(heard + limit - 1)
    assert bench.station.left == 2
    bench.at(heard + limit)
    assert bench.station.left == 1
    bench.at(heard + limit + D)
    assert len(bench.sent) == 3


def turn_collided():
    """... our turn collides, and we are the reporter once more, with nobody behind us."""
    bench, opens = my_turn_is_second()
    bench.at(opens + D)
    end = opens + D + LONG
    bench.carrier(end, 1).carrier(end + TAU, 0)
    out = end + TAU + SLOT
    bench.carrier(out, 0)
    return bench, out + TAU + LONG


# T2: "delays its next turn by a random 0..8r-1 slots"
@pytest.mark.parametrize("drawn", [0, 3, 7])
def test_t2_a_turn_that_collided_delays_the_next_one(drawn):
    bench, opens = turn_collided()
    assert bench.told(REPORT_COLLISION) == [(0, 0), (1, 0)]
    bench.station.choice = drawn
    bench.at(opens + drawn * SLOT)
    assert bench.station.asked == 8
    assert bench.sent[4:] == [(opens + drawn * SLOT, DATA)]


# T2: "carrier heard before that -> it gives up the turn and contends later"
def test_t2_a_carrier_in_the_delay_takes_the_turn():
    bench, opens = turn_collided()
    bench.station.choice = 5
    bench.at(opens).hear(opens + 2 * SLOT, DATA)
    end = opens + 2 * SLOT + LONG
    # Two turns are left that nobody takes: the one given up, and one of the first resolution.
    assert bench.at(end + 2 * D + F + 4).sent[4:] == []
    assert bench.at(end + 2 * D + F + 5).sent[4:] == [(end + 2 * D + F + 5, DATA)]


# Step 6: "if CD=1 then: when it clears, rule S"
def test_rule_s_a_report_waits_for_the_end_of_a_carrier():
    bench = after_own_packet().carrier(LONG, 1, 0).carrier(LONG + 520, 1, 1)
    bench.carrier(LONG + 728, 0).hear(LONG + 832, CRR)
    bench.noise(LONG + 1400, LONG + 1608)
    assert bench.sent[1:] == [(LONG + 1608, CRR)]


# Q7
def test_an_outsider_follows_m_plus_1_turns_and_contends_then():
    bench = Bench().hear(10, CRR)
    bench.station.choice = 40
    bench.at(1000).offer()
    opens = 10 + SLOT + LONG - SLOT
    bench.hear(opens, DATA).hear(opens + LONG + TAU, DATA)
    end = opens + 2 * LONG + TAU
    assert bench.at(end + F + 39).sent == []
    assert bench.at(end + F + 40).sent == [(end + F + 40, DATA)]


# Q10
def test_a_late_joiner_listens_for_a_packet_and_a_dead_turn():
    bench = Bench(cause=1).offer().hear(3000, DATA)
    end = 3000 + LONG
    assert bench.at(end + LONG + D - 1).sent == []
    assert bench.at(end + LONG + D).sent == [(end + LONG + D, DATA)]


def test_a_late_joiner_follows_a_resolution():
    bench = Bench(cause=1).offer().hear(3000, CRR)
    assert bench.told(REPORT_ROLE) == [(OUTSIDER, 0)]


def test_window_of_two_slots():
    bench = collided(TAU + 5, window_slots=2)
    out = LONG + TAU + 5 + SLOT
    bench.carrier(out, 0).at(out + TAU + 2 * SLOT)
    assert bench.sent[2:] == [(out + TAU + 2 * SLOT, DATA)]


def test_leaving_is_after_the_last_packet():
    bench = after_own_packet()
    bench.call(radio_paper.on_input, LEAVE, Packet())
    assert bench.told(REPORT_LEFT) == []
    assert bench.carrier(LONG, 0).at(LONG + G).told(REPORT_LEFT) == [(0, 0)]


def test_timers_that_mean_nothing_any_more():
    bench = Bench().carrier(10, 1)
    for timer in (MAIN, ACT):
        bench.call(radio_paper.on_timer, timer)
    assert bench.sent == bench.reports == []
