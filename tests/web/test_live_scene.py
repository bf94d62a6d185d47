"""Running nodes are drawn where their scenario has them, if `live up` left it beside them."""

import pytest

from innervate import scenario
from innervate.web.live_scene import FILE, UNKNOWN, drawn
from tests.fixtures.scenarios import one_port

MESH = """
kind = "mesh"
name = "yard"
[[node]]
x_m = 0
y_m = 0
[[node]]
name = "mast"
x_m = 30
y_m = 0
[[node]]
x_m = 30
y_m = 20
[fence]
polygon = [[-5, -5], [40, -5], [40, 30]]
"""
SKIN = one_port(3, 2, 'name = "sleeve"')
RADIO = 'kind = "radio"\nname = "team"\nstations = 3'


def beside(tmp_path, text, names):
    if text:
        (tmp_path / FILE).write_text(scenario.dump(scenario.loads(text)))
    return [tmp_path / f"{name}.sock" for name in names]


def test_a_mesh_is_where_its_scenario_has_it_with_its_fence(tmp_path):
    found = drawn(beside(tmp_path, MESH, ("n0", "n1", "n2")), "mesh")
    assert found.name == "yard"
    assert found.metres
    assert found.places == {"n0": (0, 0), "n1": (30, 0), "n2": (30, -20)}  # y down
    assert found.labels == {"n1": "mast"}
    assert found.fence == [[[-5, 5], [40, 5], [40, -30]]]


def test_a_skin_is_its_honeycomb_and_cells_have_the_scenarios_names(tmp_path):
    found = drawn(beside(tmp_path, SKIN, ("c0", "pc")), "skin")
    assert set(found.places) == {*(f"c{i}" for i in range(6)), "pc.0"}
    assert found.labels["c4"] == "p0 r1 c1"
    (ax, ay), (bx, by) = found.places["c0"], found.places["c1"]
    assert (bx - ax, by - ay) == pytest.approx((1, 0))
    assert not found.metres


def test_a_team_has_its_scenarios_name(tmp_path):
    found = drawn(beside(tmp_path, RADIO, ("s0",)), "radio")
    assert (found.name, found.origin_m) == ("team", (0, 0))


def test_without_a_scenario_of_theirs_nodes_are_drawn_by_who_hears_whom(tmp_path):
    assert drawn(beside(tmp_path, "", ("n0",)), "mesh") is UNKNOWN
    assert drawn(beside(tmp_path, SKIN, ("n0",)), "mesh") is UNKNOWN
    elsewhere = [*beside(tmp_path, MESH, ("n0",)), tmp_path / "other" / "n1.sock"]
    assert drawn(elsewhere, "mesh") is UNKNOWN
    (tmp_path / FILE).write_text("kind = ")
    assert drawn([tmp_path / "n0.sock"], "mesh") is UNKNOWN
