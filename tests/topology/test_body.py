"""Robot bodies: URDF poses, cables within reach, interface ports far apart."""

from __future__ import annotations

import importlib.util
import math
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from innervate.topology import TopologyError, body_graph, cells_from_urdf, normals_from_urdf
from innervate.topology.body import CELLS_MAX
from innervate.topology.layout import cell_places

ROBOT = "package:icub-models/iCubGenova02"
has_icub = pytest.mark.skipif(
    importlib.util.find_spec("icub_models") is None, reason="pip install icub-models"
)

URDF = """<robot name="r">
  <link name="base"/> <link name="arm"/> <link name="skin_0"/> <link name="skin_1"/>
  <joint name="j0" type="revolute"><parent link="base"/><child link="arm"/>
    <origin xyz="1 0 0" rpy="0 0 1.5707963267948966"/></joint>
  <joint name="j1" type="fixed"><parent link="arm"/><child link="skin_0"/>
    <origin xyz="0.02 0 0"/></joint>
  <joint name="j2" type="fixed"><parent link="arm"/><child link="skin_1"/>
    <origin xyz="0 0.02 0.01" rpy="0.1 0.2 0.3"/></joint>
</robot>"""


def test_poses_follow_the_joints(tmp_path: Path) -> None:
    (tmp_path / "r.urdf").write_text(URDF)
    names, places = cells_from_urdf("r.urdf", "skin_*", tmp_path)
    assert names == ["skin_0", "skin_1"]
    assert places[0] == pytest.approx((1000, 20, 0))
    assert places[1] == pytest.approx((980, 0, 10))
    assert cells_from_urdf("r.urdf", r"skin_\d", tmp_path)[0] == names


@pytest.mark.parametrize(
    ("text", "pattern", "words"),
    [
        ("<robot", "x", "is no XML"),
        ("<sdf/>", "x", "its root is <sdf>"),
        (URDF, "foot_*", 'no link of r.urdf matches "foot_'),
        (URDF, "(", "neither a glob"),
        (URDF.replace("0.02 0 0", "0.02 0"), "skin_*", "takes three numbers"),
        (URDF.replace("0.02 0 0", "nan 0 0"), "skin_*", "takes three numbers"),
        (URDF.replace('parent link="base"', 'parent link="skin_0"'), "skin_*", "form a ring"),
        (
            URDF.replace('<link name="skin_1"/>', '<link name="skin_&#x202e;1"/>'),
            "skin_*",
            r"a link of r.urdf holds U\+202E (right-to-left override\), which nobody sees",
        ),
        (
            URDF.replace('<link name="skin_1"/>', 2 * '<link name="skin_0"/>'),
            "skin_*",
            'r.urdf has 3 links called "skin_0"; name them apart',
        ),
    ],
)
def test_wrong_files(tmp_path: Path, text: str, pattern: str, words: str) -> None:
    (tmp_path / "r.urdf").write_text(text)
    with pytest.raises(TopologyError, match=words.replace("(", r"\(")):
        cells_from_urdf("r.urdf", pattern, tmp_path)


def test_a_robot_that_is_too_large_is_not_read(tmp_path: Path, monkeypatch) -> None:
    (tmp_path / "r.urdf").write_text(URDF)
    monkeypatch.setattr("innervate.topology.urdf.SIZE_MAX", len(URDF))
    assert cells_from_urdf("r.urdf", "skin_*", tmp_path)[0]
    monkeypatch.setattr("innervate.topology.urdf.SIZE_MAX", len(URDF) - 1)
    with pytest.raises(TopologyError, match=r"r\.urdf is too large for a URDF file"):
        cells_from_urdf("r.urdf", "skin_*", tmp_path)


def test_missing_files_and_packages(tmp_path: Path) -> None:
    with pytest.raises(TopologyError, match="cannot read the URDF file"):
        cells_from_urdf("none.urdf", "x", tmp_path)
    with pytest.raises(TopologyError, match="pip install no-such-robot"):
        cells_from_urdf("package:no-such-robot/x", "x", tmp_path)


def test_apart_cells_say_what_reach_would_do() -> None:
    names = ["a", "b", "c", "far"]
    places = [(0.0, 0.0, 0.0), (20.0, 0.0, 0.0), (40.0, 0.0, 0.0), (95.5, 0.0, 0.0)]
    with pytest.raises(TopologyError, match=r"leave out far; reach_mm = 55.5") as caught:
        body_graph(names, places, 30, 1)
    assert caught.value.subject == "reach_mm"
    graph = body_graph(names, places, 55.5, ["far"])
    assert list(graph.depths()) == [3, 3, 2, 1]  # a reaches c directly
    with pytest.raises(TopologyError, match='names "x", which is no cell'):
        body_graph(names, places, 60, ["x"])
    with pytest.raises(TopologyError, match="only 4 cells"):
        body_graph(names, places, 60, 5)


@settings(max_examples=40, deadline=None)
@given(
    st.lists(st.tuples(*[st.integers(0, 60)] * 3), min_size=1, max_size=24, unique=True),
    st.integers(1, 3),
)
def test_cables_are_within_reach_and_hold_everything_together(
    spots: list[tuple[int, int, int]], interfaces: int
) -> None:
    places = [(float(x), float(y), float(z)) for x, y, z in spots]
    names = [f"c{i}" for i in range(len(places))]
    try:
        graph = body_graph(names, places, 40.0, interfaces)
    except TopologyError:
        return
    assert graph.interfaces == interfaces
    assert min(graph.depths()) >= 1
    for a, b in graph.links():
        if b < 4 * graph.cells:
            assert math.dist(places[a // 4], places[b // 4]) <= 40.0
    assert all(math.isfinite(v) for point in cell_places(graph) for v in point)


@has_icub
@pytest.mark.parametrize(
    ("pattern", "cells"),
    [("r_forearm_skin_*", 24), ("l_forearm_skin_*", 24), ("r_lower_leg_skin_*", 38)],
)
def test_icub_skin(pattern: str, cells: int) -> None:
    names, places = cells_from_urdf(ROBOT, pattern)
    assert len(names) == cells
    graph = body_graph(names, places, 30.0, 2)
    assert min(graph.depths()) == 1
    assert max(graph.depths()) < 16
    ends = [graph.peer[4 * cells + i] // 4 for i in range(2)]
    assert math.dist(places[ends[0]], places[ends[1]]) > 60
    points = cell_places(graph)
    assert max(x for x, _ in points) > 50
    assert max(y for _, y in points) > 80


@has_icub
def test_icub_robots_are_named_when_one_is_not_there() -> None:
    with pytest.raises(TopologyError, match="iCubGenova02"):
        cells_from_urdf("package:icub-models/iCubNowhere", "x")


def test_a_frame_is_turned_by_roll_then_pitch_then_yaw(tmp_path: Path) -> None:
    """A cell faces along the z axis of its link, and lies where its joints put it."""
    turns = ["0 0 0", "0.5 0 0", "0 0.5 0", "0.5 0 1", "0 0.5 1", "0.3 0.4 0.5"]
    joints = "".join(
        f'<link name="c{i}"/><joint name="j{i}" type="fixed"><parent link="base"/>'
        f'<child link="c{i}"/><origin xyz="0 0 {i}" rpy="{rpy}"/></joint>'
        for i, rpy in enumerate(turns)
    )
    (tmp_path / "r.urdf").write_text(f'<robot name="r"><link name="base"/>{joints}</robot>')
    sin, cos = math.sin, math.cos
    found = normals_from_urdf("r.urdf", "c*", tmp_path)
    assert found[:5] == [
        pytest.approx(one)
        for one in [
            (0, 0, 1), (0, -sin(0.5), cos(0.5)), (sin(0.5), 0, cos(0.5)),
            (sin(0.5) * sin(1), -sin(0.5) * cos(1), cos(0.5)),
            (sin(0.5) * cos(1), sin(0.5) * sin(1), cos(0.5)),
        ]
    ]  # fmt: skip
    x, y = cos(0.3) * sin(0.4), -sin(0.3)  # after roll and pitch
    turned = (x * cos(0.5) - y * sin(0.5), x * sin(0.5) + y * cos(0.5), cos(0.3) * cos(0.4))
    assert found[5] == pytest.approx(turned)
    assert cells_from_urdf("r.urdf", "c*", tmp_path)[1][2] == pytest.approx((0, 0, 2000))


def test_a_chain_of_joints_adds_up_in_the_frames_of_its_links(tmp_path: Path) -> None:
    quarter = math.pi / 2
    links = "".join(f'<link name="l{i}"/>' for i in range(4))
    joints = "".join(
        f'<joint name="j{i}" type="fixed"><parent link="l{i}"/><child link="l{i + 1}"/>'
        f'<origin xyz="1 0 0" rpy="0 0 {quarter}"/></joint>'
        for i in (2, 0, 1)
    )
    (tmp_path / "r.urdf").write_text(f'<robot name="r">{links}{joints}</robot>')
    names, places = cells_from_urdf("r.urdf", "l*", tmp_path)
    assert names == ["l0", "l1", "l2", "l3"]
    assert places == [pytest.approx(one, abs=1e-9) for one in [
        (0, 0, 0), (1000, 0, 0), (1000, 1000, 0), (0, 1000, 0)]]  # fmt: skip


def test_the_graph_that_is_kept_stays_as_it_is() -> None:
    places = [(0.0, 0.0, 0.0), (10.0, 0.0, 0.0)]
    first = body_graph(["a", "b"], places, 20.0, 1)
    first.add_interface(1)
    again = body_graph(["a", "b"], places, 20.0, 1)
    assert (again.interfaces, len(again.peer)) == (1, 9)
    assert list(again.positions) == [0, 0, 0, 10, 0, 0]


def test_too_many_cells_are_refused() -> None:
    names = [f"c{i}" for i in range(CELLS_MAX + 1)]
    with pytest.raises(TopologyError, match="5001 links match; at most 5000") as caught:
        body_graph(names, [(0.0, 0.0, 0.0)] * len(names), 20.0, 1)
    assert caught.value.subject == "links"


def test_an_interface_on_a_cell_without_a_port_is_refused() -> None:
    places = [(0.0, 0.0, 0.0)] + [
        (10.0 * x, 10.0 * y, 0.0) for x, y in ((1, 0), (-1, 0), (0, 1), (0, -1))
    ]
    with pytest.raises(TopologyError, match="a has no free port") as caught:
        body_graph(list("abcde"), places, 10.0, ["a"])
    assert caught.value.subject == "interfaces"


def test_a_frame_is_turned_within_the_one_that_it_hangs_on(tmp_path: Path) -> None:
    quarter = math.pi / 2
    origins = [("1 0 0", f"0 0 {quarter}"), ("1 0 0", f"{quarter} 0 0"), ("0 0 1", "0 0 0")]
    joints = "".join(
        f'<link name="l{i + 1}"/><joint name="j{i}" type="fixed"><parent link="l{i}"/>'
        f'<child link="l{i + 1}"/><origin xyz="{xyz}" rpy="{rpy}"/></joint>'
        for i, (xyz, rpy) in enumerate(origins)
    )
    (tmp_path / "r.urdf").write_text(f'<robot name="r"><link name="l0"/>{joints}</robot>')
    assert normals_from_urdf("r.urdf", "l2", tmp_path) == [pytest.approx((1, 0, 0))]
    places = cells_from_urdf("r.urdf", "l*", tmp_path)[1]
    assert places[2:] == [pytest.approx((1000, 1000, 0)), pytest.approx((2000, 1000, 0))]


@pytest.mark.parametrize("xyz", ["0 0 nan", "0 inf 0", "0 -inf inf", "0 0 0 0", ""])
def test_an_origin_takes_three_numbers(tmp_path: Path, xyz: str) -> None:
    (tmp_path / "r.urdf").write_text(URDF.replace("0.02 0 0", xyz))
    with pytest.raises(TopologyError, match="takes three numbers"):
        cells_from_urdf("r.urdf", "skin_*", tmp_path)


def test_an_expression_is_of_whole_names_and_a_glob_comes_first(tmp_path: Path) -> None:
    (tmp_path / "r.urdf").write_text(URDF)
    for part in ("skin_", "kin_0", r"skin_\d\d"):
        with pytest.raises(TopologyError, match=r"no link of r\.urdf matches"):
            cells_from_urdf("r.urdf", part, tmp_path)
    assert cells_from_urdf("r.urdf", "skin_0|arm", tmp_path)[0] == ["arm", "skin_0"]
    assert cells_from_urdf("r.urdf", "*", tmp_path)[0] == ["base", "arm", "skin_0", "skin_1"]


@pytest.mark.parametrize("pitch_mm", [None, 30.0])
def test_a_robot_description_that_is_not_there_is_said(tmp_path, pitch_mm):
    with pytest.raises(TopologyError, match=r"nofile\.urdf"):
        cells_from_urdf("nofile.urdf", "*", tmp_path, pitch_mm)
