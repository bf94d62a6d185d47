"""Robots, alarms and names of running nodes on the page, by what the nodes say."""

from types import SimpleNamespace

import pytest

from innervate import scenario
from innervate.networks.mesh.view.live import MeshLiveView, MeshMap, MeshState
from innervate.web.live import Live
from innervate.web.live_poll import Poller
from innervate.web.live_scene import FILE

YARD = """
kind = "mesh"
name = "yard"
radio = { reach_m = 60 }
[[node]]
name = "mast"
x_m = 0
y_m = 0
[[node]]
name = "rover"
x_m = 20
y_m = 20
[[robot]]
node = "rover"
waypoints = [[20, 20], [50, 20]]
speed_mps = 1.0
[fence]
polygon = [[10, 5], [40, 5], [40, 35], [10, 35]]
"""


def node(number, **more):
    return {"kind": "mesh", "role": "node", "number": number, "gateway": 0, "paths": [],
            "onward": [0] if number else [], "counters": {}, "neighbours": [], **more}  # fmt: skip


def alarm(kind, number, ago_s, robot=1):
    return {"kind": kind, "robot": robot, "reporter": robot, "number": number, "ago_s": ago_s}


def robot(at_cm, fence):
    return node(1, robot={"at_cm": at_cm, "fence": fence})


@pytest.mark.parametrize(
    ("fence", "alarms", "outside", "raised"),
    [
        ("inside", [], 0, 0),
        ("about to cross", [alarm("predict", 1, 0.1)], 0, 1),
        ("outside", [alarm("predict", 1, 3.0), alarm("cross", 2, 2.0)], 1, 1),
        ("inside", [alarm("clear", 3, 1.0), alarm("cross", 2, 2.0)], 0, 0),
        ("outside", [alarm("clear", 3, 9.0), alarm("cross", 4, 2.0)], 1, 1),
        ("outside", [], 1, 0),  # nobody learned of it
    ],
)
def test_a_robot_that_is_out_and_its_newest_alarm_are_shown(fence, alarms, outside, raised):
    told = {0: node(0, role="gateway", alarms=alarms), 1: robot([0, 0], fence)}
    shown = MeshState(MeshMap(told), told).fields()
    assert (shown["outside"], shown["alarm"]) == ([0, outside], [0, raised])


def test_the_alarm_of_a_robot_that_is_silent_stays():
    told = {0: node(0, role="gateway", alarms=[alarm("lost", 7, 1.0)]), 1: robot(None, "inside")}
    where = MeshMap(told)
    del told[1]
    assert MeshState(where, told).fields()["alarm"] == [0, 1]


def test_every_alarm_is_told_once_and_old_ones_with_their_age():
    view, names = MeshLiveView(), ["n0", "n1"].__getitem__
    told = {0: node(0, alarms=[alarm("cross", 2, 2.0), alarm("predict", 1, 61.0)]), 1: node(1)}
    assert view.news(told, names) == [
        ("alarm at n0: robot n1 is about to cross the fence, 61 s ago", "bad"),
        ("alarm at n0: robot n1 has crossed the fence", "bad"),
    ]
    assert view.news(told, names) == []
    told[0]["alarms"] += [alarm("clear", 3, 0.2), alarm("lost", 4, 0.1, robot=9)]
    assert view.news(told, names) == [
        ("alarm at n0: robot n1 is inside again", "good"),
        ("alarm at n0: robot n9 is lost", "bad"),
    ]


def test_a_robot_is_drawn_where_it_says_it_is_and_nodes_bear_the_scenarios_names(
    tmp_path, monkeypatch
):
    """The fence's origin is its corner at (10, 5) m; the robot is 32 m east, 20 m north of it."""
    (tmp_path / FILE).write_text(scenario.dump(scenario.loads(YARD)))
    told = {0: node(0, role="gateway"), 1: robot([3200, 2000], "outside")}
    assert scenario.plan(scenario.loads(YARD)).origin_cm == (1000, 500)
    monkeypatch.setattr(Poller, "ask_all", lambda self, request: dict(told))
    source = Live([tmp_path / "n0.sock", tmp_path / "n1.sock"])
    scene = source.scene()
    assert [(one["also"], one["role"]) for one in scene["nodes"]] == [
        ("mast", "gateway"), ("rover", "robot"),
    ]  # fmt: skip
    assert [(one["x"], one["y"]) for one in scene["nodes"]] == [(0, 0), (20, -20)]
    assert source.fields()["position"] == [[0, 0], [42, -25]]
    told[1] = robot(None, "inside")  # started anew, it has not been told yet where it is
    source._poll()
    assert "position" not in source.fields()


def test_robots_are_where_they_say_from_the_corner_of_the_fence_with_y_down():
    known = SimpleNamespace(origin_m=(10.0, 40.0))
    told = {0: node(0), 1: robot([250, 104], "inside"), 2: robot(None, "inside")}
    assert MeshLiveView().moved(told, known) == {1: (12.5, 38.96)}
