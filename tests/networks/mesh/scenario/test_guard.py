"""How long a standby waits for a sign of its gateway, by what a file says."""

import pytest

from innervate.networks.mesh.scenario.profiles import PROFILES
from innervate.scenario import loads, plan


@pytest.mark.parametrize(
    ("line", "guard_us"),
    [
        ("", 200_000),
        ("radio.profile = '38k4'", 2_000_000),
        ("radio.profile = 'ip'", 0),
        ("protocol.dead_s = 25", 0),
        ("protocol.guard_s = 0.5\nprotocol.dead_s = 25", 500_000),
        ("protocol.guard_s = 0", 0),
    ],
)
def test_who_says_how_long_a_standby_waits_for_requests_has_it_wait_for_them(line, guard_us):
    made = plan(loads(f"kind = 'mesh'\nnodes = 3\nstandby = [1]\n{line}"))
    assert made.params["guard_us"] == guard_us


def test_where_stations_take_turns_it_waits_for_two_rounds():
    text = "kind = 'mesh'\nnodes = 30\nstandby = [1]\nradio.mac = 'dcf'\nradio.reach_m = 500"
    made = plan(loads(text))
    assert PROFILES["250k"].guard * 1e6 < made.params["guard_us"] < 2_000_000


@pytest.mark.parametrize(
    ("line", "ticks"),
    [
        ("", 8),
        ("standby = [1]", 25),
        ("protocol.dead_s = 25", 25),
        ("protocol.period_s = 2", 5),
        ("radio.profile = 'ip'", 6),
    ],
)
def test_a_gateway_that_comes_back_waits_no_longer_than_an_old_round_where_nobody_stands_by(
    line, ticks
):
    made = plan(loads(f"kind = 'mesh'\nnodes = 3\n{line}"))
    assert made.params["dead"] == ticks
