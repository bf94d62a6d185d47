"""Robots move: their links follow the formula, and they are told where they are."""

import itertools
import math

import pytest

from innervate.scenario.robots import Walk
from innervate.topology.placement import UNHEARD
from tests.networks.mesh.pinger import REPORT_HEARD, REPORT_PLACE, REPORT_SPEED
from tests.networks.mesh.runs import mesh_plan, radio, run

BASE = -4_000
PLACES = [(0, 0), (3_000, 0), (0, 5_000)]
SECOND = 1_000_000
POINTS = ((0, 0, 0), (2 * SECOND, 4_000, -600), (3 * SECOND, 4_000, 400))
EXPONENT = 3.3


def walking(duration_s, points=POINTS, **more):
    """Node 0 is a robot that walks, 1 and 2 stand still; a beacon every 100 ms."""
    n = 3
    base = [UNHEARD if i == j else BASE + 10 * i - 7 * j for i in range(n) for j in range(n)]
    medium = radio(n, {(0, 1): -9_000}, base_cdb=base, exponent_c=round(100 * EXPONENT))
    plan = mesh_plan(n, medium, duration_s=duration_s, robots=[1, 0, 0], positions_cm=PLACES)
    plan.params |= {"period": 2, "tick_us": 100_000, "unit_cm": 1}
    plan.walks, plan.starts_us = [Walk(0, points)], [0, 0, 0]
    for name, value in more.items():
        setattr(plan, name, value)
    return plan


def at(time, points=POINTS):
    """Where the robot is, in floating point."""
    for (t0, x0, y0), (t1, x1, y1) in itertools.pairwise(points):
        if t0 <= time < t1:
            share = (time - t0) / (t1 - t0)
            return x0 + share * (x1 - x0), y0 + share * (y1 - y0)
    return points[-1][1:]


def reports(result, code):
    rows = result.rows[(result.rows["code"] == code) & (result.rows["node"] == 0)]
    return rows[["time", "a", "b"]].tolist()


def test_a_robot_is_told_where_it_is_at_every_sample():
    told = reports(run(walking(3.5)), REPORT_PLACE)
    assert len(told) == 175
    assert {b[0] - a[0] for a, b in itertools.pairwise(told)} == {20_000}
    for time, x, y in told:
        exact = at(time)
        assert (x, y) == (pytest.approx(exact[0], abs=0.5001), pytest.approx(exact[1], abs=0.5001))


def test_it_is_told_its_speed_in_2_cm_per_second():
    for time, vx, vy in reports(run(walking(3.5)), REPORT_SPEED):
        if time < 2 * SECOND:
            assert (vx, vy) == (127, -127)  # 20 m/s and 3 m/s: more than fits
        else:
            assert (vx, vy) == ((0, 127) if time < 3 * SECOND else (0, 0))
    slow = ((0, 0, 0), (SECOND, 99, -51), (2 * SECOND, 99, -51))
    told = reports(run(walking(1.5, slow)), REPORT_SPEED)
    assert {row[1:] for row in told} == {(50, -25), (0, 0)}


def test_places_are_relative_to_the_fence_in_its_unit():
    plan = walking(0.5, ((0, 1_234, 777),), origin_cm=(200, -300))
    plan.params["unit_cm"] = 10
    assert {row[1:] for row in reports(run(plan), REPORT_PLACE)} == {(103, 108)}


def test_what_stands_still_is_a_robot_too():
    plan = walking(0.5, walks=[], robots=[0, 1, 0])
    rows = run(plan).rows
    found = rows[rows["code"] == REPORT_PLACE]
    assert {tuple(row) for row in found[["node", "a", "b"]].tolist()} == {(1, 3_000, 0)}


@pytest.mark.parametrize("stop_us", [0, 700_000, 1_500_000, 2_999_999])
def test_links_follow_the_formula(stop_us):
    x, y = (round(c) for c in at(stop_us))
    result = run(walking(0.5, ((0, x, y),)))
    for j in (1, 2):
        distance_m = max(1.0, math.hypot(x - PLACES[j][0], y - PLACES[j][1]) / 100)
        for sender, receiver in ((0, j), (j, 0)):
            base = BASE + 10 * sender - 7 * receiver
            exact = base / 100 - 10 * EXPONENT * math.log10(distance_m)
            place = sender * 3 + receiver
            assert result.world.rssi[place] / 100 == pytest.approx(exact, abs=0.05)
            chance = 1 / (1 + math.exp(-(exact + 95)))
            assert result.world.prob[place] / 32_768 == pytest.approx(chance, abs=0.03)
            power = result.world.power[place]
            assert 10 * math.log10(power * 1e-15) == pytest.approx(exact, abs=0.11)


def test_receivers_are_told_the_rssi_of_the_place():
    result = run(walking(2.9))
    rows = result.rows[(result.rows["code"] == REPORT_HEARD) & (result.rows["node"] == 1)]
    rows = rows[rows["a"] == 0]
    assert len(rows) > 20
    levels = set()
    for row in rows:
        sampled = [at(int(row["time"]) - late) for late in (0, 20_000)]  # the newest sample
        exact = [
            (BASE - 7) / 100 - 10 * EXPONENT * math.log10(max(1, math.hypot(x - 3_000, y) / 100))
            for x, y in sampled
        ]
        assert min(exact) - 0.56 <= row["b"] <= max(exact) + 0.56
        levels.add(int(row["b"]))
    assert len(levels) > 8


def test_signals_on_the_air_move_with_their_sender():
    """Whatever moves while frames are on the air, nothing is left of them afterwards."""
    plan = walking(3.0, sample_us=700)
    result = run(plan)
    assert result.counts["transmissions"] > 60
    on_air = [a.node for a in result.world.air if a.state == 3]
    expected = [sum(result.world.power[i * 3 + j] for i in on_air if i != j) for j in range(3)]
    assert [int(total) for total in result.world.sums] == expected
