"""A station of CSMA/CD-R as published, driven by hand: what it hears, and what it does then."""

import pytest

from innervate.dialect.access import FORCE, REPORT_DELIVERED
from innervate.networks.radio.protocol import constants as c
from tests.networks.radio.paper_bench import (
    LONG,
    SLOT,
    TAU,
    Bench,
    D,
    F,
    G,
    after_own_packet,
    collided,
)


# [P 2.2 rule 1]
def test_an_idle_channel_is_used_at_once():
    assert Bench().offer().sent == [(0, c.DATA)]


@pytest.mark.parametrize("drawn", [0, 1, 700])
def test_a_busy_channel_costs_the_space_and_a_draw(drawn):
    bench = Bench(wait_us=700)
    bench.station.choice = drawn
    bench.carrier(10, 1).at(20).offer()
    bench.noise(10, 3000).at(3000 + F + drawn - 1)
    assert bench.sent == []
    assert bench.station.asked == 701
    assert bench.at(3000 + F + drawn).sent == [(3000 + F + drawn, c.DATA)]


def test_a_packet_within_the_space_waits_like_the_others():
    bench = Bench()
    bench.station.choice = 50
    bench.noise(10, 3000).at(3100).offer().at(3000 + F + 49)
    assert bench.sent == []
    assert bench.at(4000).sent == [(3000 + F + 50, c.DATA)]


def test_a_packet_after_the_space_goes_at_once():
    bench = Bench().noise(10, 3000).at(3000 + F).offer()
    assert bench.sent == [(3000 + F, c.DATA)]


def test_a_carrier_cancels_the_wait_and_the_draw():
    bench = Bench()
    bench.station.choice = 500
    bench.noise(10, 3000).at(3001).offer()
    bench.station.choice = 7
    bench.noise(3000 + F + 400, 9000).at(20_000)
    assert bench.sent[0] == (9000 + F + 7, c.DATA)


def test_a_forced_packet_knows_no_carrier():
    assert Bench().carrier(10, 1).offer(FORCE).sent == [(10, c.DATA)]


def test_silence_for_the_guard_is_success():
    bench = after_own_packet().carrier(LONG, 0).at(LONG + G - 1)
    assert bench.told(REPORT_DELIVERED) == []
    assert bench.at(LONG + G).told(REPORT_DELIVERED) == [(1, 1)]


# "After transmitting a packet, if a packet is received": of somebody whose turn it was.
def test_a_packet_after_ours_is_success_as_well():
    bench = after_own_packet().carrier(LONG, 0).hear(LONG + 2 * TAU, c.DATA)
    assert bench.told(REPORT_DELIVERED) == [(1, 1)]
    assert bench.handed == [99]


def test_a_report_after_ours_says_that_we_ended_last():
    bench = after_own_packet().carrier(LONG, 0).hear(LONG + 2 * TAU, c.CRR)
    assert bench.told(c.REPORT_COLLISION) == [(0, 0)]
    assert bench.told(c.REPORT_ROLE) == [(c.LAST, 0)]
    end = LONG + 2 * TAU + SLOT
    bench.at(end + LONG)
    assert bench.told(c.REPORT_COUNT) == [(1, 1)]
    bench.hear(end + LONG + TAU, c.DATA)
    assert bench.told(c.REPORT_TURN) == [(2, 2)]
    assert bench.sent[-1] == (end + 2 * LONG + TAU, c.DATA)


# T1: x < tau, nobody ended after us; x = tau, somebody did, or together with us.
@pytest.mark.parametrize(
    ("tail", "role"), [(TAU - 1, None), (TAU, c.REPORTER), (TAU + 300, c.REPORTER)]
)
def test_t1_how_long_the_tail_is_says_who_ended_last(tail, role):
    bench = collided(tail)
    assert bench.told(c.REPORT_COLLISION) == [(0, 0)]
    assert bench.told(c.REPORT_ROLE) == ([(role, 0)] if role else [])
    assert bench.sent[1:] == ([(LONG + tail, c.CRR)] if role else [])


def test_t1_whoever_ended_last_and_hears_no_report_tries_again():
    bench = collided(TAU - 1, wait_us=300)
    bench.station.choice = 30
    bench.at(LONG + 100_000)
    assert bench.told(REPORT_DELIVERED) == []
    assert bench.sent[1] == (LONG + TAU + F + 30, c.DATA)


def test_without_t1_the_last_reports_too():
    assert collided(TAU - 1, tail_rule=False).sent[1:] == [(LONG + TAU - 1, c.CRR)]


# Step 4: v is the last moment at which one signal was left.
@pytest.mark.parametrize(("valid", "tc"), [(TAU, 0), (TAU + 1, 1), (TAU + 416, 416)])
def test_tc_is_the_time_without_a_valid_signal(valid, tc):
    bench = after_own_packet().carrier(LONG, 1, 0).carrier(LONG + valid, 1, 1)
    bench.carrier(LONG + valid + SLOT, 0)
    assert bench.told(c.REPORT_ROLE) == [(c.OTHER if tc else c.REPORTER, 0)]
    assert bench.station.tc == tc
    assert bench.station.tc0 == valid + SLOT - TAU if tc == 0 else SLOT


def test_ends_at_one_moment_leave_no_valid_signal():
    bench = after_own_packet().carrier(LONG, 1, 0).carrier(LONG + 700, 0)
    assert (bench.station.tc, bench.station.tc0) == (700 - TAU, 0)


def test_an_other_reports_tc_after_the_first_report():
    bench = after_own_packet().carrier(LONG, 1, 0).carrier(LONG + 520, 1, 1)
    bench.carrier(LONG + 728, 0).hear(LONG + 832, c.CRR).at(LONG + 1040 + 416)
    assert bench.sent[1:] == [(LONG + 1040 + 416, c.CRR)]
    bench.carrier(LONG + 1040 + 416 + SLOT, 0).at(LONG + 1040 + LONG - 208)
    assert bench.told(c.REPORT_COUNT) == [(0, 2)]
    assert bench.sent[2:] == [(LONG + 1040 + LONG - 208, c.DATA)]


# Q9
def test_an_other_reports_first_if_nobody_does():
    bench = after_own_packet().carrier(LONG, 1, 0).carrier(LONG + 520, 1, 1)
    bench.carrier(LONG + 728, 0).at(LONG + 728 + G + 415)
    assert bench.sent[1:] == []
    assert bench.at(LONG + 728 + G + 416).sent[1:] == [(LONG + 728 + G + 416, c.CRR)]


# T4: "noise burst of length L counts ceil(L / 1 slot)"
@pytest.mark.parametrize(
    ("length", "count"), [(1, 1), (SLOT, 1), (SLOT + 1, 2), (2 * SLOT, 2), (5 * SLOT + 1, 6)]
)
def test_t4_noise_counts_by_its_length(length, count):
    bench = Bench().hear(10, c.CRR)
    start = 10 + SLOT + 300
    bench.noise(start, start + length).at(10 + SLOT + LONG)
    assert bench.told(c.REPORT_ROLE) == [(c.OUTSIDER, 0)]
    assert bench.told(c.REPORT_COUNT) == [(0, 1 + count)]


# T4: "Burst already present when own CR-R ends"
@pytest.mark.parametrize(
    ("tail", "count"), [(1, 0), (TAU, 0), (TAU + 1, 1), (TAU + SLOT, 1), (TAU + SLOT + 1, 2)]
)
def test_t4_a_tail_after_our_own_report_began_tau_earlier(tail, count):
    bench = collided(TAU + 5)
    out = LONG + TAU + 5 + SLOT
    bench.carrier(out, 1).carrier(out + tail, 0).at(out + 100_000)
    assert bench.told(c.REPORT_COUNT) == [(count, 1 + count)]


# A burst in which one frame follows another without a gap: what could be read is counted as such.
def test_t4_noise_before_and_behind_a_report_in_one_burst():
    bench = Bench().hear(10, c.CRR).carrier(1000, 1, 0)
    bench.at(1000 + SLOT + 50 + SLOT).frame(c.CRR).carrier(1000 + 2 * SLOT + 50 + 20, 0)
    assert bench.at(10 + SLOT + LONG).told(c.REPORT_COUNT) == [(0, 1 + 2 + 1 + 1)]


def test_t4_a_tail_and_a_report_in_one_burst():
    bench = collided(TAU + 5)
    out = LONG + TAU + 5 + SLOT
    bench.carrier(out, 1).at(out + TAU + SLOT).frame(c.CRR).carrier(out + TAU + SLOT + 20, 0)
    assert bench.at(out + 100_000).told(c.REPORT_COUNT) == [(2, 3)]


@pytest.mark.parametrize(("tail", "turns"), [(LONG - SLOT - 1, 0), (LONG - SLOT, 1)])
def test_t5_a_packet_that_began_in_our_own_report(tail, turns):
    bench = collided(TAU + 5)
    out = LONG + TAU + 5 + SLOT
    bench.carrier(out, 1).carrier(out + tail, 0)
    assert len(bench.told(c.REPORT_COUNT)) == turns


@pytest.mark.parametrize(("length", "left"), [(SLOT, 1), (3 * SLOT, 0)])
def test_a_window_that_would_close_in_a_burst_closes_behind_it(length, left):
    bench = collided(TAU + 5)
    out = LONG + TAU + 5 + SLOT
    bench.carrier(out, 0)
    end = bench.due[c.MAIN] - 100 + length
    bench.noise(bench.due[c.MAIN] - 100, end)
    # Two slots and more are no CR-R here, but a turn cut short; ours is the first none the less.
    assert bench.told(c.REPORT_COUNT) == [(left, 1 + left)]
    bench.at(end + D)
    assert bench.sent[2:] == [(end + (D if left else G), c.DATA)]


def test_a_window_that_closes_while_we_report():
    bench = after_own_packet().carrier(LONG, 1, 0).carrier(2 * LONG - 300, 1, 1)
    bench.carrier(2 * LONG - 100, 0).hear(2 * LONG + 4, c.CRR)
    first, tc = 2 * LONG + 4 + SLOT, LONG - 300 - TAU
    assert first + tc < bench.due[c.MAIN] < first + tc + SLOT
    bench.at(first + tc + SLOT - 1)
    assert bench.told(c.REPORT_COUNT) == []
    bench.carrier(first + tc + SLOT, 0)
    assert bench.sent[1:] == [(first + tc, c.CRR), (first + tc + SLOT, c.DATA)]


# T5: "noise >= T is a collided packet, not CR-Rs"
def test_t5_a_long_noise_ends_the_window():
    bench = Bench().hear(10, c.CRR).noise(2000, 2000 + LONG)
    assert bench.told(c.REPORT_COUNT) == [(0, 1)]
    assert bench.station.total == 2
