"""Delays outside what stations believe: they measure, believe in more, and all packets arrive."""

import pytest

from innervate.networks.radio.protocol.constants import REPORT_BOUNDS, REPORT_WIDER
from tests.networks.radio.runs import radio_plan, run

REAL = [(1, 52), (40, 48), (48, 52), (50, 104), (52, 130), (52, 208)]  # believed: 52..104 us


def resolves(n, packet_slots, ta, real, seeds):
    """Every disaster completes; how many runs noticed that the bounds are wrong."""
    noticed = 0
    for seed in seeds:
        result = run(n, packet_slots, ta, seed, spread=ta + 104, real=real, checks=seed <= 2)
        what = f"delays {real} us, n={n} T={packet_slots} ta={ta} seed={seed}"
        assert result.counts["completed"] == n, f"{what}: {result.counts['completed']} delivered"
        assert result.counts["silent"] == 0, what
        codes = set(result.rows["code"].tolist())
        assert (REPORT_BOUNDS in codes) == (REPORT_WIDER in codes), what
        noticed += REPORT_BOUNDS in codes
    return noticed


@pytest.mark.parametrize("ta", [0, 2000])
@pytest.mark.parametrize("real", REAL)
def test_a_disaster_completes_whatever_the_delays(real, ta):
    noticed = resolves(10, 25, ta, real, range(1, 5))
    assert noticed == 4 or real == (50, 104)  # a pair of 50 us may never exchange a CR-R


@pytest.mark.parametrize(("n", "packet_slots", "ta", "real", "seed"), [
    (10, 5, 0, (52, 208), 2),  # CR-Rs behind a reporter that had gone on to its turn
    (20, 5, 300, (40, 48), 5006),
    (50, 5, 2000, (52, 130), 109),  # CR-Rs over the opening of one who follows another window
    (50, 5, 2000, (52, 208), 2),  # CR-Rs that ran together, taken for openings begun with ours
    (20, 5, 0, (1, 52), 5598),  # CR-Rs behind a turn of another round, in the window of an opening
    (20, 5, 300, (40, 48), 5593),  # windows of bounds that were believed to be wider than needed
])  # fmt: skip
def test_what_answers_another_window_proves_nothing(n, packet_slots, ta, real, seed):
    result = run(n, packet_slots, ta, seed, spread=ta + 104, real=real, checks=False)
    assert result.counts["completed"] == n
    assert result.counts["silent"] == 0


@pytest.mark.slow
@pytest.mark.parametrize("ta", [0, 2000])
@pytest.mark.parametrize(("n", "packet_slots"), [(10, 25), (5, 5), (10, 5), (20, 5), (50, 5)])
@pytest.mark.parametrize("real", REAL)
def test_two_hundred_disasters_complete_whatever_the_delays(real, n, packet_slots, ta):
    assert resolves(n, packet_slots, ta, real, range(1, 201)) >= 40


def test_what_one_station_measures_the_others_are_told():
    result = run(5, 5, 0, 1, real=(52, 208))
    told = result.rows[(result.rows["code"] == REPORT_WIDER) & (result.rows["b"] == 1)]
    assert len(told)
    beliefs = {int(station["wide"]) for station in result.world.stations}
    assert min(beliefs) >= 1
    assert max(result.rows[result.rows["code"] == REPORT_WIDER]["a"]) <= 104 << 3


def test_stations_that_go_on_saturated_with_wrong_bounds_keep_their_turns():
    result = run(5, 5, 2000, 1, "saturated", packets=40, real=(48, 52), duration_s=60)
    assert result.counts["completed"] >= 200
    assert result.counts["silent"] == 0


def test_true_bounds_are_believed():
    plan = radio_plan(10, 25, 0, 1)
    assert plan.params["dmin_us"] == 52
    result = run(10, 25, 0, 1)
    assert not set(result.rows["code"].tolist()) & {REPORT_BOUNDS, REPORT_WIDER}
