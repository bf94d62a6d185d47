"""Robot bodies: URDF poses, cables within reach, interface ports far apart."""

from __future__ import annotations

import importlib.util
import math
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from innervate.topology import TopologyError, body_graph, cells_from_urdf
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
    ],
)
def test_wrong_files(tmp_path: Path, text: str, pattern: str, words: str) -> None:
    (tmp_path / "r.urdf").write_text(text)
    with pytest.raises(TopologyError, match=words.replace("(", r"\(")):
        cells_from_urdf("r.urdf", pattern, tmp_path)


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
    assert graph.depth_max < 16
    ends = [graph.peer[4 * cells + i] // 4 for i in range(2)]
    assert math.dist(places[ends[0]], places[ends[1]]) > 60
    points = cell_places(graph)
    assert max(x for x, _ in points) > 50
    assert max(y for _, y in points) > 80


@has_icub
def test_icub_robots_are_named_when_one_is_not_there() -> None:
    with pytest.raises(TopologyError, match="iCubGenova02"):
        cells_from_urdf("package:icub-models/iCubNowhere", "x")
