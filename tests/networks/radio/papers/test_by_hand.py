"""Plans and curves that figures of the radio are made of."""

import math
from types import SimpleNamespace as Of

import numpy as np
import pytest

from innervate.networks.radio.papers import common, delay, fairness, limits, medium, members
from innervate.plot import style


def offered(mac, **more):
    given = {"per_turn": 1, "size": 5, "n": 4, "load": 0.5, "packets": 80} | more
    return delay.Offered(mac, **given).plan(3)


def test_all_protocols_are_offered_the_same_until_the_first_station_has_no_more():
    ours = offered(delay.PRACTICAL)
    assert ours.wanted == sum(map(len, ours.arrivals)) < 80
    assert max(len(times) for times in ours.arrivals) == 20
    last = min(times[-1] for times in ours.arrivals if len(times) == 20)
    assert max(max(times) for times in ours.arrivals) == last
    for mac in {mac for mac, _ in delay.LOOKS} - {delay.PRACTICAL}:
        other = offered(mac)
        assert (other.arrivals, other.wanted) == (ours.arrivals, ours.wanted)
        assert other.protocol == (delay.DCF if mac in delay.GRANTED else mac)


def test_an_answer_comes_after_both_ways_and_a_slot():
    """Each way a switch of the radio and the longest delay there may be."""
    params = offered(delay.DCF_ANSWERS).params
    assert params["ta_us"] == 2_000
    assert params["answer_us"] == 2 * (2_000 + params["dmax_us"]) + 208
    assert offered(delay.DCF).params | {"answer_us": params["answer_us"]} == params


def test_a_curve_has_marks_at_some_of_its_places_and_looks_as_its_protocol_does():
    look = common.LOOKS["csma-cd-d1"]
    x, y = [2, 4, 5, 100, 101], [1.0, 2.0, 3.0, 4.0, 5.0]
    with style.house():
        _, (ax,) = style.panels(1, 1)
        common.line(ax, look, x, y)
        common.line(ax, look, x, y, marks=(4, 9))
        some, other = ax.get_lines()
    assert (some.get_markevery(), other.get_markevery()) == ([0, 2, 3], [1])
    assert (some.get_xdata().tolist(), some.get_ydata().tolist()) == (x, y)
    shown = some.get_color(), some.get_marker(), some.get_label()
    assert shown == (look.colour, look.marker, look.name)
    assert (some.get_linewidth(), some.get_markersize()) == (1.1, 3)


@pytest.mark.parametrize("draw", [common.bars, common.band])
def test_spread_is_from_5_to_95_of_100_runs(draw):
    runs = np.array([np.arange(101.0), 10 * np.arange(101.0)])
    with style.house():
        _, (ax,) = style.panels(1, 1)
        draw(ax, common.LOOKS["dcf"], [3, 7], runs)
        corners = [path.vertices for shape in ax.collections for path in shape.get_paths()]
    heights = {round(y, 6) for part in corners for x, y in part if x in (3, 7)}
    assert heights == {5.0, 50.0, 95.0, 950.0}


@pytest.mark.parametrize(("least", "most"), [(1, 60.0), (0, 900.0)])
def test_who_got_nothing_has_waited_all_the_time(monkeypatch, least, most):
    """Percentiles are over the packets of all runs, indices means over the runs."""
    made = [
        Of(elapsed_slots=900.0, successes=[4, least], delay_slots=np.array([10.0, 20.0, 60.0]),
           jain_round=0.5, order=[0, 1, 2, 0, 1, 2]),
        Of(elapsed_slots=5000.0, successes=[3, 3], delay_slots=np.array([30.0]), jain_round=0.9,
           order=[0, 1, 0, 0]),
        Of(elapsed_slots=70.0, successes=[2, 1], delay_slots=np.array([40.0]), jain_round=1.0,
           order=[0, 1, 0, 1]),
    ]  # fmt: skip
    asked = []

    def slotted(*given, seed, **more):
        asked.append((given, more))
        return made[seed - 1]

    monkeypatch.setattr(fairness, "seeds", lambda quick: 3)
    monkeypatch.setattr(fairness, "slotted", slotted)
    found = fairness.waits("dcf", 0.4, True)
    assert found["delay"] == [*np.percentile([10, 20, 60, 30, 40], fairness.SHARES), most]
    assert found["jain_round"] == pytest.approx(0.8)
    assert found["longest"] == pytest.approx((1 + 0.5 + 1) / 3)
    usual = {"packets": fairness.packets(True), "load": 0.4}
    assert asked == [(("dcf", fairness.N, fairness.SIZE, "poisson"), usual)] * 3
    asked.clear()
    fairness.waits("dcf", None, True)
    assert {given[3] for given, _ in asked} == {"saturated"}


def test_moments_at_which_another_loses_a_packet_are_drawn_hollow():
    found = {"at_us": [0.0, 1000.0, 2000.0, 3000.0], "lost": [0.0, 1.0, 0.0, -1.0],
             "left": [0.0, 0.0, 2.0, 0.0], "extra": [1.0, 2.0, 3.0, 4.0]}  # fmt: skip
    with style.house():
        _, (ax,) = style.panels(1, 1)
        members._dots(ax, found, "paper")
        fine, bad = ax.get_lines()
        members._dots(ax, found | {"lost": [0.0] * 4, "left": [0.0] * 4}, "paper")
        (other,) = ax.get_lines()[2:]
    assert (fine.get_xdata().tolist(), fine.get_ydata().tolist()) == ([0.0, 3.0], [1.0, 4.0])
    assert (bad.get_xdata().tolist(), bad.get_ydata().tolist()) == ([1.0, 2.0], [2.0, 3.0])
    assert bad.get_markerfacecolor() == "none"
    assert other.get_xdata().tolist() == [0.0, 1.0, 2.0, 3.0]


def test_delays_of_pairs_are_all_there_may_be_or_one_for_all():
    for mode, found in (("practical", range(52, 105)), ("paper", [104])):
        delays = medium.Channel(mode, 40).plan(3).delays_us
        assert {delays[i][j] for i in range(40) for j in range(i)} == set(found)
        assert all(delays[i][j] == delays[j][i] for i in range(40) for j in range(i))
        assert {delays[i][i] for i in range(40)} == {0}


def test_gaps_between_packets_are_as_long_as_the_draw_is_seldom(monkeypatch):
    """The greatest draw is no gap at all, the least 30 ln 2 of the mean."""
    draws = np.array([0, (1 << 29) - 1, (1 << 30) - 1])
    monkeypatch.setattr(medium, "uniform", lambda seed, name, count, below: draws)
    channel = medium.Channel("paper", 2, 10, traffic="poisson", packets=3, load=0.5)
    mean_us = 2 * 10 * 208 / 0.5
    times = [100_000 + int(many * math.log(2) * mean_us) for many in (30, 31, 31)]
    assert channel._arrivals(1, 208) == [times, times]


def test_what_becomes_of_the_packets_of_those_who_stay():
    fields = [(name, np.int64) for name in ("node", "receivers", "end")]
    rows = np.array([(0, 3, 1_100), (1, 0, 1_500), (3, 3, 2_000)], fields)
    plan = Of(arrivals=[[100], [300], [200], [50]], params={"slot_us": 10})
    assert members.others(Of(plan=plan, packets=rows), 3) == (1, 1, 100.0)
    assert members.others(Of(plan=plan, packets=rows), 2) == (1, 0, 195.0)
    assert members.others(Of(plan=plan, packets=rows[1:2]), 3) == (1, 2, 0)


@pytest.mark.parametrize(("saturated", "completed", "left"), [
    (True, 3, 6), (True, 9, 0), (True, 11, 0), (False, 3, 2), (False, 5, 0), (False, 6, -1),
])  # fmt: skip
def test_packets_that_do_not_get_through_are_of_those_wanted_or_offered(saturated, completed, left):
    plan = Of(saturated=saturated, wanted=9, arrivals=[[1, 2], [], [3, 4, 5]])
    assert medium.left_open(Of(plan=plan, counts={"completed": completed})) == left


def test_turns_without_slots_fill_what_the_bound_of_hand_overs_allows():
    found = limits.turns()
    assert (found["low_us"], found["high_us"]) == (limits.SLOT / 2, limits.SLOT / 2)
    assert found["share"] == pytest.approx(25 / 25.5)


def test_all_stations_together_send_as_much_however_many_they_are(monkeypatch):
    """In whole rounds of ten packets each, so that the tenth left out ends with a round."""
    asked = []

    def slotted(_, n, *__, packets, **___):
        asked.append((n, packets))
        return Of(throughput=0.5, jain_round=1.0)

    monkeypatch.setattr(common, "slotted", slotted)
    curve = common.Curve("dcf", 5, "saturated", ns=(2, 7, 1_000), seeds=1, successes=20_000)
    assert curve.measure()["throughput"] == [[0.5]] * 3
    assert asked == [(2, 10_000), (7, 2_850), (1_000, 20)]
