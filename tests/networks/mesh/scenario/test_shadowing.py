"""How much the powers of a mesh differ by shadowing, and by direction."""

import math

import pytest

from innervate.networks.mesh.scenario.profiles import PROFILES
from innervate.scenario import loads, plan


def test_shadowing_and_directions_are_as_wide_as_asked_for():
    text = "nodes = 254\n[placement]\nlayout = 'grid'\nspacing_m = 0.1\n[radio]\ntx_dbm = 0\n"
    text += "shadowing_db = 3\ndirection_db = 1"
    p = plan(loads(f'kind = "mesh"\n{text}'))
    n, places = p.nodes, p.positions_cm
    at = [(p.radio.rssi_cdb[a * n + b], p.radio.rssi_cdb[b * n + a])
          for a in range(n) for b in range(a + 1, n)
          if math.dist(places[a], places[b]) < 100]  # there is no path loss  # fmt: skip
    assert len(at) > 20_000  # a variance is known within 4 % then
    differences = [(there - back) / 100 for there, back in at]
    assert sum(d * d for d in differences) / len(at) == pytest.approx(1**2 + 1**2, rel=0.04)
    levels = [(there + back) / 200 + 40 for there, back in at]
    assert sum(x * x for x in levels) / len(at) == pytest.approx(3**2 + 1 / 2, rel=0.04)
    assert sum(levels) / len(at) == pytest.approx(0, abs=0.1)


@pytest.mark.parametrize(("profile", "megahertz"), [("250k", 2440), ("38k4", 868)])
def test_the_first_metre_takes_whole_decibels_of_a_free_wave(profile: str, megahertz: int) -> None:
    loss_db = 20 * math.log10(4 * math.pi * megahertz * 1e6 / 299_792_458)
    assert PROFILES[profile].loss_1m_cdb == 100 * round(loss_db)
