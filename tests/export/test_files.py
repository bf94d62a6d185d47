"""Recordings, graphs and tables are read back by the tools' own libraries."""

import json
import os
from collections import Counter
from itertools import pairwise

import jsonschema
import networkx as nx
import polars
import pytest
from mcap.reader import make_reader

from innervate import run, scenario
from innervate.export import files, graphs, recording, schemas, tables
from innervate.export.errors import ExportError
from innervate.network import networks
from tests.export.test_captures import MESH, RADIO, SKIN, plan_of

FENCED = MESH | {
    "placement": {"layout": "grid", "spacing_m": 10.0},
    "robot": [{"node": 8, "waypoints": [[20.0, 20.0], [60.0, 20.0]], "speed_mps": 4.0}],
    "fence": {"polygon": [[-5, -5], [45, -5], [45, 45], [-5, 45]]},
    "event": [{"at_s": 9.0, "action": "kill", "node": 4}],
}
TOUCHED = SKIN | {"touch": {"path": [[0.0, 0.0, 0.0], [0.1, 40.0, 30.0]], "radius_mm": 25}}
KINDS = {"skin": TOUCHED, "mesh": FENCED, "radio": RADIO}


@pytest.fixture(scope="module")
def runs():
    return {kind: run(keys) for kind, keys in KINDS.items()}


def read(path):
    """Messages by topic, each valid by its schema: (time ns, content)."""
    found, checks = {}, {}
    with path.open("rb") as file:
        for schema, channel, message in make_reader(file).iter_messages():
            if schema.id not in checks:
                told = json.loads(schema.data)
                jsonschema.Draft202012Validator.check_schema(told)
                assert told["title"] == schema.name
                checks[schema.id] = jsonschema.Draft202012Validator(told)
            content = json.loads(message.data)
            checks[schema.id].validate(content)
            stamp = content.get("timestamp")
            if stamp is not None:
                assert stamp["sec"] * 10**9 + stamp["nsec"] == message.log_time
            found.setdefault(channel.topic, []).append((message.log_time, content))
    return found


def plain(schema):
    """Every part has one type, and lists say what is in them: Foxglove reads no others."""
    assert isinstance(schema["type"], str)
    if schema["type"] == "array":
        plain(schema["items"])
    for part in schema.get("properties", {}).values():
        plain(part)


def test_schemas_are_of_the_plain_kind():
    tables = [table for network in networks().values() for table in network.tables]
    others = (schemas.SCENE, schemas.CELLS, schemas.TOUCH, schemas.ROBOT, schemas.LOG)
    for schema in (*others, *map(schemas.of_table, tables)):
        plain(schema)


@pytest.mark.parametrize("kind", KINDS)
def test_recordings_hold_every_row_and_fit_their_schemas(kind, runs, tmp_path):
    done = runs[kind]
    frames = {name: table.collect() for name, table in done.tables.items()}
    count = recording.write(done.plan, frames, tmp_path / "run.mcap")
    found = read(tmp_path / "run.mcap")
    assert sum(map(len, found.values())) == count
    topics = {table.name: table.topic for table in networks()[kind].tables}
    for name, frame in frames.items():
        topic = topics[name] or f"/{name}"
        rows = [{k: v for k, v in one.items() if k != "timestamp"}
                for _, one in found.get(topic, [])]  # fmt: skip
        moment = next(column for column in frame.columns if column.endswith("_us"))
        assert rows == [{k: v for k, v in row.items() if v is not None}
                        for row in frame.sort(moment, maintain_order=True).to_dicts()]  # fmt: skip
    expected = {"skin": {"/cells", "/touch", "/scene", "/routes", "/samples", "/log"},
                "mesh": {"/scene", "/robots", "/alarms", "/messages", "/log", "/transmissions"},
                "radio": {"/packets", "/transmissions", "/reports"}}[kind]  # fmt: skip
    assert expected - {"/messages"} <= set(found)


def test_alarms_of_a_recorded_mesh_are_the_robots_that_left_the_fence():
    """As docs/export.md has it; what nodes gave to their users has the name of its table."""
    topics = {table.name: table.topic or f"/{table.name}" for table in networks()["mesh"].tables}
    assert topics["crossings"] == "/alarms"
    assert topics["deliveries"] == "/deliveries"


def test_a_recording_tells_the_states_of_a_skin(runs, tmp_path):
    done = runs["skin"]
    frames = {name: table.collect() for name, table in done.tables.items()}
    recording.write(done.plan, frames, tmp_path / "run.mcap")
    found = read(tmp_path / "run.mcap")
    at, last = found["/cells"][-1]
    assert at == done.plan.duration_us * 1000
    parents = dict(frames["routes"].select("cell", "new").iter_rows())
    assert last["parent_port"] == [parents.get(cell, -1) for cell in range(done.plan.graph.cells)]
    for name in ("unrouted", "cut_off"):
        assert last[name] == frames["outages"][name][-1]
    assert sum(hops < 0 for hops in last["hops"]) <= last["unrouted"] + 1  # a dead cell, too
    assert max(max(one["force_mn"]) for _, one in found["/touch"]) > 0
    cells = next(one for one in found["/scene"][0][1]["entities"] if one["id"] == "cells")
    assert len(cells["spheres"]) == done.plan.graph.cells
    told = [one["message"] for _, one in found["/log"]]
    assert told[0].startswith("cut")
    assert Counter(one["level"] for _, one in found["/log"]) == {3: 2}


def test_what_does_harm_is_a_warning_in_a_recording_and_what_mends_is_information():
    """By the numbers of Foxglove's log: 2 and 3."""
    events = [{"at_s": at, "interface": 1, "action": what}
              for at, what in ((0.04, "cut"), (0.06, "restore"))]  # fmt: skip
    found = recording.events(plan_of(SKIN | {"event": events}))
    assert [told["level"] for _, told in found] == [3, 2]


def test_a_recording_tells_where_robots_are(runs, tmp_path):
    done = runs["mesh"]
    recording.write(done.plan, {}, tmp_path / "run.mcap")
    found = read(tmp_path / "run.mcap")
    places = [(one["x_m"], one["y_m"]) for _, one in found["/robots"]]
    assert {one["node"] for _, one in found["/robots"]} == {8}
    assert places[0] == (20, 20)
    assert places[-1] == (60, 20)
    assert max(b - a for (a, _), (b, _) in pairwise(places)) == pytest.approx(0.4)  # 4 m/s
    ground = found["/scene"][0][1]["entities"][0]
    assert ground["id"] == "field"
    assert any(line["type"] == 1 and len(line["points"]) == 4 for line in ground["lines"])


def same(a, b):
    """Two graphs have the same nodes, links and attributes."""

    def ends(graph, pair):
        return pair if graph.is_directed() else tuple(sorted(pair))

    def edges(graph):
        found = graph.edges(data=True)
        return sorted((*ends(graph, (u, v)), sorted(of.items())) for u, v, of in found)

    assert dict(a.nodes(data=True)) == dict(b.nodes(data=True))
    assert edges(a) == edges(b)
    assert a.is_directed() == b.is_directed()
    return True


@pytest.mark.parametrize("kind", KINDS)
def test_networkx_reads_both_forms_of_a_graph_the_same(kind, tmp_path):
    plan = scenario.plan(scenario.from_dict(KINDS[kind]))
    graphs.write(plan, tmp_path / "g.graphml")
    graphs.write(plan, tmp_path / "g.json")
    a = nx.read_graphml(tmp_path / "g.graphml", force_multigraph=True)
    content = json.loads((tmp_path / "g.json").read_text())
    b = nx.node_link_graph(content, edges="edges")
    assert same(a, b)
    if kind == "skin":
        pc = plan.graph.label(plan.graph.sink)
        hops = nx.single_source_shortest_path_length(a, pc)
        assert hops == {name: of["hops"] for name, of in a.nodes(data=True)}
        assert a.number_of_edges() == sum(1 for _ in plan.graph.links())
    if kind == "mesh":
        good = {(u, v) for u, v, of in a.edges(data=True) if of["good"]}
        names = plan.names
        assert good == {pair for x, y in plan.good
                        for pair in ((names[x], names[y]), (names[y], names[x]))}  # fmt: skip


def test_a_graph_of_another_form_is_told(tmp_path):
    plan = scenario.plan(scenario.from_dict(SKIN))
    with pytest.raises(ExportError, match="graphml"):
        graphs.write(plan, tmp_path / "g.dot")


@pytest.mark.parametrize("csv", [False, True])
def test_tables_are_the_runs(csv, runs, tmp_path):
    done = runs["skin"]
    files = tables.write(done.tables, tmp_path / "some" / "folder", csv)
    assert sorted(path.stem for path in files) == sorted(done.tables)
    for path in files:
        own = done.tables[path.stem].collect()
        if csv:
            assert polars.read_csv(path, schema=own.schema).equals(own)
        else:
            assert polars.read_parquet(path).equals(own)


def test_a_folder_is_made_with_those_above_it_or_it_is_said_why_not(tmp_path):
    for _ in range(2):
        files.make_folder(tmp_path / "a" / "b")
    assert (tmp_path / "a" / "b").is_dir()
    (tmp_path / "c").write_text("")
    with pytest.raises(ExportError, match="d cannot be written: Not a directory; choose another"):
        files.make_folder(tmp_path / "c" / "d")


@pytest.mark.parametrize("umask", [0o022, 0o027, 0o077])
def test_a_file_may_be_read_by_those_who_may_read_any_new_one(umask, tmp_path):
    before = os.umask(umask)
    try:
        files.write_text(tmp_path / "a", "text")
    finally:
        assert os.umask(before) == umask  # as it was
    assert (tmp_path / "a").stat().st_mode & 0o777 == 0o666 & ~umask
    assert [one.name for one in tmp_path.iterdir()] == ["a"]
