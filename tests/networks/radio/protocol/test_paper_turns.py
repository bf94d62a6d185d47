"""A station of CSMA/CD-R as published, driven by hand: its turns, and those of others."""

import pytest

from innervate.dialect.access import LEAVE, REPORT_DELIVERED, REPORT_LEFT
from innervate.networks.radio.protocol import constants as c
from innervate.networks.radio.protocol import paper as radio_paper
from tests.networks.radio.paper_bench import (
    LONG,
    SLOT,
    TAU,
    Bench,
    D,
    F,
    G,
    Packet,
    after_own_packet,
    collided,
)


def my_turn_is_second(**more):
    """A reporter that has counted one CR-R behind its own: one turn, then ours."""
    bench = collided(TAU + 5, **more)
    out = LONG + TAU + 5 + SLOT
    bench.carrier(out, 0).hear(out + 500, c.CRR)
    opens = out + TAU + LONG - 5
    bench.at(opens)
    assert bench.told(c.REPORT_COUNT) == [(1, 2)]
    return bench, opens


def test_a_silent_turn_passes_after_d():
    bench, opens = my_turn_is_second()
    assert bench.at(opens + D - 1).sent[2:] == []
    assert bench.at(opens + D).sent[2:] == [(opens + D, c.DATA)]


# N2: "a garbled packet: wait G. ... Data or silence -> it was a turn."
def test_n2_a_garbled_packet_was_a_turn_if_no_report_follows():
    bench, opens = my_turn_is_second()
    end = opens + TAU + LONG
    bench.noise(opens + TAU, end)
    assert bench.at(end + G - 1).sent[2:] == []
    assert bench.at(end + G).sent[2:] == [(end + G, c.DATA)]


# N1: "CR-R during TURNS (nested collision): left+1, total+1"
def test_n1_a_report_after_it_is_a_turn_more():
    bench, opens = my_turn_is_second()
    end = opens + TAU + LONG
    bench.noise(opens + TAU, end).hear(end + TAU, c.CRR)
    bench.hear(end + TAU + SLOT + LONG, c.DATA)
    assert bench.sent[2:] == []
    bench.hear(end + 3 * TAU + SLOT + 2 * LONG, c.DATA)
    assert bench.told(c.REPORT_TURN) == [(3, 4)]
    assert len(bench.sent) == 3


def test_n1_the_limit_of_silence_is_that_of_a_window():
    bench, opens = my_turn_is_second()
    end = opens + TAU + LONG
    bench.noise(opens + TAU, end).hear(end + TAU, c.CRR)
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
    assert bench.told(c.REPORT_COLLISION) == [(0, 0), (1, 0)]
    bench.station.choice = drawn
    bench.at(opens + drawn * SLOT)
    assert bench.station.asked == 8
    assert bench.sent[4:] == [(opens + drawn * SLOT, c.DATA)]


# T2: "carrier heard before that -> it gives up the turn and contends later"
def test_t2_a_carrier_in_the_delay_takes_the_turn():
    bench, opens = turn_collided()
    bench.station.choice = 5
    bench.at(opens).hear(opens + 2 * SLOT, c.DATA)
    end = opens + 2 * SLOT + LONG
    # Two turns are left that nobody takes: the one given up, and one of the first resolution.
    assert bench.at(end + 2 * D + F + 4).sent[4:] == []
    assert bench.at(end + 2 * D + F + 5).sent[4:] == [(end + 2 * D + F + 5, c.DATA)]


# Step 6: "if CD=1 then: when it clears, rule S"
def test_rule_s_a_report_waits_for_the_end_of_a_carrier():
    bench = after_own_packet().carrier(LONG, 1, 0).carrier(LONG + 520, 1, 1)
    bench.carrier(LONG + 728, 0).hear(LONG + 832, c.CRR)
    bench.noise(LONG + 1400, LONG + 1608)
    assert bench.sent[1:] == [(LONG + 1608, c.CRR)]


def test_t2_the_bound_grows_with_collisions_in_a_row_and_success_ends_it():
    bench, opens = turn_collided()
    bench.at(opens)
    end = opens + LONG
    bench.carrier(end, 1).carrier(end + TAU, 0).carrier(end + TAU + SLOT, 0)
    opens = end + 2 * TAU + SLOT + LONG
    bench.at(opens)
    assert bench.station.asked == 16
    assert bench.sent[-1] == (opens, c.DATA)
    bench.carrier(opens + LONG, 0).at(opens + LONG + G)
    assert bench.told(REPORT_DELIVERED) == [(1, 1)]
    assert bench.station.again == 0


def own_turn_is_out():
    """Our turn has just ended, the second of three; we listen again in silence."""
    bench, opens = my_turn_is_second()
    end = opens + D + LONG
    return bench.carrier(end, 0), end


def free_from(bench):
    """When the next packet of ours may go out, all turns being over."""
    bench.offer(handle=2).at(bench.time + 20 * LONG)
    return bench.sent[-1][0] - F


def test_turns_behind_ours_pass_by_silence():
    bench, end = own_turn_is_out()
    assert free_from(bench) == end + TAU + D


def test_turns_behind_ours_pass_by_a_packet():
    bench, end = own_turn_is_out()
    bench.hear(end + 2 * TAU, c.DATA)
    assert bench.told(REPORT_DELIVERED) == [(1, 1)]
    assert free_from(bench) == end + 2 * TAU + LONG


def test_turns_behind_ours_pass_by_a_garbled_packet():
    bench, end = own_turn_is_out()
    bench.noise(end + 2 * TAU, end + 2 * TAU + LONG)
    assert bench.told(REPORT_DELIVERED) == [(1, 1)]
    assert free_from(bench) == end + 2 * TAU + LONG + G


def test_n2_a_packet_behind_a_garbled_one_makes_two_turns():
    bench = Bench().hear(10, c.CRR).hear(2000, c.CRR)
    opens = 10 + SLOT + LONG
    bench.at(opens)
    assert bench.station.total == 3
    end = opens + TAU + LONG
    bench.noise(opens + TAU, end).hear(end + TAU, c.DATA)
    assert bench.station.total == 1


def test_n1_an_outsider_follows_one_turn_more():
    bench = Bench().hear(10, c.CRR).at(10 + SLOT + LONG)
    assert bench.station.total == 2
    bench.hear(10 + SLOT + LONG + 50, c.CRR)
    assert bench.station.total == 3


def test_whose_report_comes_too_late_has_no_turn():
    bench = after_own_packet().carrier(LONG, 1, 0).carrier(LONG + 2000, 1, 1)
    bench.carrier(LONG + 2208, 0).hear(LONG + 2312, c.CRR)
    bench.hear(LONG + 2600, c.DATA)
    assert bench.told(c.REPORT_COUNT) == [(0, 1)]
    assert (bench.station.left, bench.station.total) == (-1, 1)


def test_the_window_of_an_outsider_knows_no_tc0():
    bench = collided(TAU + 500)
    out = LONG + TAU + 500 + SLOT
    bench.carrier(out, 0).at(out + TAU + LONG - 500)
    end = out + TAU + 2 * LONG - 500
    bench.carrier(end, 0).at(end + 50_000).hear(end + 50_000, c.CRR)
    assert bench.due[c.MAIN] == end + 50_000 + SLOT + LONG


# F2: the radio is deaf for 2 ms, so what is valid when it listens again counts as valid at once.
def test_valid_as_soon_as_we_listen_is_valid_at_once():
    bench = Bench(ta=2000).offer()
    end = 2000 + LONG
    bench.carrier(end + 2000, 1).carrier(end + 2050, 0)
    assert bench.told(c.REPORT_ROLE) == [(c.REPORTER, 0)]
    assert bench.station.tc0 == 2050 - TAU
    out = end + 2050 + 2000 + SLOT
    bench.carrier(out + 2000, 1).carrier(out + 2000 + 10, 0).at(out + 20_000)
    assert bench.told(c.REPORT_COUNT) == [(1, 2)]


# Q7
def test_an_outsider_follows_m_plus_1_turns_and_contends_then():
    bench = Bench().hear(10, c.CRR)
    bench.station.choice = 40
    bench.at(1000).offer()
    opens = 10 + SLOT + LONG - SLOT
    bench.hear(opens, c.DATA).hear(opens + LONG + TAU, c.DATA)
    end = opens + 2 * LONG + TAU
    assert bench.at(end + F + 39).sent == []
    assert bench.at(end + F + 40).sent == [(end + F + 40, c.DATA)]


# Q10
def test_a_late_joiner_listens_for_a_packet_and_a_dead_turn():
    bench = Bench(cause=1).offer().hear(3000, c.DATA)
    end = 3000 + LONG
    assert bench.at(end + LONG + D - 1).sent == []
    assert bench.at(end + LONG + D).sent == [(end + LONG + D, c.DATA)]


def test_a_late_joiners_second_packet_does_not_jump_the_wait():
    bench = Bench(cause=1, wait_us=700).offer()
    bench.station.choice = 500
    bench.at(LONG + D).offer(handle=2)
    assert bench.at(LONG + D + 499).sent == []
    assert bench.at(LONG + D + 500).sent == [(LONG + D + 500, c.DATA)]


def test_a_late_joiner_follows_a_resolution():
    bench = Bench(cause=1).offer().hear(3000, c.CRR)
    assert bench.told(c.REPORT_ROLE) == [(c.OUTSIDER, 0)]


def test_window_of_two_slots():
    bench = collided(TAU + 5, window_slots=2)
    out = LONG + TAU + 5 + SLOT
    bench.carrier(out, 0).at(out + TAU + 2 * SLOT)
    assert bench.sent[2:] == [(out + TAU + 2 * SLOT, c.DATA)]


def test_leaving_is_after_the_last_packet():
    bench = after_own_packet()
    bench.call(radio_paper.on_input, LEAVE, Packet())
    assert bench.told(REPORT_LEFT) == []
    assert bench.carrier(LONG, 0).at(LONG + G).told(REPORT_LEFT) == [(0, 0)]


def test_timers_that_mean_nothing_any_more():
    bench = Bench().carrier(10, 1)
    for timer in (c.MAIN, c.ACT):
        bench.call(radio_paper.on_timer, timer)
    assert bench.sent == bench.reports == []
