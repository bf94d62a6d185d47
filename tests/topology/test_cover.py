"""Cells on surfaces: even, on the surface, where the URDF puts it."""

import math
import re
import sys
from itertools import combinations

import pytest

from innervate.topology import TopologyError, cells_from_urdf, cover, normals_from_urdf
from innervate.topology.body import joining_reach
from innervate.topology.cover import find_mesh, thinned

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


def test_cells_lie_apart_on_links_of_several_shapes(tmp_path):
    """Shapes that touch, and one inside of another: the pitch holds for the link."""
    parts = "".join(
        f'<visual><origin xyz="{x} 0 0"/><geometry><box size="0.1 0.1 0.1"/></geometry></visual>'
        for x in (0, 0.1, 0.05)
    )
    path = tmp_path / "parts.urdf"
    path.write_text(f'<robot name="r"><link name="arm">{parts}</link></robot>')
    names, places = cells_from_urdf(str(path), "arm", None, 20.0)
    assert min(math.dist(a, b) for a, b in combinations(places, 2)) >= 20
    assert names == [f"arm_{i}" for i in range(len(names))]
    for (x, y, z), normal in zip(
        places, normals_from_urdf(str(path), "arm", None, 20.0), strict=True
    ):
        walls = [abs(x - wall) < 0.01 for wall in (-50, 0, 50, 100, 150)]
        sides = [any(walls), abs(abs(y) - 50) < 0.01, abs(abs(z) - 50) < 0.01]
        assert sides[[abs(part) > 0.9 for part in normal].index(True)]


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


def robot_of(folder, shape):
    path = folder / "one.urdf"
    path.write_text(
        f'<robot name="r"><link name="arm"><visual><geometry>{shape}</geometry></visual>'
        '</link><link name="frame"/></robot>'
    )
    return str(path)


@pytest.mark.parametrize(("shape", "words"), [
    ('<sphere radius="0"/>', 'a sphere of size "0"; it takes a number'),
    ('<sphere radius="-1"/>', 'a sphere of size "-1"; it takes a number'),
    ("<sphere/>", 'a sphere of size ""; it takes a number'),
    ('<sphere radius="big"/>', 'a sphere of size "big"; it takes a number'),
    ('<box size="1 1"/>', 'a box of size "1 1"; it takes 3 numbers'),
    ('<box size="1 0 1"/>', 'a box of size "1 0 1"; it takes 3 numbers'),
    ('<box size="1e308 1 1"/>', 'a box of size "1e308 1 1"; it takes 3 numbers'),
    ('<sphere radius="inf"/>', 'a sphere of size "inf"; it takes a number'),
    ('<sphere radius="1000001"/>', 'a sphere of size "1000001"; it takes a number'),
    ('<cylinder radius="1" length="nan"/>', 'a cylinder of size "nan"; it takes a number'),
])  # fmt: skip
def test_shapes_without_a_size_are_refused_by_the_links_name(tmp_path, shape, words):
    with pytest.raises(TopologyError) as caught:
        cells_from_urdf(robot_of(tmp_path, shape), "*", None, 10.0)
    assert str(caught.value) == f"link arm has {words} above 0, up to 1e+06"


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize(("far", "words"), [
    ("0", "a mesh of link arm has no surface"),
    ("1e308", r"far\.obj of link arm has points farther than 1e\+06 away"),
])  # fmt: skip
def test_a_mesh_is_refused_that_has_no_surface_or_is_larger_than_any_robot(tmp_path, far, words):
    (tmp_path / "far.obj").write_text(f"v 0 0 0\nv {far} 0 0\nv 0 {far} 0\nf 1 2 3\n")
    box = robot_of(tmp_path, '<mesh filename="far.obj"/>')
    with pytest.raises(TopologyError, match=words):
        cells_from_urdf(box, "*", None, 10.0)


def test_a_mesh_with_a_point_that_is_no_number_is_refused_though_the_rest_of_it_is_whole(tmp_path):
    whole = TILE.removesuffix("endsolid tile\n")
    _, facet = whole.split("solid tile\n")
    torn = facet.replace("vertex 0 0 0", "vertex nan 0 0")
    (tmp_path / "torn.stl").write_text(f"{whole}{torn}endsolid tile\n")
    tile = robot_of(tmp_path, '<mesh filename="torn.stl"/>')
    with pytest.raises(TopologyError, match=r"torn\.stl of link arm has .* that are no numbers"):
        cells_from_urdf(tile, "*", None, 10.0)


@pytest.mark.parametrize("mesh", ["<mesh/>", '<mesh filename=""/>'])
def test_a_mesh_without_a_file_is_told_as_that(tmp_path, mesh):
    with pytest.raises(TopologyError, match=r"a <mesh> of link arm names no file; give it a"):
        cells_from_urdf(robot_of(tmp_path, mesh), "*", None, 10.0)


def test_a_box_is_as_large_as_it_says_each_way(tmp_path):
    box = robot_of(tmp_path, '<box size="0.1 0.2 0.3"/>')
    _, places = cells_from_urdf(box, "*", None, 20.0)
    for axis, half_mm in enumerate((50, 100, 150)):
        assert max(abs(place[axis]) for place in places) == pytest.approx(half_mm, abs=0.01)


def test_a_mesh_may_be_mirrored_by_its_scale(robot, tmp_path):
    tile = robot_of(tmp_path, '<mesh filename="tile.stl" scale="-0.001 0.002 0.001"/>')
    _, places = cells_from_urdf(tile, "*", None, 10.0)
    assert all(-100 <= x <= 0 and 0 <= y <= 200 for x, y, _ in places)
    assert min(x for x, *_ in places) < -80
    assert max(y for _, y, _ in places) > 160


def collada(folder, unit_m="1"):
    """A box of 200 units as a Collada file."""
    trimesh = pytest.importorskip("trimesh")
    pytest.importorskip("collada")
    text = trimesh.exchange.dae.export_collada(trimesh.creation.box(extents=[200] * 3)).decode()
    unit = f'<unit name="one" meter="{unit_m}"/>'
    asset = re.sub(r"<unit [^>]*/>", "", text).replace("</asset>", f"{unit}</asset>")
    assert unit in asset
    (folder / "box.dae").write_text(asset)
    return '<mesh filename="box.dae" scale="1 1 1"/>'


def test_collada_meshes_are_read_in_their_own_unit(tmp_path):
    shape = collada(tmp_path, "0.001")
    names, places = cells_from_urdf(robot_of(tmp_path, shape), "*", None, 50.0)
    assert len(names) > 40
    assert max(abs(x) for place in places for x in place) == pytest.approx(100)


def test_a_collada_mesh_names_the_package_that_is_missing(tmp_path, monkeypatch):
    shape = collada(tmp_path)
    monkeypatch.setitem(sys.modules, "collada", None)
    with pytest.raises(TopologyError, match=r"box\.dae of link arm .* pip install pycollada"):
        cells_from_urdf(robot_of(tmp_path, shape), "*", None, 50.0)


def test_links_whose_shapes_cannot_be_read_are_named(tmp_path):
    path = robot_of(tmp_path, '<mesh filename="arm.step"/>')
    with pytest.raises(TopologyError, match=r"no shape of arm can be read \(meshes: \.step\)"):
        cells_from_urdf(path, "*", None, 50.0)


@pytest.mark.parametrize(("count", "more"), [(8, ""), (9, " and 1 more"), (11, " and 3 more")])
def test_of_many_links_eight_are_named(tmp_path, count, more):
    shape = '<visual><geometry><mesh filename="a.{}"/></geometry></visual>'
    links = "".join(f'<link name="l{i}">{shape.format("step" if i else "xyz")}</link>'
                    for i in range(count))  # fmt: skip
    (tmp_path / "one.urdf").write_text(f'<robot name="r">{links}</robot>')
    with pytest.raises(TopologyError) as caught:
        cells_from_urdf(str(tmp_path / "one.urdf"), "*", None, 50.0)
    assert str(caught.value).startswith(
        f"one.urdf: no shape of l0, l1, l2, l3, l4, l5, l6, l7{more} can be read "
        "(meshes: .step, .xyz); convert them to one of .stl, .obj, .ply, .off, .glb, .dae, or"
    )


@pytest.mark.parametrize(("robot", "links"), [("kinova", 11), ("anymal-kinova", 35)])
def test_robots_whose_links_have_collada_meshes_only(robot, links):
    pytest.importorskip("collada")
    try:
        names, _ = cells_from_urdf(f"package:example-robot-data/{robot}", "*", None, 60.0)
    except TopologyError as error:
        pytest.skip(str(error)) if "not installed" in str(error) else pytest.fail(str(error))
    assert len({name.rpartition("_")[0] for name in names}) >= links - 4  # some are too small


def test_thinning_keeps_all_that_are_far_apart():
    line = [(float(x), 0.0, 0.0) for x in range(10)]
    assert thinned(line, 3.0) == line[::3]
    assert thinned(line, 0.5) == line


def test_the_reach_that_joins_all():
    assert joining_reach([(0, 0, 0), (3, 0, 0), (10, 0, 0), (4, 0, 0)]) == 6
    assert joining_reach([(0, 0, 0)]) == 0


@pytest.mark.parametrize("axis", range(3))
def test_points_are_thinned_across_the_cubes_they_lie_in(axis):
    def at(value):
        return tuple(value if a == axis else 0.5 for a in range(3))

    assert thinned([at(0.9), at(1.1), at(-0.05)], 1.0) == [at(0.9)]
    apart = [at(0.5), at(1.5), at(-0.5)]
    assert thinned(apart, 1.0) == apart
    assert thinned([at(2.75), at(1.5), at(3.5), at(3.75)], 1.0) == [at(2.75), at(1.5), at(3.75)]


def test_cells_face_outwards(robot):
    _, places = cells_from_urdf(robot, "ball", None, 15.0)
    normals = normals_from_urdf(robot, "ball", None, 15.0)
    assert len(normals) == len(places) > 10
    for place, normal in zip(places, normals, strict=True):
        assert math.hypot(*normal) == pytest.approx(1)
        assert sum(a * b for a, b in zip(place, normal, strict=True)) > 0.95 * 30


def test_what_is_to_be_seen_comes_before_what_is_hit(tmp_path):
    shapes = "".join(f'<{kind}><geometry><sphere radius="{r}"/></geometry></{kind}>'
                     for kind, r in (("collision", 0.09), ("visual", 0.03)))  # fmt: skip
    (tmp_path / "one.urdf").write_text(f'<robot name="r"><link name="a">{shapes}</link></robot>')
    _, places = cells_from_urdf(str(tmp_path / "one.urdf"), "*", None, 15.0)
    assert max(math.hypot(*place) for place in places) == pytest.approx(30, abs=0.1)


def test_a_mesh_is_looked_for_beside_and_above_and_below_its_packages_name(tmp_path):
    urdf = tmp_path / "share" / "bot" / "urdf" / "bot.urdf"
    urdf.parent.mkdir(parents=True)
    for place in ("share/bot/urdf/near.stl", "share/bot/meshes/arm.stl"):
        (tmp_path / place).parent.mkdir(exist_ok=True)
        (tmp_path / place).touch()
    assert find_mesh("near.stl", urdf) == urdf.parent / "near.stl"
    wanted = tmp_path / "share/bot/meshes/arm.stl"
    for name in ("package://bot/meshes/arm.stl", "meshes/arm.stl", f"file://{wanted}"):
        assert find_mesh(name, urdf) == wanted
    with pytest.raises(TopologyError, match=r"none\.stl is not there"):
        find_mesh("package://bot/none.stl", urdf)


def test_all_links_together_carry_no_more_cells_than_there_can_be(tmp_path, monkeypatch):
    ball = '<visual><geometry><sphere radius="0.03"/></geometry></visual>'
    links = "".join(f'<link name="b{i}">{ball}</link>' for i in range(2))
    (tmp_path / "two.urdf").write_text(f'<robot name="r">{links}</robot>')
    monkeypatch.setattr(cover, "CELLS_MAX", 13)
    assert len(cells_from_urdf(str(tmp_path / "two.urdf"), "b0", None, 30.0)[0]) <= 13
    with pytest.raises(TopologyError, match="a pitch of 30 mm makes more than 13 cells") as caught:
        cells_from_urdf(str(tmp_path / "two.urdf"), "*", None, 30.0)
    assert caught.value.subject == "pitch_mm"


def test_a_mesh_is_known_by_its_suffix_however_it_is_written(robot, tmp_path):
    (tmp_path / "tile.stl").rename(tmp_path / "TILE.STL")
    upper = robot_of(tmp_path, '<mesh filename="TILE.STL" scale="0.001 0.001 0.001"/>')
    assert len(cells_from_urdf(upper, "*", None, 20.0)[0]) > 5


@pytest.mark.parametrize(("name", "text"), [
    ("a.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 9\n"),
    ("a.dae", "<COLLADA/>"),
])  # fmt: skip
def test_a_damaged_mesh_is_told_without_its_readers_own_words(tmp_path, name, text):
    (tmp_path / name).write_text(text)
    with pytest.raises(TopologyError) as caught:
        cells_from_urdf(robot_of(tmp_path, f'<mesh filename="{name}"/>'), "arm", None, 10.0)
    assert str(caught.value) == f"{name} of link arm is no mesh: it is damaged or incomplete"


def test_a_link_that_is_too_large_is_told_with_its_surface(tmp_path):
    """A robot whose lengths were written in mm."""
    with pytest.raises(TopologyError) as caught:
        cells_from_urdf(robot_of(tmp_path, '<box size="100 100 100"/>'), "arm", None, 25.0)
    assert str(caught.value) == (
        "a pitch of 25 mm is too fine for link arm, whose surface is 60,000.00 m2; "
        "take a wider (lengths in a URDF are metres)"
    )
