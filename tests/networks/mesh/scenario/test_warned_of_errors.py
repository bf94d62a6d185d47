"""What `check` says of robots that err by more than the fence leaves them."""

import pytest

from innervate import scenario
from innervate.networks.mesh.scenario.words import _fastest_mps, warnings
from innervate.scenario.robots import Walk


def said(*robots, fence=None, **more):
    """The warnings about errors; robots walk 5 m at 2 m/s unless they say otherwise."""
    way = {"waypoints": [[10, 10], [10, 15]], "speed_mps": 2.0}
    tables = {
        "kind": "mesh", "nodes": 6,
        "robot": [{"node": 3 + i, **way, **robot} for i, robot in enumerate(robots)],
        "fence": {"polygon": [[0, 0], [20, 0], [20, 20], [0, 20]]} | (fence or {}), **more,
    }  # fmt: skip
    found = warnings(scenario.plan(scenario.from_dict(tables)))
    return [line for line in found if line.startswith("positions of")]


CLEAR = ("positions of n3 err by 0.25 m, and fence.clear_m is 0.2: near the fence the error alone "
         "raises alarms and takes them back; make it 1.5")  # fmt: skip


def test_an_error_beyond_the_margin_that_takes_an_alarm_back():
    assert said({}) == said({"position_noise_m": 0.2}) == []
    assert said({"position_noise_m": 0.25}) == [CLEAR]
    assert said({"position_noise_m": 0.25}, fence={"clear_m": 1.5}) == []


def test_an_error_beyond_the_way_on_which_the_fence_warns():
    wide = {"clear_m": 50}
    assert said({"position_noise_m": 1.0}, fence=wide) == []
    assert said({"position_noise_m": 1.1}, fence=wide) == [
        "positions of n3 err by 1.1 m, and the fence warns 1 m before it is reached (speed times "
        "fence.predict_s): warnings come no sooner than alarms"
    ]
    assert said({"position_noise_m": 1.1}, fence=wide | {"predict_s": 0.6}) == []
    (standing,) = said({"position_noise_m": 0.01, "waypoints": [[5, 5]]}, fence=wide)
    assert "warns 0 m before" in standing


def test_robots_that_err_alike_are_named_together():
    one, other = {"position_noise_m": 0.25}, {"position_noise_m": 0.5}
    found = said(one, one, other, fence={"predict_s": 5})
    third = CLEAR.replace("n3", "n5").replace("0.25", "0.5").replace("1.5", "3")
    assert found == [CLEAR.replace("n3", "n3, n4"), third]


def test_without_a_fence_nobody_minds():
    tables = {"kind": "mesh", "nodes": 6, "robot": [{"node": 3, "position_noise_m": 9}]}
    assert not any("err by" in line for line in warnings(scenario.plan(scenario.from_dict(tables))))


@pytest.mark.parametrize(("points", "fastest"), [
    (((0, 0, 0),), 0), (((0, 0, 0), (1_000_000, 300, 400)), 5),
    (((0, 0, 0), (1_000_000, 100, 0), (2_000_000, 100, 250), (2_000_000, 100, 250)), 2.5),
])  # fmt: skip
def test_how_fast_a_robot_is_at_most(points, fastest):
    assert _fastest_mps(Walk(0, points)) == pytest.approx(fastest)
