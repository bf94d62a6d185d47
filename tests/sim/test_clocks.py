"""Free-running clocks: a timer never fires early, at most 1 us late, and later ones not sooner."""

import functools

import pytest
from hypothesis import given
from hypothesis import strategies as st

from innervate import scenario
from innervate.dialect.arith import HALF30, MASK30
from innervate.networks.skin.sim import build
from innervate.sim import clocks

CELLS = 63
TIME = st.integers(0, 10**11)
DELAY = st.one_of(st.integers(0, 3), st.integers(0, 2**28), st.just(HALF30 - 1))
NODE = st.integers(0, CELLS)


@functools.cache
def world_of(drift_ppm=50_000):
    """A world of clocks that run up to 5 % fast or slow."""
    keys = {"kind": "skin", "patch": [{"columns": CELLS, "rows": 1}]}
    keys |= {"interface": [{"row": 0, "column": 0}], "timing": {"drift_ppm": drift_ppm}}
    return build.build(scenario.plan(scenario.from_dict(keys)), plain=True)


def reading(world, node, time):
    return clocks.reading(world.clocks[node], time)


def fires(world, node, time, delay):
    """True time at which a timer set now fires that is due when the clock shows `delay` more."""
    now = reading(world, node, time)
    return clocks.true_time(world, node, time, now, (now + delay) & MASK30)


@given(NODE, TIME, DELAY)
def test_a_timer_is_never_early_and_at_most_1_us_late(node, time, delay):
    world = world_of()
    target = reading(world, node, time) + delay
    at = fires(world, node, time, delay)
    assert at >= time
    assert target <= reading(world, node, at) <= target + 1
    if at > time:
        assert reading(world, node, at - 1) < target


@given(NODE, TIME, DELAY, DELAY)
def test_a_later_timer_does_not_fire_sooner(node, time, first, second):
    world = world_of()
    early, late = sorted((first, second))
    assert fires(world, node, time, early) <= fires(world, node, time, late)


@given(NODE, TIME, st.integers(1, 2**28))
def test_an_overdue_timer_fires_at_once(node, time, overdue):
    assert fires(world_of(), node, time, -overdue) == time


def test_what_is_half_a_round_ahead_or_more_is_overdue():
    world = world_of(0)
    assert fires(world, 0, 70, HALF30 - 1) == 70 + HALF30 - 1
    assert fires(world, 0, 70, HALF30) == 70


@given(NODE, TIME, st.integers(1, 10**6))
def test_a_clock_keeps_within_its_drift_and_never_goes_back(node, time, step):
    world = world_of()
    gone = reading(world, node, time + step) - reading(world, node, time)
    assert gone >= 0
    assert abs(gone - step) <= step * 0.05 + 1


def test_clocks_drift_both_ways_and_start_apart():
    world = world_of()
    rates = [clock.rate for clock in world.clocks]
    assert min(rates) < 0 < max(rates)
    assert max(map(abs, rates)) <= 0.05 * 2**30 + 1
    assert len({clock.offset for clock in world.clocks}) == CELLS + 1


@given(NODE, TIME, st.integers(1, 10**6))
def test_without_drift_a_period_is_a_period(node, time, period):
    assert fires(world_of(0), node, time, period) == time + period


@pytest.mark.parametrize("nodes", [1, 7])
def test_timers_and_nodes_can_be_told_from_a_slot(nodes):
    world = world_of()
    count = world.run[0].nodes
    slots = {clocks.timer_slot(world, node, timer) for node in range(count) for timer in range(4)}
    assert slots == set(range(4 * count))
    for timer in range(4):
        assert clocks.timer_of(world, clocks.timer_slot(world, nodes, timer)) == timer
