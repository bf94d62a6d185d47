"""What running nodes of a mesh say to people, what stands in their files, alarms as they come."""

from types import SimpleNamespace

import pytest

from innervate import scenario as scenarios
from innervate.live.machine import Machine, on
from innervate.networks.mesh.live import alarms, words
from innervate.networks.mesh.live.alarms import Alarm, Alarms, read_alarm
from innervate.networks.mesh.live.deployment import MeshDeployment
from innervate.networks.mesh.live.parameters import fence_parameters
from innervate.networks.mesh.rings import of_table
from innervate.wire.layout import width

TOLD = {"gateway": None, "epoch": 3, "table": 7, "neighbours": [], "routes": {}}


def test_a_node_that_knows_nobody():
    assert words.lines(TOLD) == ["  gateway none yet, epoch 3, table 7", "  routes: none"]


def test_neighbours_routes_what_waits_a_robot_and_alarms():
    alarm = {"kind": "cross", "robot": 3, "x_cm": 150, "y_cm": -25, "margin_cm": -7, "reporter": 5}
    told = {
        **TOLD, "gateway": 0, "routes": {"2": [1, 4], "0": [0, 255]}, "waiting": {"2": 3, "255": 1},
        "neighbours": [
            {"node": 1, "quality": None, "suspect": False, "ports": [0, 2]},
            {"node": 4, "quality": 0.9876, "suspect": True, "ports": []},
        ],
        "robot": {"at_cm": [1234, -50], "fence": "inside"},
        "alarms": [{**alarm, "ago_s": 2.04}, {**alarm, "kind": "lost", "ago_s": 0.0}],
    }  # fmt: skip
    assert words.lines(told) == [
        "  gateway 0, epoch 3, table 7",
        "  neighbour 1 by port 0, 2: acknowledged -",
        "  neighbour 4 by port : acknowledged 98.8 %, does not answer",
        "  routes: 2 by 1, 0 by 0",
        "  messages that wait: 3 for 2, 1 for 255",
        "  robot: at 12.34, -0.50 m, inside",
        "  alarm 2.0 s ago: cross, robot 3 at 1.50, -0.25 m, margin -0.07 m (from node 5)",
        "  alarm 0.0 s ago: lost, robot 3 (from node 5)",
    ]
    told["robot"]["at_cm"] = None
    assert "  robot: no position yet, inside" in words.lines(told)
    assert words.heard({"alarm": alarm}).startswith("alarm: cross, robot 3 at 1.50")
    assert words.heard({"payload": "c3a4ff"}) == "\u00e4\\xff"


class Clock(Machine):
    now_s = 1000.0
    set_by_s = 0.0

    def monotonic_ns(self):
        return round(1e9 * self.now_s)

    def time_ns(self):
        return round(1e9 * (self.now_s + self.set_by_s))


def test_of_alarms_the_newest_are_shown_with_their_age_whoever_sets_the_clock():
    with on(Clock()) as _:
        machine = alarms.machine()
        kept, told = Alarms(), []
        kept.arrivals.receive(told.append)
        for number in range(alarms.SHOWN + 2):
            kept.note(Alarm("cross", 3, 5, 1, number, 0, 0, 0))
            machine.now_s += 0.25
        machine.set_by_s = -3600.0
        kept.arrivals.hand_up()
        assert len(told) == alarms.SHOWN + 2
        found = kept.status()
        assert [one["number"] for one in found] == list(range(2, alarms.SHOWN + 2))
        assert [one["ago_s"] for one in found[-2:]] == [0.5, 0.25]
        assert found[0]["kind"] == "cross"


def test_an_alarm_of_a_kind_that_nobody_knows_is_none():
    size = (width(alarms.FIELDS[alarms.ALARM]) + 7) // 8
    bodies = [bytes([3, 1, 9, kind]) + bytes(size - 4) for kind in range(256)]
    found = [read_alarm(5, body, 2) for body in bodies]
    assert [one.kind for one in found[: len(alarms.KINDS)]] == list(alarms.KINDS)
    assert set(found[len(alarms.KINDS) :]) == {None}
    assert (found[0].robot, found[0].fence, found[0].number, found[0].reporter) == (3, 1, 9, 5)


RING = {
    "kind": "mesh", "nodes": 4, "radio": {"profile": "ip"}, "standby": [2, 3],
    "link": [{"a": i, "b": (i + 1) % 4} for i in range(4)],
    "fence": {"polygon": [[0, 0], [20, 0], [20, 20], [0, 20]],
              "holes": [[[5, 5], [6, 5], [6, 6]]]},
}  # fmt: skip


def test_a_nodes_file_has_its_role_its_rank_and_the_fence():
    made = MeshDeployment(scenarios.plan(scenarios.from_dict(RING)))
    heads = [made.file(number, [0])[0] for number in range(4)]
    assert heads == [
        {"nodes": 4, "role": "gateway"}, {"nodes": 4, "role": "node"},
        {"nodes": 4, "role": "standby", "rank": 1}, {"nodes": 4, "role": "standby", "rank": 2},
    ]  # fmt: skip
    _, tables = made.file(1, [0])
    assert not tables["protocol"].keys() & {"nodes", "points", "px", "queue", "kept"}
    fence = tables["fence"]
    assert (len(fence["polygon"]), [len(hole) for hole in fence["holes"]]) == (4, [3])
    params = {**made.plan.params, **fence_parameters([fence["polygon"], *fence["holes"]])}
    for name in ("points", "px", "py", "after"):
        assert params[name] == made.plan.params[name]
    assert of_table({"points": 0}) == []


def test_robots_of_a_plan_are_walked_by_the_nodes_that_bear_them():
    made = MeshDeployment(scenarios.plan(scenarios.from_dict(RING)))
    made.plan = SimpleNamespace(walks=[SimpleNamespace(node=2, points=((0, 0, 0),))])
    asked = []
    stage = SimpleNamespace(socket=lambda name: asked.append(name))
    for other in made.others(stage):
        other.close()
    assert asked == ["n2"]


@pytest.mark.parametrize(("value", "most", "bound"), [(7.4, 7, 7), (-7.6, 7, -7), (-6.6, 7, -7)])
def test_values_beyond_their_range_are_the_last_of_it(value, most, bound):
    assert alarms._bound(value, most) == bound
