"""Seeds of whole networks; what a seed shows it shows again."""

import functools
import time

import pytest

from tests.livesim import runs

SMALL = {"nodes": 6, "storms": 1, "storm_s": 20, "calm_s": 0, "rate": 5}
FULL_CPU_S = 480.0


@functools.cache
def hurt(seed):
    """A mesh's run."""
    return runs.run(seed, "mesh", **SMALL)


@pytest.mark.parametrize("seed", [1, 2])
def test_a_mesh_that_is_hurt_keeps_what_it_promises(seed):
    found = hurt(seed)
    assert found.broken == []
    assert found.told["delivered"] > 20


def test_a_mesh_in_one_group_keeps_it_too():
    found = runs.run(2, "mesh", **SMALL, multicast=True)
    assert found.broken == []
    assert found.told["delivered"] > 20


@pytest.mark.parametrize("serial", [False, True])
def test_a_skin_that_is_hurt_is_heard_and_hears(serial):
    small = {"columns": 2, "rows": 2, "storms": 1, "storm_s": 20, "calm_s": 0, "serial": serial}
    found = runs.run(7, "skin", **small)
    assert found.broken == []
    assert found.told["touches"] > 200
    assert found.told["lives"] > 5


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_team_that_is_hurt_delivers_what_it_says(seed):
    found = runs.run(seed, "radio", nodes=6, storms=1, storm_s=120, calm_s=0)
    assert found.broken == []
    assert found.told["delivered"] > 5
    assert found.told["lives"] > 6


@pytest.mark.parametrize("seed", [1, pytest.param(2, marks=pytest.mark.slow)])
def test_in_order_with_restarting_recipients_delivered_means_handed_up(seed):
    often = {"storm_s": 60, "rate": 20, "in_order": True, "hurts": ("crash", "restarts")}
    found = runs.run(seed, "mesh", **SMALL | often)
    assert found.broken == []
    assert found.told["delivered"] > 500


def test_a_slow_mesh_that_runs_for_days_keeps_what_it_promises():
    found = runs.run(3, "weeks", storms=1, storm_s=1200, calm_s=1800, slow=60, nodes=5, rate=0.1)
    assert found.broken == []
    assert found.seconds > 3600
    assert found.told["delivered"] > 50
    assert found.told["lives"] > 5


def test_a_seed_shows_the_same_again():
    assert hurt(1) == runs.run(1, "mesh", **SMALL)
    assert hurt(1).fingerprint != hurt(2).fingerprint


@pytest.mark.slow
def test_seed_after_seed_for_minutes():
    began, seed, broken = time.process_time(), 1000, []
    while time.process_time() - began < FULL_CPU_S and not broken:
        found = runs.run(seed)
        broken = [f"seed {seed}, {found.what}: {line}" for line in found.broken]
        seed += 1
    assert broken == []
