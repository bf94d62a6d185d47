"""Practical CSMA/CD-R with slow radios: rounds that go on without packets, and how they end."""

from dataclasses import replace

import numpy as np
import pytest

from innervate.dialect import plain
from innervate.dialect.outbox import SEND
from innervate.networks.radio.papers.delay import PRACTICAL, Offered
from innervate.networks.radio.protocol import fields, idle, modes, turn
from innervate.networks.radio.protocol.constants import DATA, MAIN, NONE, OPEN, REPORT
from innervate.networks.radio.protocol.modes import (
    ACTIVE,
    CALM,
    CALM_MOST,
    EARNED,
    FLOWING,
    QUIET,
)
from innervate.networks.radio.protocol.times import (
    asking,
    is_few,
    pass_slots,
    probe,
    probe_slots,
    retry_within,
)
from innervate.networks.radio.scenario.plan import RadioFault, parameters
from innervate.networks.radio.sim.simulate import simulate
from innervate.scenario.actions.channel import KILL
from tests.networks.radio.runs import radio_plan

Frame = plain.make("Frame", fields.FRAME)
Params = plain.make("Params", fields.PARAMS)
Station = plain.make("Station", fields.STATION, fields.PRACTICAL)
SLOW_US = 2000
FEW = 8  # at 2 ms, a packet a turn


def params_of(ta=SLOW_US, **more):
    params = Params()
    for name, value in parameters(5, ta, (52, 104), **more).items():
        setattr(params, name, value)
    return params


def member(places=5, queued=0, credit=EARNED * 4, calm=CALM):
    """The station in place 0 of a round in which packets were sent lately."""
    station = Station()
    station.rng, station.choice, station.pos = 1, -1, 0
    station.credit, station.calm, station.queued = credit, calm, queued
    for place in range(places):
        station.live[place] = ACTIVE
    station.cur = 0
    for i in range(queued):
        station.size[i] = 5
    return station


def turn_of(station, params):
    """The frame that it sends in its turn."""
    out = plain.Outbox(Frame, 16)
    turn.enter_turn(station, params, 0, 0, out)
    (sent,) = (f for a, f in zip(out.action, out.frame, strict=False) if a.kind == SEND)
    return sent


@pytest.mark.parametrize(("per_turn", "most"), [(1, FEW), (4, 12)])
def test_few_are_as_many_as_a_round_asks_no_slower_than_windows(per_turn, most):
    params = params_of(per_turn=per_turn)
    assert [is_few(params, places) for places in (1, most, most + 1)] == [1, 1, 0]


def test_the_slower_the_radio_the_fewer():
    most = [max(n for n in range(1, 21) if is_few(params_of(ta), n)) for ta in (1000, 2000, 8000)]
    assert most == sorted(most, reverse=True)
    assert most[0] > most[-1]


@pytest.mark.parametrize(("places", "goes_on"), [(2, 1), (FEW, 1), (FEW + 1, 0), (20, 0)])
def test_where_few_have_places_a_turn_without_a_packet_hands_on_and_keeps_its_own(places, goes_on):
    sent = turn_of(member(places), params_of())
    assert (sent.kind, sent.count, sent.slots, sent.next) == (DATA, 0, 2, 1)
    assert sent.more == goes_on


def test_a_place_without_a_turn_has_one_again_while_the_round_goes_on():
    station = member(4)
    station.live[1] = QUIET
    assert turn_of(station, params_of()).next == 1
    many = member(FEW + 1)
    many.live[1] = QUIET
    assert turn_of(many, params_of()).next == 2


@pytest.mark.parametrize("gone", [{"credit": 0}, {"calm": CALM - 1}])
def test_a_round_ends_without_packets_and_does_not_begin_while_newcomers_come(gone):
    station = member(**gone)
    sent = turn_of(station, params_of())
    assert (sent.slots, sent.more) == (2, 0)
    assert station.live[0] == QUIET  # it keeps its place, and asks in a window


@pytest.mark.parametrize(
    ("flow", "calm", "per_turn", "goes_on"),
    [(FLOWING, CALM_MOST, 4, 1), (FLOWING - 1, CALM_MOST, 4, 0), (FLOWING, CALM_MOST - 1, 4, 0),
     (FLOWING, CALM_MOST, 1, 0)],
)  # fmt: skip
def test_many_keep_their_turns_while_packets_flow(flow, calm, per_turn, goes_on):
    params = params_of(per_turn=per_turn)
    station = member(20, credit=modes.EARNED_MOST, calm=calm)
    station.flow = flow + 11  # of which this turn takes so many
    sent = turn_of(station, params)
    assert (sent.count, sent.next, sent.more, station.flow) == (0, 1, goes_on, flow)


@pytest.mark.parametrize(("places", "packets"), [(13, 8), (13, 4), (20, 14), (20, 8)])
def test_packets_are_worth_the_more_the_fewer_places_there_are(places, packets):
    """A round of so many places with so many packets, one in a turn, makes up for its turns."""
    params, station = params_of(per_turn=4), member(places)
    for _ in range(20):
        for place in range(places):
            modes.note_flow(station, params, 1 if place < packets else 0)
    assert (station.flow >= FLOWING) == (packets > places / 2)


def test_a_window_for_kept_places_takes_from_the_flow():
    params, station = params_of(per_turn=4), member(20)
    for place in range(20):
        station.live[place] = QUIET
    station.flow = FLOWING
    modes.age_kept(station, params)
    assert station.flow == FLOWING - asking(params, 20) // params.slot_us
    for _ in range(20):
        modes.age_kept(station, params)
    assert station.flow == 0


def test_twenty_with_full_turns_pass_them_on_instead_of_asking_in_windows():
    def sent_of(load):
        sent = simulate(Offered(PRACTICAL, 4, 5, 20, load, 1000).plan(1), checks=False).sent
        late = sent[sent["time"] > sent["time"].max() // 2]
        return [int((late["kind"] == kind).sum()) for kind in (REPORT, DATA)]

    (reports, turns), (asked, used) = sent_of(0.9), sent_of(0.45)
    assert turns > 80 * max(reports, 1)
    assert used < 8 * asked


def test_who_leaves_does_not_stay_in_the_round():
    station = member()
    station.leaving = 1
    assert turn_of(station, params_of()).more == 0


@pytest.mark.parametrize("places", range(2, FEW + 1))
def test_the_more_places_the_sooner_a_round_without_packets_ends(places):
    station, params, turns = member(places, credit=modes.EARNED_MOST), params_of(), 0
    while turn_of(station, params).more:
        turns += 1
    assert turns == -(-modes.EARNED_MOST // places**2) - 1
    assert 10 < turns <= 400


def test_packets_of_ours_and_of_others_keep_a_round_going():
    station = member(queued=1, credit=0)
    sent = turn_of(station, params_of())
    assert (sent.count, sent.more, station.credit) == (1, 1, EARNED)
    modes.earn(station, 100)
    assert station.credit == modes.EARNED_MOST


def test_windows_that_nobody_comes_to_become_rarer():
    params, station = params_of(), member(5)
    due = []
    for calm in range(CALM_MOST + 1):
        station.calm = calm
        station.turns = 0
        while not turn.is_due(station, params, 1):
            station.turns += 1
        due.append(station.turns + 1)
    assert due == [5, 10, 20, 40, 80, 80, 80, 80]
    station.joined = 1
    modes.note_joined(station, 1)
    assert station.calm == 0


def test_slow_radios_that_collided_draw_moments_at_which_the_later_hears_the_earlier():
    params, station = params_of(), member()
    waits = set()
    for choice in range(9):
        station.choice, station.lonely = choice, 0
        out = plain.Outbox(Frame, 16)
        idle.wait_again(station, params, 0, 0, out)
        waits |= {one.b for one in out.action[: out.count[0]] if one.a == MAIN}
    apart = np.diff(sorted(waits))
    assert len(waits) == 7
    assert apart.min() > params.ta_us + params.dmax_us
    assert max(waits) - min(waits) < retry_within(params, 0)


def opening_of(station, params):
    """The frame by which it opens a sequence."""
    out = plain.Outbox(Frame, 16)
    idle.open_now(station, params, 0, out)
    (sent,) = (f for a, f in zip(out.action, out.frame, strict=False) if a.kind == SEND)
    return sent


@pytest.mark.parametrize(("ta", "wide", "packets"), [(SLOW_US, 0, 1), (SLOW_US, 1, 0), (0, 0, 0)])
def test_slow_radios_that_collided_try_again_with_a_packet_while_bounds_hold(ta, wide, packets):
    params, station = params_of(ta, per_turn=4), member(queued=3)
    station.collided, station.wide = 1, wide
    sent = opening_of(station, params)
    assert (sent.kind, sent.count, station.pending) == (OPEN, packets, packets)
    # Of two all hear both: a packet, and silence behind it, or a probe that overlaps the other.
    assert station.end - params.ta_us >= probe(params, wide)
    assert sent.slots == (5 if packets else probe_slots(params, wide))
    assert sent.more == 1
    assert station.mode == modes.SEND_OPEN


def test_tries_that_collide_again_do_not_make_a_station_leave_the_round():
    params, station = params_of(), member(queued=1)
    for _ in range(5):
        opening_of(station, params)
        assert station.pending == 1
        idle.retry(station, params, 0, 1, plain.Outbox(Frame, 16))
    assert (station.pending, station.queued, station.fails) == (0, 1, 1)


def test_of_two_that_collided_one_needs_no_turn():
    plan = radio_plan(2, 25, SLOW_US, 1)
    sent = np.sort(simulate(plan).sent, order="time")
    clean = sent[sent["count"] == 1][2:]
    assert clean["kind"].tolist() == [OPEN, DATA]
    assert len(set(clean["node"].tolist())) == 2


def test_quick_radios_pass_three_slots_as_before():
    assert (pass_slots(params_of(0)), pass_slots(params_of())) == (3, 2)
    station = member(credit=2)
    sent = turn_of(station, params_of(0))
    assert (sent.slots, sent.more, station.credit) == (3, 1, 1)


def sent_by(n, load, **more):
    plan = replace(Offered(PRACTICAL, 1, 5, n, load, 300).plan(1), **more)
    result = simulate(plan)
    return plan, result, result.sent[np.argsort(result.sent["time"], kind="stable")]


def test_a_silent_team_falls_silent():
    plan, result, sent = sent_by(5, 0.3, wanted=0, duration_us=60_000_000)
    last = max(max(times) for times in plan.arrivals)
    passes = sent[(sent["kind"] == DATA) & (sent["count"] == 0)]
    assert len(passes) > 300  # its rounds went on
    assert 500_000 < sent["end"].max() - last < 1_500_000
    assert result.counts["silent"] == 0


def test_who_dies_in_a_round_that_goes_on_has_no_turn_in_the_next():
    at, silent = 3_000_000, 5_000
    _, result, sent = sent_by(5, 0.3, wanted=0, duration_us=6_000_000,
                              faults=[RadioFault(at, KILL, 2, 0, 0)])  # fmt: skip
    place = sent[(sent["node"] == 2) & (sent["kind"] == DATA)]["pos"][-1]
    named = sent[(sent["kind"] == DATA) & (sent["time"] > at) & (sent["next"] == place)]
    assert len(named) == 1
    after = sent[sent["time"] > named["end"][0]]
    assert after["time"][0] - named["end"][0] < 3 * silent
    assert set(after["node"].tolist()) == {0, 1, 3, 4}
    assert result.counts["silent"] == 0
    assert NONE not in after["pos"]
