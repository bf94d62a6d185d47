"""Runs that leave what the proofs assume say so, and those that keep it say nothing."""

from dataclasses import replace

import pytest

from innervate.cli.errors import explain
from innervate.networks.skin.analysis.summary import summarize
from innervate.networks.skin.sim import observer, proved, simulate, stack
from innervate.sim.cables import calls
from innervate.sim.cables.world import OFF
from innervate.sim.status import COLD
from tests.networks.skin.runs import free, line, plan_of

TWO = [("pc.0", "n1"), ("n1", "n2")]
RULES = ("feasible", "strict")


def fast(rule="feasible", latency=80, **protocol):
    """Beacons every millisecond; latency beyond that is what skins are not made for."""
    timing = {"hop_latency_us": [latency, latency], "drift_ppm": 0, **protocol.pop("timing", {})}
    keys = {"rule": rule, "beacon_hz": 1000, "k": 1, "balancing": False, **protocol}
    return {"protocol": keys, "timing": timing}


def at(time, action, **where):
    return {"at_s": time, "action": action, **where}


def restarted(rule, latency):
    events = [at(0.3, "restart", node="n1")]
    return free(TWO, duration_s=0.4, event=events, **fast(rule, latency))


def forgotten(rule, latency):
    """n1 loses its route, forgets, and hears of another while n2 still has the first."""
    events = [at(0, "cut", interface=1), at(0.27, "restore", interface=1),
              at(0.3, "cut", interface=0)]  # fmt: skip
    keys = free([*TWO, ("pc.1", "n1")], duration_s=0.5, event=events, **fast(rule, latency))
    return {**keys, "hold": 4}  # no scenario can say so few: FD_HOLD is 129 periods or more


def counted(rule, count):
    """The PC is restarted after so many numbers, hears none, and begins anew."""
    cable = {"interface": 0}
    begun = count / 1000
    events = [at(begun, "loose", **cable, loss=1.0), at(begun + 0.001, "restart", pc=True),
              at(begun + 0.006, "loose", **cable, loss=0.0)]  # fmt: skip
    return free(TWO, duration_s=begun + 0.05, event=events, **fast(rule, m=1))


def overtaken(rule, latency):
    timing = {"latency": "per_frame", "hop_latency_us": [80, latency]}
    return free(TWO, duration_s=0.2, **fast(rule, m=1, timing=timing))


def said(keys, **how):
    hold = keys.pop("hold", 0)
    plan = plan_of(keys)
    if hold:
        plan = replace(plan, params=plan.params | {"hold_periods": hold})
    summary = summarize(simulate.simulate(plan, **how))
    return [text for text in summary["warnings"] if "outside" in text]


@pytest.mark.parametrize("rule", RULES)
@pytest.mark.parametrize(
    ("of", "slow", "quick", "words"),
    [
        (restarted, 10_000, 80, "n1, which was restarted, takes a route although n2 has an old"),
        (forgotten, 50_000, 80, "n1, which forgot its feasible distance, takes a route although"),
        (counted, 34_000, 2_000, "numbers in use do not lie within half of all"),
    ],
)
def test_a_run_that_leaves_what_is_assumed_says_so(rule, of, slow, quick, words):
    outside = said(of(rule, slow))
    assert [text for text in outside if words in text], outside
    assert outside[0].startswith("outside what is proved from ")
    inside = said(of(rule, quick))
    assert all("the PC is restarted" in text for text in inside)


def test_strict_has_two_more_conditions_and_other_rules_none():
    assert "under rule strict the PC is restarted" in said(counted("strict", 2_000))[0]
    (outside,) = said(overtaken("strict", 9_000))
    assert outside.endswith("a beacon from pc comes to n1 behind a newer one (Order)")
    assert said(overtaken("strict", 500)) == []
    assert said(overtaken("feasible", 9_000)) == []
    assert said(restarted("paper", 10_000)) == []


def test_who_is_switched_on_for_the_first_time_twice_is_noticed():
    plan = plan_of(line(2, duration_s=0.1))
    running = simulate.simulation(plan, plain=True)
    running.finish(None, None)
    world = running.world
    world.alive[1] = OFF
    calls.switch_on(world, stack, 1, 100_000, COLD)
    assert world.run[0].outside == 1 << 3
    calls.switch_on(world, stack, 1, 100_000, COLD)
    assert world.rows[world.run[0].rows - 1].code == 106


@pytest.mark.parametrize(
    ("of", "rule", "latency"), [(restarted, "feasible", 10_000), (overtaken, "strict", 9_000)]
)
def test_plain_and_compiled_runs_say_the_same(of, rule, latency):
    assert said(of(rule, latency), plain=True) == said(of(rule, latency))


def test_without_checks_nothing_is_said():
    assert said(restarted("feasible", 10_000), checks=False) == []


@pytest.mark.parametrize("left", [0, 1 << proved.RESTART, 1 << proved.PC_STAYS])
def test_that_strict_stands_no_restart_of_the_pc_is_known_and_said(left):
    running = simulate.simulation(plan_of(free(TWO, **fast("strict"))), plain=True)
    running.world.run[0].broken = observer.BROKEN_LOOP
    running.world.run[0].outside = left
    error, is_known = running.broken(), left == 1 << proved.PC_STAYS
    assert str(error).endswith("; rule strict does not stand that the PC is restarted") == is_known
    assert explain(error)[0].endswith("; please report it with the scenario") != is_known
