"""Robots that err about their place: what the protocol is told has the error, the truth has not."""

from itertools import pairwise
from statistics import fmean, stdev

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import innervate
from innervate import scenario as scenarios
from innervate.scenario.errors import ScenarioError
from innervate.scenario.robots import Walk
from tests.networks.mesh.pinger import REPORT_PLACE, REPORT_SPEED
from tests.networks.mesh.runs import run
from tests.networks.mesh.sim.test_motion import POINTS, at, reports, walking

FENCED = {
    "kind": "mesh", "nodes": 3, "duration_s": 12.0,
    "link": [{"a": 0, "b": 1}, {"a": 1, "b": 2}, {"a": 0, "b": 2}],
    "radio": {"profile": "ideal"},
    "fence": {"polygon": [[0, 0], [20, 0], [20, 20], [0, 20]]},
}  # fmt: skip


def told(noise_um, hold_us=0, seed=1, duration_s=8.0, **more):
    """What a robot was told beyond where it was, cm: two lists; and its run."""
    plan = walking(duration_s, seed=seed, **more)
    plan.walks = [Walk(0, POINTS, noise_um, hold_us)]
    result = run(plan)
    rows = reports(result, REPORT_PLACE)
    exact = [at(time) for time, _, _ in rows]
    xs, ys = ([row[k] - one[k - 1] for row, one in zip(rows, exact, strict=True)] for k in (1, 2))
    return xs, ys, result


@given(noise_m=st.sampled_from([0.1, 0.5, 2.0, 30.0]), seed=st.integers(0, 2**32))
@settings(deadline=None, max_examples=12)
def test_what_is_told_is_off_by_nothing_on_the_mean_and_spread_as_asked(noise_m, seed):
    """Four hundred samples: means are right to a fifth of the spread, spreads to a sixth."""
    xs, ys, _ = told(round(1e6 * noise_m), seed=seed)
    assert len(xs) == 400
    for errors in (xs, ys):
        assert abs(fmean(errors)) < 0.25 * 100 * noise_m
        assert stdev(errors) == pytest.approx(100 * noise_m, rel=0.17)


def test_an_error_that_holds_changes_little_from_sample_to_sample():
    xs, _, _ = told(2_000_000, 10_000_000)
    steps = [b - a for a, b in pairwise(xs)]
    # Of 2 m, by sqrt(1 - exp(-0.004)) in 20 ms.
    assert stdev(steps) == pytest.approx(200 * 0.0632, rel=0.12)
    assert max(map(abs, xs)) > 20


def test_where_it_is_and_how_fast_are_as_without():
    *_, exact = told(0)
    xs, _, wrong = told(2_000_000)
    assert max(map(abs, xs)) > 200
    assert reports(wrong, REPORT_SPEED) == reports(exact, REPORT_SPEED)
    assert [(one.x, one.y) for one in wrong.world.radios] == [
        (one.x, one.y) for one in exact.world.radios]  # fmt: skip
    assert wrong.world.rssi == exact.world.rssi
    assert wrong.sent["receivers"].tolist() == exact.sent["receivers"].tolist()


def test_errors_depend_on_seed_and_robot_alone():
    first, again, other = told(500_000), told(500_000), told(500_000, seed=2)
    assert first[0] == again[0]
    assert first[2].fingerprint == again[2].fingerprint
    assert first[0] != other[0]
    plan = walking(8.0)
    plan.walks = [Walk(1, ((0, 5, 5),), 9_000_000), Walk(0, POINTS, 500_000)]
    plan.robots = [1, 1, 0]
    rows = reports(run(plan), REPORT_PLACE)
    assert [row[1] - at(row[0])[0] for row in rows] == first[0]


def test_errors_are_rounded_with_the_place_to_the_fences_unit():
    plan = walking(2.0, ((0, 1_234, 777),))
    plan.walks = [Walk(0, ((0, 1_234, 777),), 100_000)]
    fine = [row[1] for row in reports(run(plan), REPORT_PLACE)]
    plan.params["unit_cm"] = 10
    assert [row[1] for row in reports(run(plan), REPORT_PLACE)] == [(x + 5) // 10 for x in fine]


def ran(**robot):
    way = {"node": 2, "waypoints": [[10, 10], [10, 19]], "start_s": 3.0, "speed_mps": 3.0}
    scenario = scenarios.from_dict(FENCED | {"robot": [way | robot]})
    return innervate.run(scenario, plain=True)


def test_no_error_is_as_if_there_was_no_such_key():
    plain, none = ran(), ran(position_noise_m=0.0)
    assert plain.summary["fingerprint"] == none.summary["fingerprint"]
    assert plain.summary["alarms"]["sent"] == plain.summary["alarms"]["false"] == 0


def test_an_alarm_of_a_robot_that_never_leaves_is_told_as_false():
    """It stops a metre inside, with an error of half a metre that changes at every sample."""
    done = ran(position_noise_m=0.5)
    found = done.summary["alarms"]
    assert (found["sent"], found["delivered"]) == (0, 0)
    assert found["false"] > 0
    assert found["false_delivered"] > 0
    assert found["false_per_hour"] == pytest.approx(300 * found["false"])
    said = f"{found['false']} alarm"
    assert done.summary["headline"]["level"] == "degraded"
    assert said in done.summary["headline"]["text"]
    assert said in done.report()


def test_keys_are_planned_in_whole_numbers_and_refused_with_their_limits():
    def planned(**robot):
        return scenarios.plan(scenarios.from_dict(FENCED | {"robot": [
            {"node": 2, "waypoints": [[10, 10]], **robot}]})).walks[0]  # fmt: skip

    assert (planned().noise_um, planned().hold_us) == (0, 0)
    one = planned(position_noise_m=0.25, position_hold_s=30)
    assert (one.noise_um, one.hold_us) == (250_000, 30_000_000)
    for robot, why in (
        ({"position_noise_m": -0.1}, "position_noise_m"),
        ({"position_noise_m": 101}, "at most 100"),
        ({"position_noise_m": 1, "position_hold_s": 3_601}, "at most 3600"),
        ({"position_hold_s": 3}, "position_hold_s goes with position_noise_m"),
    ):
        with pytest.raises(ScenarioError, match=why):
            planned(**robot)
