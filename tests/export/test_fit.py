"""What is simulated, captured, fitted and simulated again is the same network."""

import asyncio
import json
import tomllib
from types import SimpleNamespace as Of

import pytest

from innervate import scenario
from innervate.cli import app, capturing
from innervate.export import capture, fitting, measure, pcapng
from innervate.export.errors import ExportError
from innervate.export.measure import Way
from innervate.live import status, tap
from innervate.networks.mesh.export import statuslog
from tests.live.net import Mesh, until
from tests.networks.skin.runs import patch

RING = {
    "kind": "mesh",
    "duration_s": 24,
    "seed": 5,
    "node": [{"name": f"n{i}"} for i in range(5)],
    "gateway": "n1",
    "radio": {"profile": "250k"},
    "link": [{"a": i, "b": (i + 1) % 5, "quality": quality}
             for i, quality in enumerate([1.0, [0.9, 0.7], 0.95, [0.6, 1.0], 0.8])],
    "flow": [{"from": i, "to": (i + 2) % 5, "every_s": 0.5, "bytes": 12} for i in range(5)],
}  # fmt: skip
QUALITY = {(i, (i + 1) % 5): there for i, there in enumerate([1.0, 0.9, 0.95, 0.6, 0.8])} | {
    ((i + 1) % 5, i): back for i, back in enumerate([1.0, 0.7, 0.95, 1.0, 0.8])
}
SKIN = patch(
    3, 3, (0, 0), (2, 2),
    duration_s=2.0, seed=4, data={"rate_hz": 100},
    timing={"hop_latency_us": [90, 140], "loss": 0.01},
    event=[{"at_s": 0.0, "action": "loose", "loss": 0.3,
            "cell": {"patch": 0, "row": 1, "column": 1}, "port": "E"}],
)  # fmt: skip


def captured(keys, path):
    capture.write(scenario.plan(scenario.from_dict(keys)), path)
    return measure.measure(path)


def test_a_mesh_comes_back_with_its_links_and_their_quality(tmp_path):
    found = captured(RING, tmp_path / "ring.pcapng")
    assert set(found.ways) == set(QUALITY)
    for key, quality in QUALITY.items():
        way = found.ways[key]
        spread = (quality * (1 - quality) / (way.got + way.lost)) ** 0.5
        assert way.quality == pytest.approx(quality, abs=4 * spread + 1e-9), key
    assert found.gateway == 1
    assert {(flow.origin, flow.dest) for flow in found.flows} == {(i, (i + 2) % 5)
                                                                 for i in range(5)}  # fmt: skip
    text = fitting.scenario_of(found, "ring")
    model = scenario.loads(text).model
    assert model.radio.profile == "250k"
    assert all(flow.every_s == pytest.approx(0.5, rel=0.05) for flow in model.flow)
    lines, same = fitting.check(text, found)
    assert same, lines
    [apart] = [line for line in lines if line.startswith("quality")]
    assert float(apart.split()[-3]) < 0.1, apart


def test_ways_that_only_one_side_has_are_named_or_counted(tmp_path):
    found = captured(RING | {"duration_s": 8}, tmp_path / "ring.pcapng")
    text = fitting.scenario_of(found, "ring")
    ways = [(a, b) for a in range(5) for b in range(5) if (a - b) % 5 in (2, 3)]
    found.ways[ways[0]] = Way(got=1, lost=10)  # 9.1 %
    found.ways[ways[1]] = Way(got=1, lost=9)  # 10 %
    del found.ways[1, 2]
    lines, same = fitting.check(text, found)
    assert not same
    assert lines[1:4] == [
        "  captured only: n0 to n3", "  simulated only: n1 to n2",
        "  not named, as less than 10 % of their frames came in: 1 captured only, 0 simulated only",
    ]  # fmt: skip
    found.ways.update((way, Way(got=1)) for way in ways)
    lines, _ = fitting.check(text, found)
    assert lines[1].endswith("n3 to n1 and 2 more")
    assert not any("not named" in line for line in lines)


def test_a_skin_comes_back_with_its_cables_latency_and_loss(tmp_path):
    found = captured(SKIN, tmp_path / "skin.pcapng")
    plan = scenario.plan(scenario.from_dict(SKIN))
    assert len(found.ways) == 2 * sum(1 for _ in plan.graph.links())
    text = fitting.scenario_of(found, "skin")
    tables = tomllib.loads(text)
    assert tables["timing"]["loss"] == pytest.approx(0.01, abs=0.005)
    low, high = tables["timing"]["hop_latency_us"]
    assert 90 <= low < high <= 140
    [event] = tables["event"]
    assert (event["action"], event["at_s"], sorted(event["link"])) == ("loose", 0.0, ["c4", "c5"])
    assert event["loss"] == pytest.approx(0.3, abs=0.05)
    assert tables["protocol"]["beacon_hz"] == 250
    assert tables["data"]["rate_hz"] == pytest.approx(100, abs=3)
    lines, same = fitting.check(text, found)
    assert same, lines
    [apart] = [line for line in lines if line.startswith("quality")]
    assert float(apart.split()[-3]) < 0.1, apart


def test_live_nodes_come_back_as_a_mesh(tmp_path):
    async def main():
        async with Mesh(3, [(0, 1), (1, 2)]) as net:
            servers = []
            for node in net.nodes:

                def handle(_request, writer, node=node):
                    return tap.serve(node, writer)

                servers.append(status.Server(tmp_path / f"{node.name}.sock", handle))
                await servers[-1].start()
            with (tmp_path / "live.pcapng").open("wb") as file:
                recorder = capturing.Recorder([server.path for server in servers], file)
                running = asyncio.create_task(recorder.run(0))
                await until(lambda: all(node.taps for node in net.nodes))
                for k in range(20):
                    receipt = net.nodes[0].send_message(2, b"%d" % k)
                    assert await receipt.wait() == "delivered"
                for server in servers:
                    await server.stop()
                await running

    asyncio.run(main())
    found = measure.measure(tmp_path / "live.pcapng")
    assert set(found.ways) == {(0, 1), (1, 0), (1, 2), (2, 1)}
    assert all(way.quality == 1 for way in found.ways.values())
    text = fitting.scenario_of(found, "live")
    assert scenario.loads(text).model.radio.profile == "ip"
    _lines, same = fitting.check(text, found)
    assert same


def test_the_command_says_what_it_did(tmp_path, capsys):
    captured(SKIN | {"duration_s": 0.3}, tmp_path / "skin.pcapng")
    out = tmp_path / "fitted.toml"
    assert app.main(["fit", str(tmp_path / "skin.pcapng"), "--out", str(out)]) == 0
    said = capsys.readouterr().out
    assert f"Written: {out}" in said
    assert "a skin of 14 links" in said
    assert scenario.load(out).name == "skin"


def test_the_command_tells_programs_the_same(tmp_path, capsys):
    captured(SKIN | {"duration_s": 0.3}, tmp_path / "skin.pcapng")
    tokens = ["fit", str(tmp_path / "skin.pcapng")]
    assert app.main([*tokens]) == 0
    printed = capsys.readouterr()
    assert app.main([*tokens, "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert (told["kind"], told["links"], told["same_links"], told["file"]) == (
        "skin", 14, True, None,
    )  # fmt: skip
    assert told["scenario"] == printed.out
    assert all(f"{line}\n" in printed.err for line in told["match"])
    out = tmp_path / "fitted.toml"
    assert app.main([*tokens, "--json", "--out", str(out)]) == 0
    told = json.loads(capsys.readouterr().out)
    assert (told["file"], told["scenario"]) == (str(out), out.read_text())


def told_by(number, *near):
    neighbours = [{"node": node, "quality": quality} for node, quality in near]
    return {"kind": "mesh", "number": number, "gateway": 0, "neighbours": neighbours}


def test_what_nodes_say_of_themselves_is_fitted(tmp_path, capsys):
    path, out = tmp_path / "status.json", tmp_path / "fitted.toml"
    path.write_text(json.dumps([told_by(0, (1, 0.81)), told_by(1, (0, 0.81), (2, None))]))
    assert app.main(["fit", str(path), "--out", str(out)]) == 0
    links = scenario.load(out).model.link
    assert [(link.a, link.b, link.quality) for link in links] == [
        ("n0", "n1", (0.9, 0.9)), ("n1", "n2", (1.0, 1.0)),
    ]  # fmt: skip
    assert "1 link carried nothing" in capsys.readouterr().out


@pytest.mark.parametrize(("blank", "is_one"), [(0, True), (63, True), (64, False)])
def test_json_begins_within_the_first_bytes_of_a_file(blank, is_one, tmp_path):
    path = tmp_path / "status.json"
    path.write_text(" " * blank + "[")
    assert statuslog.looks_like_one(path) is is_one


@pytest.mark.parametrize(
    "content", ["{", "[]", "[1]", '{"kind": "skin"}', '[{"kind": "mesh"}]', "[[[]]]"]
)
def test_json_that_is_no_status_is_told_in_one_line(content, tmp_path):
    path = tmp_path / "status.json"
    path.write_text(content)
    assert statuslog.looks_like_one(path)
    with pytest.raises(ExportError, match=r"no status of mesh nodes|no node has a neighbour"):
        statuslog.measure(path)


@pytest.mark.parametrize(
    ("blocks", "why"),
    [
        ([pcapng.section()], "holds no packets"),
        ([pcapng.section(), pcapng.interface(1, "eth0"), pcapng.packet(0, 0, b"x", 0)],
         "no capture of a skin or a mesh"),
        ([pcapng.section(), pcapng.interface(149, "s"), pcapng.packet(0, 0, b"\xc5", 0)],
         "no links to fit"),
        ([pcapng.section(), pcapng.interface(147, "c"), pcapng.packet(0, 0, b"x", 2)],
         "does not say which cables"),
        ([pcapng.section(), pcapng.interface(148, "n"), pcapng.packet(0, 0, b"x", 2)],
         "does not say which node"),
        ([pcapng.section(), pcapng.interface(148, "n", "node 1"), pcapng.packet(0, 0, b"x", 2)],
         "capture more nodes"),
    ],
)  # fmt: skip
def test_what_cannot_be_fitted_is_told_in_one_line(blocks, why, tmp_path):
    path = tmp_path / "some.pcapng"
    path.write_bytes(b"".join(blocks))
    with pytest.raises(ExportError, match=why) as told:
        measure.measure(path)
    assert "\n" not in str(told.value)


@pytest.mark.parametrize(("seconds", "duration_s"), [
    (0.0, 2.0), (2.0, 2.0), (2.00049, 2.0), (3.14159, 3.142), (60.0, 60.0), (1e5, 60.0),
])  # fmt: skip
def test_a_scenario_says_what_was_measured_and_leaves_out_what_was_not(
    monkeypatch, seconds, duration_s
):
    """Zeros are numbers that were measured; it lasts as long as the capture, within bounds."""
    tables = {"gateway": 0, "share": 0.0, "link": [], "name_of": "", "radio": {}, "nodes": 3}
    fit = Of(tables_of=lambda found: tables)
    monkeypatch.setattr(fitting, "networks", lambda: {"mesh": Of(fit=fit)})
    monkeypatch.setattr(fitting.scenarios, "loads", lambda text: text)
    monkeypatch.setattr(fitting.scenarios, "plan", lambda text: None)
    found = tomllib.loads(fitting.scenario_of(Of(kind="mesh", seconds=seconds), "mine"))
    assert found == {"schema": 1, "kind": "mesh", "name": "mine", "duration_s": duration_s,
                     "seed": 1, "gateway": 0, "share": 0.0, "nodes": 3}  # fmt: skip
