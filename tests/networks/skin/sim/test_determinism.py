"""Same seed, same run: whatever is recorded and however it is cut into slices.

`fingerprints.csv` holds what bundled scenarios gave; a change of protocol or simulator that is
meant to alter runs rewrites it: INNERVATE_REWRITE=1 python -m pytest tests/networks/skin/sim
"""

import csv
import os
from pathlib import Path

import pytest

from innervate import scenario
from innervate.networks.skin.sim.simulate import simulate
from innervate.sim.driver import Simulation
from tests.networks.skin.runs import busy, plan_of, run, setup_1

TABLE = Path(__file__).with_name("fingerprints.csv")
REWRITE = os.environ.get("INNERVATE_REWRITE", "") not in ("", "0")
BUNDLED = ("line", "loose", "setup-1", "setup-4", "joined", "demo")


def test_the_same_seed_gives_the_same_run():
    for seed in range(4):
        one, two = run(setup_1(seed=seed)), run(setup_1(seed=seed))
        assert one.fingerprint == two.fingerprint
        assert (one.rows == two.rows).all()
        assert one.counters == two.counters


def test_another_seed_gives_another_run():
    assert len({run(setup_1(seed=seed, duration_s=0.1)).fingerprint for seed in range(50)}) == 50


def test_what_is_recorded_or_checked_changes_nothing():
    keys = busy(3)
    marks = {
        run(keys, checks=checks, deliveries=deliveries, trail=trail).fingerprint
        for checks in (False, True)
        for deliveries in (False, True)
        for trail in (False, True)
    }
    assert len(marks) == 1


def test_slices_change_nothing(monkeypatch):
    keys = busy(5)
    whole = run(keys, trail=True)
    monkeypatch.setattr(Simulation, "slice_events", 1000)
    seen = []
    sliced = simulate(plan_of(keys), trail=True, progress=lambda now, end: seen.append(now))
    assert len(seen) > 5
    assert seen == sorted(seen)
    assert sliced.fingerprint == whole.fingerprint
    assert (sliced.rows == whole.rows).all()
    assert (sliced.trail == whole.trail).all()


def test_the_trail_ends_in_the_fingerprint():
    result = run(busy(1), trail=True)
    assert f"{int(result.trail['fingerprint'][-1]) & (1 << 64) - 1:016x}" == result.fingerprint
    assert len(result.trail) == result.handled
    assert (result.trail["time"][1:] >= result.trail["time"][:-1]).all()


def test_a_parameter_changes_the_run():
    marks = {
        run(setup_1(duration_s=0.3, protocol=protocol)).fingerprint
        for protocol in ({}, {"k": 3}, {"rule": "strict"}, {"updates": "periodic"}, {"m": 1})
    }
    assert len(marks) == 5


def measured():
    """The fingerprints of bundled scenarios, from now."""
    found = {}
    for name in BUNDLED:
        result = simulate(scenario.plan(scenario.load(scenario.bundled()[name])))
        found[name] = result.fingerprint
    return found


def test_bundled_scenarios_run_as_recorded():
    found = measured()
    if REWRITE:
        rows = [("scenario", "fingerprint"), *found.items()]
        TABLE.write_text("".join(f"{a},{b}\n" for a, b in rows))
    with TABLE.open(newline="") as file:
        recorded = {row["scenario"]: row["fingerprint"] for row in csv.DictReader(file)}
    assert found == recorded, "runs changed; if that is meant: INNERVATE_REWRITE=1"


@pytest.mark.slow
@pytest.mark.parametrize("name", ["line", "setup-4"])
def test_bundled_scenarios_run_the_same_plain(name):
    chosen = scenario.plan(scenario.load(scenario.bundled()[name]))
    assert simulate(chosen, plain=True).fingerprint == simulate(chosen).fingerprint
