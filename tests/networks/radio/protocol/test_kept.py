"""Practical CSMA/CD-R: places that are kept without packets, and what becomes of disagreement."""

import pytest

from innervate.dialect import plain
from innervate.dialect.outbox import SEND
from innervate.networks.radio.protocol import fields, modes, reporter, turn, window
from innervate.networks.radio.protocol.constants import ACT, CRR, KEPT, NONE, REPORT
from innervate.networks.radio.protocol.modes import ACTIVE, QUIET, QUIET_MOST
from innervate.networks.radio.protocol.times import minislot
from innervate.networks.radio.scenario.plan import parameters

Frame = plain.make("Frame", fields.FRAME)
Params = plain.make("Params", fields.PARAMS)
Station = plain.make("Station", fields.STATION, fields.PRACTICAL)
SLOW_US = 2000


def params_of(ta=SLOW_US):
    params = Params()
    for name, value in parameters(5, ta, (52, 104)).items():
        setattr(params, name, value)
    return params


def station_in(place, others=(0, 1, 2, 3), queued=1):
    """A station in a place of its own, or NONE, that knows of others, all without turns."""
    station = Station()
    station.rng, station.choice, station.pos, station.queued = 1, -1, place, queued
    for other in others:
        station.live[other] = QUIET
    station.cur = NONE
    return station


def asked(station, params, size=6):
    """The minislot in which it asks in a window of so many; NONE if in none."""
    out = plain.Outbox(Frame, 16)
    window.enter_first(station, params, 0, size, 0, out)
    if station.act == 0:
        return NONE
    due = next(one.b for one in out.action[: out.count[0]] if one.a == ACT)
    window.use_slot(station, params, due, out)
    station.mode = modes.WINDOW  # and the radio listens again
    kinds = [f.kind for a, f in zip(out.action, out.frame, strict=False) if a.kind == SEND]
    return due // minislot(params, 0) if CRR in kinds else NONE


def report_of(good=(), bad=(), kept=4, base=4):
    frame = Frame()
    frame.kind, frame.kept, frame.base = REPORT, kept, base  # the turn of place 0 follows
    for words, places in ((frame.good, good), (frame.bad, bad)):
        for place in places:
            reporter.set_bit(words, place)
    return frame


def hear(station, params, frame):
    window.hear_report(station, params, 9000, frame, plain.Outbox(Frame, 16))


@pytest.mark.parametrize("place", range(4))
def test_a_kept_place_asks_in_the_minislot_of_its_number(place):
    params = params_of()
    assert asked(station_in(place), params) == place
    assert asked(station_in(place, queued=0), params) == NONE


def test_newcomers_ask_behind_kept_places():
    params = params_of()
    for choice in range(2):
        newcomer = station_in(NONE)
        newcomer.choice = choice
        assert asked(newcomer, params) in (4, 5)


def test_who_asked_in_its_own_minislot_has_its_turn_and_newcomers_get_the_places_behind():
    params = params_of()
    owner, newcomer = station_in(2), station_in(NONE)
    asked(owner, params)
    slot = asked(newcomer, params)
    for station in (owner, newcomer):
        hear(station, params, report_of(good=(2, slot)))
    assert (owner.pos, newcomer.pos) == (2, 4)
    assert owner.live[2] == newcomer.live[2] == owner.live[4] == newcomer.live[4] == ACTIVE
    assert owner.live[3] >= QUIET


def test_two_that_ask_in_one_place_both_contend_as_newcomers():
    params = params_of()
    both = [station_in(2), station_in(2)]
    for station in both:
        assert asked(station, params) == 2
        hear(station, params, report_of(bad=(2,)))
        assert station.pos == NONE
        assert station.queued == 1


def test_who_reads_that_another_used_its_place_gives_it_up():
    params = params_of()
    silent = station_in(2, queued=0)
    asked(silent, params)
    hear(silent, params, report_of(good=(2,)))
    assert silent.pos == NONE


def test_a_reporter_whose_place_another_used_gives_it_up():
    station = station_in(2)
    station.kept = 4
    reporter.set_bit(station.good, 2)
    reporter.answer_kept(station)
    assert station.pos == NONE
    mine = station_in(1)
    mine.kept = 4
    reporter.answer_kept(mine)
    assert (mine.pos, mine.live[1], reporter.bit(mine.good, 1)) == (1, ACTIVE, 1)


def test_a_newcomer_in_the_minislot_of_a_place_gets_none():
    params = params_of()
    stranger = station_in(NONE, others=())
    stranger.choice = 0
    slot = asked(stranger, params)
    assert slot < 4
    hear(stranger, params, report_of(good=(slot,)))
    assert stranger.pos == NONE


def test_a_place_that_nobody_uses_is_free_again():
    station = station_in(1, queued=0)
    for _ in range(QUIET_MOST - QUIET + 1):
        modes.age_kept(station, params_of())
    assert station.pos == NONE
    assert modes.count_kept(station) == 0
    assert modes.first_free(station, params_of()) == 0


def test_quick_radios_keep_none_and_slow_ones_no_more_than_minislots():
    for ta, most in ((0, 0), (SLOW_US, KEPT)):
        station = station_in(NONE, others=())
        for place in range(KEPT + 5):
            modes.rest(station, params_of(ta), place)
        assert modes.count_kept(station) == most
    assert modes.window_of(params_of(), modes.code_for(params_of(), KEPT + 1)) == KEPT + 1


def test_the_larger_a_window_the_rarer():
    params, station = params_of(), station_in(0)
    station.turns = params.turns - 1
    assert turn.is_due(station, params, 1)
    assert not turn.is_due(station, params, 6)
    station.turns += 10
    assert turn.is_due(station, params, 6)
