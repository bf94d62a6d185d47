"""Recordings for Rerun are read back by its own library and hold what the run's tables say."""

import subprocess
import sys
from collections import Counter
from importlib.util import find_spec

import numpy as np
import pytest

from innervate import run, scenario
from innervate.export import rrd
from innervate.export.errors import ExportError
from innervate.export.rrd_parts import ALARM, GREY, PORTS
from innervate.networks.skin.export.rrd import LIFTED_M, OFF, RADIUS_M, WITHOUT_ROUTE
from innervate.scenario.robots import position_cm
from innervate.topology import cells_from_urdf, normals_from_urdf
from tests.export.test_captures import RADIO
from tests.export.test_files import FENCED

if find_spec("rerun") is None:  # to import it takes a while, in every process that collects tests
    pytest.skip("rerun-sdk is missing", allow_module_level=True)
URDF = """<robot name="bar">
<link name="base"><visual><geometry><box size="0.02 0.02 0.3"/></geometry></visual></link>
{links}</robot>"""
LINK = """<link name="cell_{i}"/>
<joint name="j{i}" type="fixed"><parent link="base"/><child link="cell_{i}"/>
<origin xyz="0.01 0 {z}" rpy="0 1.5707963267948966 0"/></joint>
"""
CELLS, APART_M = 6, 0.02
SKIN = {
    "kind": "skin", "duration_s": 0.5, "seed": 3,
    "body": {"links": "cell_*", "reach_mm": 30, "interfaces": ["cell_0", "cell_5"]},
    "protocol": {"k": 3}, "data": {"rate_hz": 200},
    "touch": {"path": [[0.0, 0.0, 0.0], [0.5, 0.0, 50.0]], "radius_mm": 25},
    "event": [{"at_s": 0.2, "action": "cut", "link": ["cell_1", "cell_2"]},
              {"at_s": 0.3, "action": "kill", "node": "cell_4"}],
}  # fmt: skip


def written(done, path):
    """Values by entity and component: (time us or None, value), in order of time."""
    frames = {name: table.collect() for name, table in done.tables.items()}
    count = rrd.write(done.plan, frames, path)
    found, rows = {}, 0
    from rerun.chunk import RrdReader

    for part in RrdReader(path).stream():
        assert part.is_static or part.timeline_names == [rrd.TIMELINE]
        rows += 0 if part.is_static else part.num_rows
        for row in part.to_record_batch().to_pylist():
            at = row.get(rrd.TIMELINE)
            moment = None if at is None else round(at.total_seconds() * 1e6)
            for name, value in row.items():
                if value is not None and ":" in name:
                    found.setdefault((part.entity_path, name), []).append((moment, value))
    assert rows == count
    return {key: sorted(of, key=lambda one: one[0] or 0) for key, of in found.items()}


@pytest.fixture(scope="module")
def skin(tmp_path_factory):
    """A run of six cells in a row on a bar, and what was read of its recording."""
    folder = tmp_path_factory.mktemp("rerun")
    links = "".join(LINK.format(i=i, z=APART_M * i) for i in range(CELLS))
    (folder / "bar.urdf").write_text(URDF.format(links=links))
    done = run(SKIN | {"body": SKIN["body"] | {"urdf": str(folder / "bar.urdf")}})
    return done, written(done, folder / "run.rrd")


@pytest.fixture(scope="module")
def mesh(tmp_path_factory):
    done = run(FENCED)
    return done, written(done, tmp_path_factory.mktemp("rerun") / "run.rrd")


def only(found, *key):
    """What is said once and for all."""
    ((moment, value),) = found[key]
    assert moment is None
    return value


def shown(found, moment_us, *key):
    """What the viewer shows at a moment: the newest row up to it, in colours as (r, g, b)."""
    value = [one for when, one in found[key] if when <= moment_us][-1]
    if key[1].endswith("colors"):
        return [(one >> 24, one >> 16 & 255, one >> 8 & 255) for one in value]
    return value


def test_cells_lie_where_the_robots_description_has_them_and_face_outwards(skin):
    done, found = skin
    places = np.array(done.plan.graph.positions).reshape(-1, 3) / 1000
    assert places[:, 2] == pytest.approx(APART_M * np.arange(CELLS))
    for view in ("state", "load", "touch"):
        assert np.array(only(found, f"/skin/{view}", "Points3D:positions")) == pytest.approx(places)
        names = only(found, f"/skin/{view}", "Points3D:labels")
        assert names == [f"cell_{i}" for i in range(CELLS)]
    arrows = np.array(only(found, "/skin/normals", "Arrows3D:vectors"))
    assert arrows == pytest.approx(np.array([[0.02, 0, 0]] * CELLS), abs=1e-6)
    bar = np.array(only(found, "/robot/shape_0", "Mesh3D:vertex_positions"))
    assert bar.max(axis=0) == pytest.approx([0.01, 0.01, 0.15])


def test_colours_and_sizes_tell_through_which_port_a_cell_sends(skin):
    _, found = skin
    state = ("/skin/state", "Points3D:colors")
    assert set(shown(found, 190_000, *state)) == {PORTS[0], PORTS[1]}
    # The cut leaves two cells at port 0; the dead one takes those behind it along.
    assert shown(found, 490_000, *state) == [*[PORTS[0]] * 2, *[ALARM] * 2, GREY, PORTS[1]]
    sizes = np.array(shown(found, 490_000, "/skin/state", "Points3D:radii")) / RADIUS_M
    assert sizes == pytest.approx([1, 1, WITHOUT_ROUTE, WITHOUT_ROUTE, OFF, 1])


def test_lines_lead_to_the_parents_that_the_table_of_routes_has(skin):
    done, found = skin
    graph = done.plan.graph
    routes = done.tables["routes"].collect().select("time_us", "cell", "new").rows()
    rows = found["/skin/parents", "LineStrips3D:strips"]
    assert len(rows) >= 3
    for moment, strips in rows:
        parent = {cell: port for when, cell, port in routes if when < moment}
        ends = [(cell, graph.node_of(graph.peer[graph.end(cell, port)]))
                for cell, port in sorted(parent.items()) if port >= 0]  # fmt: skip
        told = [tuple(round(z / APART_M) for _, _, z in strip) for strip in strips]
        assert told == [pair for pair in ends if pair[1] < graph.sink]
        lifted = {round(x, 6) for strip in strips for x, _, _ in strip}
        assert lifted <= {round(0.01 + LIFTED_M, 6)}  # in front of the bar
    ((when, cut),) = found["/skin/cuts", "LineStrips3D:strips"]
    assert when == 200_000
    assert [[round(z / APART_M) for _, _, z in strip] for strip in cut] == [[1, 2]]


def test_curves_and_the_touch_are_the_tables(skin):
    done, found = skin
    outages = done.tables["outages"].collect().select("time_us", "unrouted").rows()
    told = [(when, *value) for when, value in found["/unrouted", "Scalars:scalars"]]
    assert told[: len(outages)] == [*dict(outages).items()]
    assert told[-1] == (done.plan.duration_us, outages[-1][1])
    touched = found["/skin/touch", "Points3D:colors"]
    last = np.array(shown(found, 100_000, "/skin/touch", "Points3D:colors")).sum(axis=1)
    assert len(touched) > 5
    assert last.argmin() in (0, 1)  # the finger is there: the darkest


def test_a_mesh_shows_its_robot_its_dead_and_its_alarms(mesh):
    done, found = mesh
    (walk,) = done.plan.walks
    rows = found["/robots/n8", "Points3D:positions"]
    assert len(rows) == done.plan.duration_us // 100_000 + 1
    for moment, ((x, y, z),) in rows:
        there = position_cm(walk, moment)
        assert (x, y, z) == pytest.approx((there[0] / 100, there[1] / 100, 0), abs=1e-4)
    names = only(found, "/field/nodes", "Points3D:labels")
    assert Counter(names) == Counter(set(done.plan.names) - {"n8"})
    colours = shown(found, 9_500_000, "/field/nodes", "Points3D:colors")
    assert [name for name, one in zip(names, colours, strict=True) if one == GREY] == ["n4"]
    out = done.tables["crossings"].collect().row(0, named=True)
    assert shown(found, out["crossed_us"] - 1, "/robots/n8", "Points3D:colors") != [ALARM]
    assert shown(found, out["crossed_us"] + 100_000, "/robots/n8", "Points3D:colors") == [ALARM]
    told = {text: when for when, (text,) in found["/events", "TextLog:text"]}
    assert told["n8 left the fence"] == out["crossed_us"]
    assert told["kill n4"] == 9_000_000
    assert len(only(found, "/field/links", "LineStrips3D:strips")) == sum(
        8 not in pair for pair in done.plan.good
    )


LINKS = {"kind": "mesh", "duration_s": 1, "link": [{"a": "x", "b": "y"}]}


def test_what_has_no_places_is_refused(tmp_path):
    plan = scenario.plan(scenario.from_dict(LINKS))
    with pytest.raises(ExportError, match="no view in space of this mesh;"):
        rrd.write(plan, {}, tmp_path / "no.rrd")
    assert not list(tmp_path.iterdir())


NEWS = [{"at_s": 0.1, "every_s": 0.2, "node": 0, "item": {"dest": 2, "body": [7] * 8}}]
FLOODING = {
    "kind": "flooding", "nodes": 4, "duration_s": 1.0, "layout": "line", "spacing_m": 20.0,
    "absent": [2], "input": NEWS, "robot": [{"node": 1, "waypoints": [[20, 0], [20, 10]]}],
    "event": [{"at_s": 0.2, "action": "cut", "node": 3, "other": 2},
              {"at_s": 0.3, "action": "revive", "node": 2},
              {"at_s": 0.4, "action": "kill", "node": 3},
              {"at_s": 0.6, "action": "restore", "node": 2, "other": 3}],
}  # fmt: skip


def test_a_network_of_ones_own_over_a_field_shows_nodes_cuts_robots_and_deliveries(tmp_path):
    done = run(FLOODING, plain=True)
    found = written(done, tmp_path / "run.rrd")
    nodes = ("/network/nodes", "Points3D:positions")
    assert np.array(only(found, *nodes)).tolist() == [[0, 0, 0], [40, 0, 0], [60, 0, 0]]
    colours = ("/network/nodes", "Points3D:colors")
    assert [one == GREY for one in shown(found, 0, *colours)] == [False, True, False]
    assert [one == GREY for one in shown(found, 500_000, *colours)] == [False, False, True]
    way = dict(found["/robots/node\\ 1", "Points3D:positions"])
    assert way[500_000][0] == pytest.approx([20, 0.5, 0])
    cuts = ("/network/cuts", "LineStrips3D:strips")
    assert [place[0] for place in shown(found, 300_000, *cuts)[0]] == [40, 60]
    assert not shown(found, 600_000, *cuts)
    (strip,) = only(found, "/network/links", "LineStrips3D:strips")
    assert [place[0] for place in strip] == [40, 60]  # without the robot's, which change
    deliveries = done.tables["deliveries"].collect()
    assert found["/delivered", "Scalars:scalars"][-1][1] == [len(deliveries)] != [0]


CABLED = {
    "kind": "babel", "nodes": 6, "shape": "line", "duration_s": 0.5,
    "event": [{"at_s": 0.2, "action": "cut", "link": "n0-n1"},
              {"at_s": 0.3, "action": "kill", "node": 4}],
}  # fmt: skip


@pytest.mark.parametrize("keys", [CABLED, RADIO])
def test_where_nobody_says_where_nodes_lie_their_links_do(keys, tmp_path):
    done = run(keys, plain=True)
    found = written(done, tmp_path / "run.rrd")
    places = np.array(only(found, "/network/nodes", "Points3D:positions"))
    far = np.linalg.norm(places[:, None] - places, axis=2) + 9 * np.eye(len(places))
    assert far.min() > 0.1  # no two on one place
    if keys is CABLED:
        assert np.diagonal(far, 1) == pytest.approx(1, abs=0.35)
        ((at_us, ((a, b),)),) = found["/network/cuts", "LineStrips3D:strips"]
        assert at_us == 200_000
        assert np.array([a, b]) == pytest.approx(places[:2])
        colours = shown(found, 400_000, "/network/nodes", "Points3D:colors")
        assert [one == GREY for one in colours] == [False] * 4 + [True, False]


def test_without_the_package_one_line_says_what_to_install(tmp_path):
    code = (
        "import sys; sys.modules['rerun'] = None; from innervate.cli import main; sys.exit(main())"
    )
    args = ["export", "setup-1", "--rerun", str(tmp_path / "run.rrd")]
    done = subprocess.run(
        [sys.executable, "-c", code, *args],
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert done.returncode == 2
    assert done.stderr.count("\n") == 1
    assert "pip install 'innervate[rerun]'" in done.stderr
    assert not list(tmp_path.iterdir())


def test_cells_put_on_a_surface_face_away_from_it(tmp_path):
    (tmp_path / "bar.urdf").write_text(URDF.format(links=""))
    wanted = (str(tmp_path / "bar.urdf"), "base", None, 15.0)
    _, places = cells_from_urdf(*wanted)
    normals = normals_from_urdf(*wanted)
    assert len(places) == len(normals) > 10
    half = np.array([10, 10, 150])
    for place, normal in zip(np.array(places), normals, strict=True):
        side = np.abs(np.abs(place) - half).argmin()  # the side of the box that it lies on
        assert normal[side] == pytest.approx(np.sign(place[side]))
