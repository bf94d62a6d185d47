"""From a plan to the slotted level's arguments, and from what that measured to a summary."""

import numpy as np
import pytest

from innervate import scenario
from innervate.networks.radio.scenario.traffic import mean_interval_us
from innervate.networks.radio.slotted import run
from innervate.networks.radio.slotted.model import SlottedResult

SLOTTED = {"kind": "radio", "stations": 4, "packet_slots": 5, "channel": {"level": "slotted"}}
DELAYS = [float(k) for k in range(1, 102)]


def plan_of(mac="csma-cd-r", **tables):
    tables = {name: {**SLOTTED.get(name, {}), **value} if isinstance(value, dict) else value
              for name, value in tables.items()}  # fmt: skip
    return scenario.plan(scenario.from_dict({**SLOTTED, "protocol": {"mac": mac}, **tables}))


def result_of(**values):
    usual = {"elapsed_slots": 60.0, "airtime_slots": 20.0, "throughput": 1 / 3,
             "duration_slots": 59.4, "successes": [2, 0, 1, 1], "order": [2, 0, 0, 3],
             "collisions": 6, "delay_slots": np.array(DELAYS), "jain": 0.75,
             "jain_round": 0.8}  # fmt: skip
    return SlottedResult(**usual | values)


def ran(monkeypatch, plan, **values):
    """What the slotted level is called with, and the run that comes of what it measured."""
    called = []
    monkeypatch.setattr(run, "slotted", lambda *given, **named: called.append((given, named))
                        or result_of(**values))  # fmt: skip
    found = run.simulate(plan, plain=True)
    ((given, named),) = called
    return given, named, found


SATURATED = {"traffic": {"kind": "saturated", "packets": 7}}


def test_a_saturated_run_has_no_load_and_ends_with_its_packets_or_its_time(monkeypatch):
    plan = plan_of(**SATURATED, duration_s=0.5, channel={"turnaround_us": 2000})
    given, named, _ = ran(monkeypatch, plan)
    assert given == ("csma-cd-r", 4, 5, "saturated")
    assert named == {
        "packets": 7, "seed": plan.seed, "load": None, "plain": True, "reading": "A",
        "until_slots": 500_000 / 208, "turnaround_slots": 2000 / 208,
    }  # fmt: skip


@pytest.mark.parametrize(("duration_s", "least"), [(3.0, 2), (0.001, 1)])
def test_a_station_has_as_many_packets_as_come_in_the_time(monkeypatch, duration_s, least):
    plan = plan_of("p-persistent", traffic={"kind": "poisson", "load": 0.4}, duration_s=duration_s)
    _, named, _ = ran(monkeypatch, plan)
    often = int(duration_s * 1e6) // mean_interval_us(plan.scenario.model, 208)
    assert named["packets"] == max(1, often) >= least
    assert (named["load"], "turnaround_slots" in named, "reading" in named) == (0.4, False, False)


@pytest.mark.parametrize(
    ("kind", "offers", "level"), [("saturated", 3, "ok"), ("disaster", 4, "degraded")]
)
def test_what_was_not_delivered_in_a_disaster_is_overdue(monkeypatch, kind, offers, level):
    plan = plan_of(traffic={"kind": kind})
    _, _, found = ran(monkeypatch, plan, successes=[1, 0, 1, 1], order=[3, 0, 2])
    summary = run.summarize(found)
    assert found.counts == {"offers": offers, "completed": 3, "handled": 3}
    assert summary["headline"]["level"] == level
    assert (summary["delivered"], summary["lost_silently"]) == (3, 0)
    assert found.ended_us == round(59.4 * 208)


def test_a_summary_says_what_was_measured(monkeypatch):
    _, _, found = ran(monkeypatch, plan_of(**SATURATED))
    summary = run.summarize(found)
    assert summary["delay_slots"] == {"p50": 51.0, "p95": 96.0, "p99": 100.0, "max": 101.0}
    names = ("throughput", "duration_slots", "jain", "jain_round", "collisions", "protocol")
    assert [summary[name] for name in names] == [1 / 3, 59.4, 0.75, 0.8, 6, "csma-cd-r"]
    assert summary["order"] == [2, 0, 3]  # each station once
    nothing = run.summarize(ran(monkeypatch, plan_of(**SATURATED), delay_slots=np.zeros(0))[2])
    assert nothing["delay_slots"] == dict.fromkeys(("p50", "p95", "p99", "max"))


def test_the_order_of_a_disaster_is_that_of_its_first_thousand(monkeypatch):
    order = [k % 4 for k in range(1200)]
    _, _, found = ran(monkeypatch, plan_of(traffic={"kind": "disaster"}), order=order)
    assert run.summarize(found)["order"] == order[:1000]


def test_a_run_is_known_by_its_order_and_its_delays(monkeypatch):
    one, same, order, delays = (
        ran(monkeypatch, plan_of(**SATURATED), **values)[2].fingerprint
        for values in ({}, {}, {"order": [0, 2, 0, 3]},
                       {"delay_slots": np.array([*DELAYS[:-1], 101.001])})
    )  # fmt: skip
    assert one == same
    assert len({one, order, delays}) == 3


def test_what_the_slotted_level_refuses_is_a_mistake_of_the_scenario(monkeypatch):
    def refuses(*_, **__):
        raise ValueError("csma-cd-r has no use for that")

    monkeypatch.setattr(run, "slotted", refuses)
    with pytest.raises(scenario.ScenarioError, match="on the slotted level csma-cd-r has no use"):
        run.simulate(plan_of(**SATURATED), plain=True)
