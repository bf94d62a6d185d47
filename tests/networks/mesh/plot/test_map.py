"""Who gets the alarms, by what a scenario says; and what a map shows of a field."""

from types import SimpleNamespace

import pytest

from innervate import scenario
from innervate.networks.mesh.analysis.alarms import Crossing
from innervate.networks.mesh.analysis.messages import NEVER
from innervate.networks.mesh.analysis.way import Hop
from innervate.networks.mesh.plot import map as mesh_map
from innervate.networks.mesh.plot.map import (
    CROSSINGS_MAX,
    Alarmed,
    field_map,
    legend,
    monitor_of,
    pin,
    robot_places,
    roles,
    symbol,
)
from innervate.networks.mesh.plot.sheet import Sheet
from innervate.networks.mesh.protocol.constants import ALL, MONITOR
from innervate.plot import svg
from innervate.scenario.robots import position_cm

NODES = "".join(f"[[node]]\nx_m = {10 * i}\ny_m = 0\n" for i in range(5))


@pytest.mark.parametrize(("said", "monitor"), [
    ("gateway = 2\nstandby = [0, 4]\n", 2), ("gateway = 2\nstandby = [0]\nmonitor = 3\n", 3),
    ("gateway = 4\n", 4), ('gateway = 4\nmonitor = "gateway"\n', 4),
])  # fmt: skip
def test_alarms_come_to_the_monitor_or_else_to_the_first_gateway(said, monitor):
    text = f"kind = 'mesh'\n{said}radio.reach_m = 30\n{NODES}"
    assert monitor_of(scenario.plan(scenario.loads(text))) == monitor


FIELD = {
    "kind": "mesh", "duration_s": 30.0, "radio": {"reach_m": 40}, "gateway": 0,
    "standby": [1, 2], "monitor": "n3",
    "node": [{"name": f"n{i}", "x_m": 25.0 * i, "y_m": 0.0} for i in range(6)],
    "robot": [{"node": 5, "waypoints": [[125, 0], [125, 100]], "speed_mps": 2.0}],
    "fence": {"polygon": [[-5, -20], [140, -20], [140, 20], [-5, 20]],
              "holes": [[[10, 5], [20, 5], [20, 15]]]},
    "event": [{"at_s": 9.0, "action": "kill", "node": 2}],
}  # fmt: skip


def plan_of(**changes):
    return scenario.plan(scenario.from_dict({**FIELD, **changes}))


def result_of(**changes):
    return SimpleNamespace(plan=plan_of(**changes), ended_us=30_000_000)


def crossing(crossed_us=15_000_000):
    return Crossing(robot=5, crossed_us=crossed_us, back_us=NEVER, raised_us=crossed_us + 9,
                    raised_by=5, accepted_us=crossed_us + 900_000, row=0, hops=2, flooded=False,
                    warned_us=NEVER, overrun_m=0.1, open=False)  # fmt: skip


def hop(node, to, flooded=False, at_us=10_000_000):
    return Hop(at_us, at_us + 1000, node, to, flooded, 1, 1)


def shapes(parse, drawing):
    found = {}
    for node in parse(drawing).iter():
        found.setdefault(node.get("class"), []).append(node)
    return found


def test_what_nodes_are_besides_relays():
    assert roles(plan_of()) == {0: "gateway", 1: "standby", 2: "standby", 3: "monitor", 4: "",
                                5: "robot"}  # fmt: skip
    assert roles(plan_of(monitor=0))[0] == "gateway and monitor"
    bare = plan_of(robot=[], fence=None, monitor="n3")
    assert roles(bare)[3] == ""  # nobody raises an alarm


def test_the_ground_of_a_map(parse):
    result = result_of()
    found = shapes(parse, field_map(result, Sheet(result.plan), "map"))
    # n2 is dead at the end: its two links are gone; a robot's are not drawn.
    assert (len(found["mesh"]), len(found["mesh gone"])) == (2, 2)
    assert (len(found["fence"]), len(found["zone"]), len(found["walk"])) == (2, 1, 1)
    assert (len(found["leader"]), len(found["off"]), len(found["struck"])) == (2, 1, 1)
    assert (len(found["relay"]), len(found["robot"]), len(found["ringed"])) == (2, 1, 1)
    assert found["zone"][0].get("d").count("z") == 2
    early = field_map(result, Sheet(result.plan), "map", (), Alarmed(at_us=8_999_999))
    assert "struck" not in shapes(parse, early)


def test_the_way_of_an_alarm_and_who_flooded_it(parse):
    result = result_of()
    way = [hop(5, ALL, True), hop(4, 3), hop(3, MONITOR)]
    sent = [*way, hop(1, ALL, True), hop(0, 1)]
    sheet = Sheet(result.plan)
    drawing = field_map(result, sheet, "map", (), Alarmed(sent, way, 10_000_000))
    found = shapes(parse, drawing)
    assert len(found["flooder"]) == 2
    places = robot_places(result.plan, sheet, way[0].start_us)
    assert places[5] != sheet.node(5)  # it has walked
    gap = sheet.dot + 3
    ends = [(5, 4), (4, 3), (3, 3)]  # who heard a flood is who sent next, or the monitor
    assert [one.get("d") for one in found["way"]] == [
        svg.arrow(places[a], places[b], gap) for a, b in ends
    ]  # fmt: skip


def test_crossings_are_numbered_up_to_a_most(parse, texts):
    result, sheet = result_of(), Sheet(plan_of())
    some = [crossing(10_100_000 + k * 100_000) for k in range(CROSSINGS_MAX + 3)]
    found = shapes(parse, field_map(result, sheet, "map", some[:2]))
    at = [position_cm(result.plan.walks[0], one.crossed_us) for one in some[:2]]
    assert [one.get("d") for one in found["warn"]] == [pin(sheet.of_cm(place)) for place in at]
    assert len(shapes(parse, field_map(result, sheet, "map", some))["warn"]) == CROSSINGS_MAX
    assert "1" in texts(field_map(result, sheet, "map", some[:1]))


def written(parse, drawing):
    """Per text of a drawing its box, as letters of 6.6 px and 11 px high."""
    found = {}
    for one in parse(drawing).iter():
        if one.tag.endswith("text"):
            long, x, y = 6.6 * len(one.text), float(one.get("x")), float(one.get("y"))
            left = x - {"middle": 0.5, "end": 1}.get(one.get("text-anchor"), 0) * long
            found[one.text] = (left, y - 9, left + long, y + 2)
    return found


def test_the_names_of_two_nodes_lie_beside_their_only_link(parse):
    plan = plan_of(node=FIELD["node"][:2], standby=[], robot=[], monitor=0, event=[],
                   fence=None)  # fmt: skip
    drawing = field_map(SimpleNamespace(plan=plan, ended_us=9_000_000), Sheet(plan), "map")
    (link,) = shapes(parse, drawing)["mesh"]
    (begin, end), level = sorted(float(link.get(x)) for x in ("x1", "x2")), float(link.get("y1"))
    boxes = written(parse, drawing)
    for left, top, right, low in (boxes["n0 gateway"], boxes["n1"]):
        assert right < begin or left > end or low < level or top > level


@pytest.mark.parametrize("beside_m", [3, 6, 7.8, 8.1, 8.4])
def test_no_name_lies_on_the_pin_of_a_crossing(parse, beside_m):
    places = [*FIELD["node"][:5], {"name": "n5", "x_m": 125.0, "y_m": 0.0}]
    places[4] = {"name": "near", "x_m": 125.0 - beside_m, "y_m": 22.5}
    result = result_of(node=places)
    drawing = field_map(result, Sheet(result.plan), "map", [crossing(10_000_000)])
    x, y = map(float, shapes(parse, drawing)["warn"][0].get("d")[1:].split("l")[0].split(","))
    for left, top, right, low in filter(None, [written(parse, drawing).get("near")]):
        assert right < x - 5 or left > x + 5 or low < y - 13 or top > y


def test_where_nobody_knows_places_no_crossing_has_one(parse):
    result, sheet = result_of(), Sheet(plan_of())
    sheet.metres = False
    found = shapes(parse, field_map(result, sheet, "map", [crossing()]))
    assert not {"warn", "walk", "fence"} & set(found)


@pytest.mark.parametrize(("role", "size", "ringed"), [
    ("gateway", 6.5, 0), ("standby", 8, 0), ("gateway and monitor", 6.5, 1), ("robot", 7.5, 0),
])  # fmt: skip
def test_shapes_of_nodes(parse, role, size, ringed):
    drawing = svg.Drawing(100, 100, "one")
    symbol(drawing, (50, 50), 5.0, role, on=True)
    found = shapes(parse, drawing)
    corners = {"standby": [(0, -size), (size, 0), (0, size), (-size, 0)],
               "robot": [(0, -size), (size, size), (-size, size)]}.get(
        role, [(-size, -size), (size, -size), (size, size), (-size, size)])  # fmt: skip
    (shape,) = found["robot" if role == "robot" else "leader"]
    assert shape.get("d") == svg.polygon(50, 50, corners)
    assert len(found.get("ringed", [])) == ringed


@pytest.mark.parametrize(("most", "named"), [(6, True), (5, False)])
def test_of_many_nodes_those_with_a_part_are_named(texts, monkeypatch, most, named):
    monkeypatch.setattr(mesh_map, "NAMED_MAX", most)
    result = result_of()
    said = texts(field_map(result, Sheet(result.plan), "map"))
    assert {"n0 gateway", "n2 standby", "n3 monitor", "n5 robot"} <= set(said)
    assert ("n4" in said) == named


def words(*given):
    return [what for _, what in legend(*given)]


def test_a_legend_has_what_the_map_shows():
    usual = ["gateway", "standby", "monitor", "robot", "good link between nodes that stay"]
    assert words(result_of(), [], []) == [*usual, "switched off", "fence", "way of a robot"]
    calm = result_of(event=[])
    assert words(calm, [crossing()], []) == [*usual, "fence", "way of a robot", "crossing"]
    assert words(calm, [], [hop(5, 4)])[-1] == "how the alarm came"
    assert words(calm, [], [hop(5, ALL, True)])[-1] == "flooded it"
    bare = result_of(robot=[], fence=None, standby=[], event=[])
    assert words(bare, [], []) == ["gateway", "good link between nodes that stay"]


def test_a_legend_is_of_the_moment_that_the_map_shows():
    late = [*FIELD["event"], {"at_s": 20.0, "action": "revive", "node": 2}]
    later = [*late, {"at_s": 12.0, "action": "revive", "node": 4}]
    said = {
        (len(event), at_s): {"switched off", "yet to come", "switched off, or yet to come"}
        & set(words(result_of(event=event), [], [], None if at_s is None else at_s * 1_000_000))
        for event in (late, later)
        for at_s in (5, 10, 15, 25, None)
    }
    off, yet, both = {"switched off"}, {"yet to come"}, {"switched off, or yet to come"}
    assert said == {
        (2, 5): set(), (2, 10): off, (2, 15): off, (2, 25): set(), (2, None): set(),
        (3, 5): yet, (3, 10): both, (3, 15): off, (3, 25): set(), (3, None): set(),
    }  # fmt: skip


def test_room_for_names_is_where_no_node_and_no_ring_is(monkeypatch):
    """Those with a part are named first, and whoever has one or a ring at some distance."""
    monkeypatch.setattr(mesh_map, "roles", lambda plan: {0: "", 1: "gateway", 2: ""})
    blocked, put, drawn = [], [], []
    names = SimpleNamespace(
        block=lambda *given: blocked.append(given),
        put=lambda at, words, gap, strong: put.append((at, words, gap, strong)) or (at, "end"),
    )
    drawing = SimpleNamespace(text=lambda *given: drawn.append(given))
    monkeypatch.setattr(mesh_map, "symbol", lambda *given: None)
    plan = SimpleNamespace(nodes=3, names=["a", "b", "c"])
    places = {0: (1, 1), 1: (2, 2), 2: (3, 3)}
    field = mesh_map.Field(drawing, plan, SimpleNamespace(dot=5.0), names, [True] * 3)
    mesh_map.nodes(field, places, ringed=[2])
    assert blocked == [((1, 1), 7.0), ((2, 2), 7.0), ((3, 3), 10.0)]
    assert put == [((2, 2), "b gateway", 14.0, True), ((1, 1), "a", 9.0, False),
                   ((3, 3), "c", 14.0, False)]  # fmt: skip
    assert drawn == [((2, 2), "b gateway", "small strong", "end"), ((1, 1), "a", "small", "end"),
                     ((3, 3), "c", "small", "end")]  # fmt: skip
