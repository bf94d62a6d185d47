"""Fences, names and walks of a mesh, from tables that are written here."""

import itertools
import re
from contextlib import nullcontext
from types import SimpleNamespace as Of

import pytest

import innervate
from innervate.networks.mesh.protocol.fields import POINTS
from innervate.networks.mesh.scenario import fence as fences
from innervate.networks.mesh.scenario import params, robots
from innervate.networks.mesh.scenario.model import FenceTable, RobotTable
from innervate.networks.mesh.scenario.nodes import (
    Nodes,
    alike,
    anchor,
    import_path,
    listed,
    nodes_of,
)
from innervate.scenario import ScenarioError
from innervate.scenario import robots as spine
from innervate.scenario.bundled import FOLDER
from innervate.scenario.source import Source

SQUARE = [(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0)]
HERE = Source("", "")


def fence(polygon=SQUARE, **more):
    return FenceTable(polygon=polygon, **more)


def refused(*args, **more):
    """Why a fence cannot be; "" if it can."""
    try:
        fences.check(HERE, fence(*args, **more))
    except ScenarioError as error:
        return str(error)
    return ""


def hole(x, y, side=1.0):
    return [(x, y), (x + side, y), (x + side, y + side), (x, y + side)]


def test_a_last_corner_that_repeats_the_first_is_dropped():
    assert fences.rings_cm(fence([*SQUARE, (0.0, 0.0)])) == fences.rings_cm(fence())
    assert fences.rings_cm(fence(SQUARE[:1])) == [[(0, 0)]]
    assert refused([*SQUARE, (0.0, 0.0)]) == ""


@pytest.mark.parametrize(("polygon", "words"), [
    (SQUARE[:3], ""),
    (SQUARE[:2], "fence.polygon must have 3 corners or more, not 2"),
    ([*SQUARE[:3], SQUARE[2], SQUARE[3]], "has corner 2 twice in a row"),
    ([SQUARE[0], SQUARE[2], SQUARE[1], SQUARE[3]], "crosses itself: edge 0 (from corner 0) and"),
    # A corner on another edge; then edges that go back over the one before.
    ([*SQUARE[:3], (5.0, 0.0)], "touches itself: edge 0 (from corner 0) and edge 2 meet"),
    ([(0.0, 0.0), (10.0, 0.0), (5.0, 0.0), (5.0, 5.0)], "edges 0 and 1 lie on each other"),
    ([(0.0, 0.0), (5.0, 0.0), (5.0, 5.0), (10.0, 0.0)], "edges 0 and 3 lie on each other"),
    ([(5.0, 0.0), (10.0, 0.0), (10.0, 5.0), (0.0, 0.0)], ""),
    ([(5.0, 0.0), (0.0, 0.0), (0.0, 5.0), (10.0, 0.0)], ""),
    ([(0.0, 0.0), (5.0, 0.0), (5.0, 5.0), (-5.0, 0.0)], ""),
    ([(0.0, 0.0), (5.0, 0.0), (5.0, 5.0), (3.0, 0.0)], "touches itself: edge"),
])  # fmt: skip
def test_a_polygon_meets_itself_at_its_corners_only(polygon, words):
    said = refused(polygon)
    assert words in said
    assert bool(words) == bool(said)


@pytest.mark.parametrize(("holes", "words"), [
    ([hole(2, 2)], ""),
    ([hole(2, 2), hole(4, 4)], ""),
    ([hole(0, 2)], "fence.holes.0 is not wholly inside"),
    ([hole(20, 20)], "fence.holes.0 is not wholly inside"),
    ([hole(2, 2, 9.0)], "fence.holes.0 is not wholly inside"),
    ([hole(-1, -1, 12.0)], "fence.holes.0 is not wholly inside"),
    ([hole(2, 2), hole(3, 3)], "fence.holes.0 and 1 overlap or touch"),
    ([hole(2, 2), hole(2.2, 2.2, 0.5)], "fence.holes.0 and 1 overlap or touch"),
    ([hole(2.2, 2.2, 0.5), hole(2, 2)], "fence.holes.0 and 1 overlap or touch"),
])  # fmt: skip
def test_holes_lie_inside_and_apart(holes, words):
    assert words in refused(holes=holes)
    assert bool(words) == bool(refused(holes=holes))


@pytest.mark.parametrize(("more", "fits"), [(0, True), (1, False)])
def test_all_corners_fit(more, fits):
    """Those of the holes, too."""
    corners = POINTS - 4 + more
    ring = [(1.0 + 8.0 * k / corners, 1.0 + 3.0 * (k / corners) ** 2) for k in range(corners - 1)]
    said = refused(holes=[[*ring, (1.0, 9.0)]])
    assert said == "" if fits else f"has {POINTS + 1} corners, more than {POINTS}" in said


@pytest.mark.parametrize(("point", "outside"), [
    ((500, 500), False), ((0, 0), False), ((0, 500), False), ((1000, 400), False),
    ((1001, 400), True), ((-1, 0), True), ((250, 250), True), ((200, 250), False),
    ((300, 300), False), ((2000, 0), True), ((199, 250), False), ((500, 1001), True),
])  # fmt: skip
def test_an_edge_is_inside_and_a_hole_is_not(point, outside):
    assert fences.is_outside(fence(holes=[hole(2, 2)]), point) == outside


@pytest.mark.parametrize(("far_m", "unit"), [
    (230.0, 1), (230.01, 10), (2300.0, 10), (2300.1, 100), (23_000.0, 100),
])  # fmt: skip
def test_the_unit_is_the_smallest_that_reaches(far_m, unit):
    """Robots' places count; corners are told from the least x and y."""
    found = fences.parameters(HERE, fence([(x - 3.0, y + 2.0) for x, y in SQUARE], clear_m=5.0),
                              [(round(100 * far_m) - 300, 200)], 1)  # fmt: skip
    assert found["unit_cm"] == unit
    assert found["px"][:5] == [0, 1000 // unit, 1000 // unit, 0, 0]
    assert found["py"][:5] == [0, 0, 1000 // unit, 1000 // unit, 0]
    assert found["after"][:5] == [1, 2, 3, 0, 0]
    assert (found["points"], found["clear_margin"], found["watch"]) == (4, 500 // unit, 1)
    assert fences.parameters(HERE, fence(), [], 0)["watch"] == 0
    with pytest.raises(ScenarioError, match="23 km is the most"):
        fences.parameters(HERE, fence(), [(2_300_001, 0)], 1)
    with pytest.raises(ScenarioError, match=r"unit_cm = 1 reaches 230 m.*230\.01 m; make it 10"):
        fences.parameters(HERE, fence(unit_cm=1), [(23_001, 0)], 1)


def test_corners_are_told_from_the_least_x_and_y_and_each_has_a_next_one():
    found = fences.parameters(HERE, fence([*SQUARE[2:], *SQUARE[:2]], holes=[hole(2, 3)]), [], 0)
    assert found["px"][:9] == [1000, 0, 0, 1000, 200, 300, 300, 200, 0]
    assert found["py"][:9] == [1000, 1000, 0, 0, 300, 300, 400, 400, 0]
    assert found["after"][:9] == [1, 2, 3, 0, 5, 6, 7, 4, 0]
    assert found["points"] == 8


def test_a_unit_may_be_too_large_for_the_corners():
    with pytest.raises(ScenarioError, match="twice in a row"):
        fences.parameters(HERE, fence([(0, 0), (0.4, 0), (10, 0), (10, 10)], unit_cm=100), [], 1)


def test_nodes_are_known_by_name_and_number():
    nodes = Nodes(HERE, ["a", "b", "c"])
    assert [nodes.number(("x",), given) for given in (0, 2, "b")] == [0, 2, 1]
    for wrong in (-1, 3):
        with pytest.raises(ScenarioError, match=f"x: there is no node {wrong}; they are numbered"):
            nodes.number(("x",), wrong)
    with pytest.raises(ScenarioError, match='x: there is no node "d"; there are a, b, c'):
        nodes.number(("x",), "d")


def test_names_are_listed_as_far_as_there_is_room():
    names = [f"n{k:02}" for k in range(13)]
    assert alike("zz", names[:12]) == "; there are " + ", ".join(names[:12])
    assert alike("zz", names) == "; there are n00 to n12"
    assert alike("n12x", names).startswith('; did you mean "n12"')
    assert listed(names[:4]) == "n00, n01, n02, n03"
    assert listed(names[:5]) == "n00, n01, n02, n03 and 1 more"
    assert listed(names, 2) == "n00, n01 and 11 more"


LINK = innervate.Mesh.Link


def named(**tables):
    return nodes_of(innervate.Mesh(**tables), HERE)


def test_links_are_told_from_the_smaller_number_on():
    links = [LINK(a="b", b="a", quality=(0.9, 0.8)), LINK(a="c", b="b", quality=0.7)]
    found = named(link=links)
    assert found.names == ["b", "a", "c"]
    assert found.links == {(0, 1): (0.9, 0.8), (0, 2): (0.7, 0.7)}
    found = named(nodes=2, link=[LINK(a=1, b=0, quality=(0.9, 0.8))])
    assert found.links == {(0, 1): (0.8, 0.9)}


@pytest.mark.parametrize(("links", "words"), [
    ([("a", "a")], "link.0 joins a with itself"),
    ([("a", "b"), ("b", "a")], "link.1 joins b and a a second time"),
    ([("a", "b"), ("a", "b")], "link.1 joins a and b a second time"),
])  # fmt: skip
def test_two_nodes_are_joined_once(links, words):
    with pytest.raises(ScenarioError, match=words):
        named(link=[LINK(a=a, b=b) for a, b in links])


def test_nodes_have_places_if_all_of_them_have():
    node = innervate.Mesh.Node
    assert named(node=[node(x_m=1.0, y_m=2.0), node(name="b", x_m=3.0, y_m=4.5)]).points == [
        (100, 200), (300, 450),
    ]  # fmt: skip
    assert named(node=[node(x_m=1.0, y_m=2.0), node(name="b")]).points == []
    with pytest.raises(ScenarioError, match='there are two nodes "n1"; rename one'):
        named(node=[node(name="n1"), node()])


@pytest.mark.parametrize(("ends", "fits"), [(254, True), (255, False)])
def test_an_address_is_a_byte(ends, fits):
    links = [LINK(a="n0", b=f"n{k}") for k in range(1, ends)]
    if fits:
        assert len(named(link=links).names) == ends
        return
    with pytest.raises(ScenarioError, match="255 nodes are too many"):
        named(link=links)


def test_bundled_imports_are_named_and_others_lie_beside_the_scenario():
    there = Source("", "/there")
    assert str(import_path("x.json", there)) == "/there/x.json"
    assert str(import_path("freifunk/none", there)) == "/there/freifunk/none"
    names = sorted(one.stem for one in (FOLDER / "freifunk").iterdir() if one.suffix == ".json")
    for name in (f"freifunk/{names[0]}", f"freifunk/{names[0]}.json"):
        assert import_path(name, there) == FOLDER / "freifunk" / f"{names[0]}.json"
        tables = {"import": {"file": name}}
        anchor(tables, there)
        assert tables == {"import": {"file": name}}
    tables = {"import": {"file": "x.json"}}
    anchor(tables, there)
    assert tables == {"import": {"file": "/there/x.json"}}
    for tables in ({}, {"import": None}, {"import": {"file": None}}):
        anchor(tables, there)


def test_a_robot_is_there_once():
    tables = [RobotTable(node=k, waypoints=[(1.0, k)]) for k in (1, 0)]
    nodes = Nodes(HERE, ["a", "b"])
    assert spine.starts(tables, nodes) == {1: (100, 100), 0: (100, 0)}
    tables.append(RobotTable(node="a"))
    with pytest.raises(ScenarioError, match="there are two robots a; leave one out"):
        spine.starts(tables, nodes)


def test_a_step_takes_a_moment():
    """1 cm at 100 m/s: 100 us. What is no step takes none, and a walk goes on until the end."""
    step = spine._leg_us(RobotTable(node=0, speed_mps=100.0), (0, 0), (0, 1))
    assert step == 100
    assert spine._leg_us(RobotTable(node=0), (3, 3), (3, 3)) == 0
    there = walked(random=True, area=(0.0, 0.0, 0.01, 0.01), speed_mps=1.0, duration_us=400_000)
    assert all(a[1:] != b[1:] for a, b in itertools.pairwise(there))
    there = walked(
        random=True, waypoints=[(0.0, 0.0), (0.0, 1.0)], area=(0.0, 0.0, 1.0, 1.0),
        duration_us=1_000_000,
    )  # fmt: skip
    assert there == [(0, 0, 0), (1_000_000, 0, 100)]


def walked(duration_us=10_000_000, points=(), **robot):
    made = RobotTable(node=0, **robot)
    model = Of(robot=[made], seed=1, fence=None)
    (walk,) = robots.walks(model, Nodes(HERE, ["r"]), list(points), duration_us)
    return list(walk.points)


def test_a_robot_goes_from_point_to_point():
    way = [(0.0, 0.0), (3.0, 4.0), (3.0, 4.0), (3.0, 5.0)]
    assert walked(waypoints=way, speed_mps=2.0, start_s=1.0) == [
        (1_000_000, 0, 0), (3_500_000, 300, 400), (4_000_000, 300, 500),
    ]  # fmt: skip
    assert walked(waypoints=way, speed_mps=2.0, pause_s=0.25) == [
        (0, 0, 0), (2_500_000, 300, 400), (2_750_000, 300, 400), (3_250_000, 300, 500),
    ]  # fmt: skip


def test_a_robot_wanders_in_its_area_whichever_corners_are_given():
    there = walked(random=True, area=(9.0, 8.0, 1.0, 2.0), speed_mps=1.0)
    assert there == walked(random=True, area=(1.0, 2.0, 9.0, 8.0), speed_mps=1.0)
    assert all(100 <= x <= 900 and 200 <= y <= 800 for _, x, y in there)
    assert there[-2][0] < 10_000_000 <= there[-1][0]
    assert all(a[1:] != b[1:] for a, b in itertools.pairwise(there))


def test_a_robot_without_a_place_is_refused():
    with pytest.raises(ScenarioError, match="robot r has no position"):
        walked(area=(0.0, 0.0, 1.0, 1.0))
    assert walked(points=[(5, 6)]) == [(0, 5, 6)]
    with pytest.raises(ScenarioError, match="changes its way more than 100,000 times"):
        walked(random=True, area=(0.0, 0.0, 0.01, 0.01), speed_mps=100.0)


@pytest.mark.parametrize(("name", "value", "says"), [
    ("mtu", 1201, "mtu:protocol.mtu is out of range; it can be 64 to 1200 bytes"),
    ("e2e_tries", 16, "e2e_tries:protocol.e2e_tries is out of range; it can be 0 to 15 tries"),
    ("jitter_us", -1, "jitter_s:protocol.jitter_s is out of range; it can be 0 to 16777215 us"),
    ("job_us", 0, "table_retry_s:protocol.table_retry_s is out of range; it can be 1 to 67108863 "),
    ("job_tries", 16, "table_tries:protocol.table_tries is out of range; it can be 0 to 15 tries"),
    ("faint", 128, "min_rssi_dbm:protocol.min_rssi_dbm is out of range; it can be -128 to 127 dBm"),
    ("tick_us", 999, "beacon_s:protocol.beacon_s is out of range; it can be 1000 to 16777215 us"),
    ("period", 0, "period_s:protocol.period_s is out of range; it can be at most 32767.5 s at this "
     "protocol.beacon_s"),
    ("dead_step", -1, "dead_step_s:protocol.dead_step_s is out of range; it can be at most 32767.5 "
     "s at this protocol.beacon_s"),
    ("forget", 256, "forget_s:protocol.forget_s is out of range; it can be at most 127.5 s at this "
     "protocol.beacon_s"),
    ("period_max", 9, "period_max_s:protocol.period_max_s is below period_s; make it as long or "
     "longer"),
    ("period_max", 10, ""), ("collect_us", 1_000_001, ""),
    ("collect_us", 1_000_000, "collect_s:protocol.collect_s must be more than listen_s, 1 s: "
     "before that nobody responds"),
])  # fmt: skip
def test_what_is_out_of_range_is_told_by_the_key_that_a_scenario_has(name, value, says):
    fine = {one: low for one, _, low, *_ in params.fields.PARAMS} | {
        "tick_us": 500_000, "period": 10, "period_max": 20, "listen_us": 1_000_000,
        "collect_us": 2_000_000,
    }  # fmt: skip
    params._check(fine)
    with pytest.raises(ValueError, match=re.escape(says)) if says else nullcontext():
        params._check(fine | {name: value})
    alone = fine | {"collect_us": 1_000_000, "discovery": params.w.EACH}
    params._check(alone)  # who answers at once has nothing to collect
