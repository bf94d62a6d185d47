"""Cells on surfaces: even, on the surface, where the URDF puts it."""

import math
from itertools import combinations

import pytest

from innervate.topology import TopologyError, cells_from_urdf
from innervate.topology.body import joining_reach
from innervate.topology.cover import thinned

pytest.importorskip("trimesh")
ROBOT = """<robot name="r">
  <link name="base"/>
  <link name="drum">
    <visual><origin xyz="0 0 0.1"/><geometry><cylinder radius="0.05" length="0.2"/></geometry>
    </visual>
  </link>
  <link name="ball"><collision><geometry><sphere radius="0.03"/></geometry></collision></link>
  <link name="tile"><visual><geometry><mesh filename="tile.stl" scale="0.001 0.001 0.001"/>
  </geometry></visual></link>
  <joint name="a" type="fixed"><parent link="base"/><child link="drum"/>
    <origin xyz="1 0 0" rpy="0 1.5707963267948966 0"/></joint>
  <joint name="b" type="fixed"><parent link="base"/><child link="ball"/></joint>
  <joint name="c" type="fixed"><parent link="base"/><child link="tile"/></joint>
</robot>
"""
TILE = """solid tile
facet normal 0 0 1
outer loop
vertex 0 0 0
vertex 100 0 0
vertex 0 100 0
endloop
endfacet
endsolid tile
"""


@pytest.fixture
def robot(tmp_path):
    path = tmp_path / "robot.urdf"
    path.write_text(ROBOT)
    (tmp_path / "tile.stl").write_text(TILE)
    return str(path)


def test_cells_lie_on_the_surface_and_apart(robot):
    names, places = cells_from_urdf(robot, "drum", None, 15.0)
    assert names[0] == "drum_0"
    # The cylinder lies along x from 1 m on, turned by the joint.
    for x, y, z in places:
        on_side = math.isclose(math.hypot(y, z), 50, abs_tol=1)
        assert on_side or math.isclose(min(abs(x - 1000), abs(x - 1200)), 0, abs_tol=1)
        assert 999 <= x <= 1201
    assert min(math.dist(a, b) for a, b in combinations(places, 2)) >= 15
    area = 2 * math.pi * 50 * 200 + 2 * math.pi * 50**2
    assert 0.55 * area / 15**2 < len(places) < 1.16 * area / 15**2


def test_the_same_every_time_and_other_shapes(robot):
    first = cells_from_urdf(robot, "*", None, 10.0)
    assert cells_from_urdf(robot, "*", None, 10.0) == first
    names, places = first
    balls = [p for n, p in zip(names, places, strict=True) if n.startswith("ball")]
    assert all(math.isclose(math.hypot(*p), 30, abs_tol=1.5) for p in balls)
    tiles = [p for n, p in zip(names, places, strict=True) if n.startswith("tile")]
    assert all(x >= 0 and y >= 0 and x + y <= 100.01 and z == 0 for x, y, z in tiles)
    assert not any(name.startswith("base") for name in names)


@pytest.mark.parametrize(("pattern", "pitch", "message"), [
    ("base", 10.0, "has a surface"),
    ("drum", 0.5, "too fine"),
    ("none", 10.0, "no link of"),
])  # fmt: skip
def test_what_cannot_be_covered(robot, pattern, pitch, message):
    with pytest.raises(TopologyError, match=message):
        cells_from_urdf(robot, pattern, None, pitch)


def test_a_mesh_that_is_not_there(robot, tmp_path):
    (tmp_path / "tile.stl").unlink()
    with pytest.raises(TopologyError, match=r"tile\.stl is not there"):
        cells_from_urdf(robot, "tile", None, 10.0)


def test_thinning_keeps_all_that_are_far_apart():
    line = [(float(x), 0.0, 0.0) for x in range(10)]
    assert thinned(line, 3.0) == line[::3]
    assert thinned(line, 0.5) == line


def test_the_reach_that_joins_all():
    assert joining_reach([(0, 0, 0), (3, 0, 0), (10, 0, 0), (4, 0, 0)]) == 6
    assert joining_reach([(0, 0, 0)]) == 0
