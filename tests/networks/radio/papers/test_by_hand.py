"""Plans and curves that figures of the radio are made of."""

from types import SimpleNamespace as Of

import numpy as np
import pytest

from innervate.networks.radio.papers import common, delay, fairness, medium, members
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
        assert other.protocol == (delay.DCF if mac == delay.DCF_ANSWERS else mac)


def test_an_answer_comes_after_both_ways_and_a_slot():
    """Each way a switch of the radio and the longest delay there may be."""
    params = offered(delay.DCF_ANSWERS).params
    assert params["ta_us"] == 2_000
    assert params["answer_us"] == 2 * (2_000 + params["dmax_us"]) + 208
    assert offered(delay.DCF).params | {"answer_us": params["answer_us"]} == params


def test_what_it_costs_the_others_is_told_without_who_moves():
    """Of four, of which 2 moves: 0 and 1 send, nobody hears 1's, 3's is left over."""
    packets = np.zeros(3, [("node", int), ("receivers", int), ("end", int)])
    packets["node"], packets["receivers"] = [0, 1, 2], [3, 0, 3]
    packets["end"] = [900, 5_000, 9_000]
    plan = Of(arrivals=[[100], [500], [60], [300]], params={"slot_us": 200})
    found = members.others(Of(plan=plan, packets=packets), 2)
    assert found == (1, 1, 4.0)


@pytest.mark.parametrize(("mode", "least", "most"), [("paper", 104, 104), ("practical", 52, 104)])
def test_delays_of_a_channel_are_the_papers_or_from_half_of_it_on(mode, least, most):
    plan = medium.Channel(mode, 20, traffic="saturated", packets=7).plan(5)
    pairs = [plan.delays_us[i][j] for i in range(20) for j in range(20) if i != j]
    assert (min(pairs), max(pairs)) == (least, most)
    assert all(plan.delays_us[i][j] == plan.delays_us[j][i] for i in range(20) for j in range(20))
    assert (plan.wanted, plan.duration_us) == (140, 200_000_000 + 400_000 * 140)


def test_a_channel_offers_its_load():
    """Of all stations together, packets in a packet's time: 1,500 in 6,000 of them at 0.25."""
    plan = medium.Channel("practical", 5, 25, 2_000, "poisson", packets=300, load=0.25).plan(5)
    packet_us = 25 * plan.params["slot_us"]
    ends = [times[-1] / packet_us for times in plan.arrivals]
    assert ends == pytest.approx([6_000] * 5, rel=0.2)
    assert sum(ends) / 5 == pytest.approx(6_000, rel=0.08)
    assert all(times == sorted(times) and times[0] > 0 for times in plan.arrivals)


@pytest.mark.parametrize(("saturated", "completed", "left"), [
    (True, 0, 6), (True, 5, 1), (True, 6, 0), (True, 9, 0), (False, 0, 3), (False, 3, 0),
])  # fmt: skip
def test_what_is_open_is_what_was_offered_or_wanted_and_not_completed(saturated, completed, left):
    plan = Of(saturated=saturated, wanted=6, arrivals=[[1, 2], [], [3]])
    assert medium.unfinished(plan, completed) == left


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

    monkeypatch.setattr(fairness, "seeds", lambda quick: range(1, 4))
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
