"""Running nodes on a page: asked over their sockets, cut by their drivers."""

import asyncio
import re
import socket
import tempfile
import threading
from contextlib import asynccontextmanager
from pathlib import Path

import pytest

from innervate import scenario
from innervate.live import status
from innervate.live.errors import LiveError
from innervate.live.up import Processes
from innervate.web import messages
from innervate.web.errors import Refused, WatchError
from innervate.web.live import Live, find
from innervate.web.live_poll import Poller
from innervate.web.serve import serving
from tests.live.net import Mesh
from tests.web.page import Page

RING = [(0, 1), (1, 2), (2, 3), (3, 0)]


@asynccontextmanager
async def sockets_of(mesh):
    """Status sockets of nodes of this process, as `live node` has them."""
    with tempfile.TemporaryDirectory(prefix="iv") as folder:
        servers = []
        for node in mesh.nodes:

            async def answer(request, writer, node=node):
                if request["do"] == "status":
                    await writer.line(node.status())
                else:
                    node.path_at(request["port"]).cut = request["do"] == "cut"
                    await writer.line({"cut": request["do"] == "cut"})

            servers.append(status.Server(Path(folder) / f"{node.name}.sock", answer))
        for server in servers:
            await server.start()
        try:
            yield [server.path for server in servers]
        finally:
            for server in servers:
                await server.stop()


def on_a_ring(test):
    """A test that is given four nodes in a ring, their sockets, and what a page shows of them."""

    async def main():
        async with Mesh(4, RING) as mesh, sockets_of(mesh) as paths:
            source = await asyncio.to_thread(Live, paths)
            async with serving(source) as served, Page(served.address) as page:
                await test(mesh, paths, source, page)

    return lambda: asyncio.run(main())


@on_a_ring
async def test_a_mesh_is_drawn_cut_and_mended(mesh, paths, source, page):
    await page.take()
    scene = page.scene
    assert (scene["kind"], scene["source"]) == ("mesh", "live")
    assert scene["duration_s"] is None
    assert scene["can"] == ["cut", "heal", "kill", "revive"]
    assert [node["label"] for node in scene["nodes"]] == ["n0", "n1", "n2", "n3"]
    assert scene["nodes"][0]["role"] == "gateway"
    pairs = [(link["a"], link["b"]) for link in scene["links"]]
    assert pairs == sorted((min(pair), max(pair)) for pair in RING)
    await page.until(lambda: page.state.get("unconnected") == 0)
    assert page.state["parent"][0] == -1
    assert {page.state["parent"][1], page.state["parent"][3]} == {0}
    await page.give("cut", link=0)  # n0 - n1
    await page.until(lambda: page.state["link_up"] == [0, 1, 1, 1])
    here, there = mesh.cables[0, 1]
    assert here.cut
    assert there.cut
    assert "n0 - n1 cut" in page.state["recovery"]["cause"]
    cut_s = page.state["recovery"]["at_s"]
    receipt = mesh.nodes[1].send_message(0, b"find another way")
    assert await receipt.wait() == "delivered"
    await page.until(lambda: page.state["parent"][1] == 2)
    await page.until(lambda: page.state["recovery"]["recovered_ms"] is not None)
    refused = await page.ask("cut", link=0)
    assert "already" in refused["text"]
    await page.give("heal", link=0)
    await page.until(lambda: page.state["link_up"] == [1, 1, 1, 1])
    assert not here.cut
    assert page.series["frames"]
    since_s = page.state["t_s"] - page.state["since_cut_s"]
    assert since_s == pytest.approx(cut_s, abs=1e-6)  # one moment, however often told
    await page.give("kill", node=2)  # all of its paths, at its own end
    await page.until(lambda: page.state["node_up"] == [1, 1, 0, 1])
    assert [path.cut for path in mesh.nodes[2].paths] == [True, True]
    assert not any(path.cut for path in mesh.nodes[1].paths)
    assert page.state["cut_off"] == [0, 0, 1, 0]
    again = await page.ask("kill", node=2)
    assert "already" in again["text"]
    await page.give("revive", node=2)
    await page.until(lambda: page.state["node_up"] == [1, 1, 1, 1])
    assert not any(path.cut for path in mesh.nodes[2].paths)
    answer = await page.ask("seek", t_s=0)
    assert "not possible" in answer["text"]


@on_a_ring
async def test_a_node_that_stops_is_seen_and_comes_back(mesh, paths, source, page):
    await page.until(lambda: page.state.get("node_up") == [1, 1, 1, 1])
    aside = paths[2].with_suffix(".aside")
    paths[2].rename(aside)
    source._poller._lines[2].sock.shutdown(socket.SHUT_RDWR)
    await page.until(lambda: page.state["node_up"] == [1, 1, 0, 1])
    assert page.state["link_up"][1:3] != [1, 1]
    await page.until(lambda: "n2 does not answer any more" in page.text())
    aside.rename(paths[2])
    await page.until(lambda: page.state["node_up"] == [1, 1, 1, 1])
    await page.until(lambda: "n2 answers again" in page.text())


@on_a_ring
async def test_what_others_do_to_a_network_is_seen_like_what_is_clicked(mesh, paths, source, page):
    """Cables cut by hand, a node that ends, and at last all of them."""
    await page.until(lambda: page.state.get("headline", {}).get("level") == "ok")
    assert page.state["headline"]["text"] == "All 4 nodes have a way to the gateway."
    assert page.state["recovery"] is None
    for path in mesh.cables[0, 1]:
        path.cut = True
    await page.until(lambda: page.state["recovery"] is not None)
    assert page.state["recovery"]["cause"] == "link n0 - n1 cut"
    await page.until(lambda: page.state["recovery"]["recovered_ms"] is not None)
    assert page.state["since_cut_s"] is not None
    await page.until(lambda: "link n0 - n1 cut" in page.text())
    for path in mesh.cables[0, 1]:
        path.cut = False
    await page.until(lambda: "link n0 - n1 put back" in page.text())
    end(source, paths[2])
    await page.until(lambda: page.state["headline"]["level"] == "degraded")
    assert page.state["headline"]["text"] == "1 of 4 nodes is silent."
    assert page.state["headline"]["nodes"] == [2]
    cause = "n2 does not answer any more"
    await page.until(lambda: page.state["recovery"]["cause"] == cause)
    for path in (paths[0], paths[1], paths[3]):
        end(source, path)
    await page.until(lambda: page.state["headline"]["level"] == "no data")
    assert page.state["headline"]["text"] == "None of the 4 nodes answers."
    assert page.state["unconnected"] is None
    assert page.state["recovery"]["recovered_ms"] is None


def end(source, path):
    """As if the process of a socket had ended."""
    path.rename(path.with_suffix(".aside"))
    source._poller._lines[source._names.index(path.stem)].drop(gone=True)


def test_who_is_slow_once_has_not_ended(monkeypatch):
    """Node 1 gives no answer in time, once; then twice."""
    told = {
        i: {"kind": "mesh", "role": "gateway" if i == 0 else "node", "number": i, "gateway": 0,
            "onward": [0] if i else [], "paths": [], "counters": {},
            "neighbours": [{"node": 1 - i, "ports": [0], "suspect": False}]}
        for i in range(2)
    }  # fmt: skip
    answers = [told, {0: told[0]}, told, {0: told[0]}, {0: told[0]}]
    monkeypatch.setattr(Poller, "ask_all", lambda self, request: dict(answers.pop(0)))
    source = Live([Path("a"), Path("b")])
    levels = []
    while answers:
        source._poll()
        source._look()
        levels.append(source.fields()["headline"]["level"])
    assert levels == ["ok", "ok", "ok", "down"]


CELLS = {
    i: {"kind": "skin", "role": "cell", "number": i, "parent": 0, "load": 1, "counters": {},
        "ports": [{"port": 0, "path": 0}, {"port": 1, "path": 1}],
        "paths": [{"own": f"udp 127.0.0.1:{a}", "name": f"udp 127.0.0.1:{b}", "port": at,
                   "up": True, "counters": {}} for at, (a, b) in enumerate(paths)]}
    for i, paths in enumerate([[(2, 1), (3, 4)], [(4, 3), (9, 9)]])
}  # fmt: skip
LINE = CELLS | {2: {"kind": "skin", "role": "sink", "cells": [2], "counters": {},
                    "paths": CELLS[0]["paths"][:1]}}  # fmt: skip
LINE[2]["paths"] = [{**LINE[2]["paths"][0], "own": "udp 127.0.0.1:1", "name": "udp 127.0.0.1:2"}]
TWO = {
    i: {"kind": "mesh", "role": "node" if i else "gateway", "number": i, "gateway": 0,
        "onward": [0] if i else [], "paths": [], "counters": {},
        "neighbours": [{"node": j, "ports": [0], "suspect": False} for j in range(3) if j != i]}
    for i in range(3)
}  # fmt: skip


@pytest.mark.parametrize(
    ("told", "left", "nobody"),
    [(LINE, [0, 2], False), (LINE, [2], True), (LINE, [0, 1], True), (LINE, [1, 2], True),
     (TWO, [0, 1], False), (TWO, [0], True)],
)  # fmt: skip
def test_where_nobody_is_left_nothing_has_recovered(monkeypatch, told, left, nobody):
    """Of a PC with two cells in a line, or a gateway with two nodes, `left` go on answering."""
    some = {i: told[i] for i in left}
    answers = [told, some, some, some]
    monkeypatch.setattr(Poller, "ask_all", lambda self, request: dict(answers.pop(0)))
    source = Live([Path("a"), Path("b"), Path("c")])
    while answers:
        source._poll()
        source._look()
    shown = source.fields()["recovery"]
    assert shown["nobody"] == nobody
    assert shown["recovered_ms"] == (None if nobody else 0.0)
    said = [one.what["text"] for one in source.history.after("log", 0, source.history.newest, 99)]
    kept = [text for text in said if "kept its way" in text]
    assert kept == ([] if nobody else ["every node that answers kept its way, as they say"])
    assert (source.fields()["headline"]["level"] == "degraded") != nobody


def test_who_had_no_way_while_the_pc_was_gone_has_not_kept_it(monkeypatch):
    """It answers again when everybody has found it already."""
    cells = {i: LINE[i] for i in (0, 1)}
    answers = [LINE, cells, cells, cells, LINE]
    monkeypatch.setattr(Poller, "ask_all", lambda self, request: dict(answers.pop(0)))
    source = Live([Path("a"), Path("b"), Path("c")])
    while answers:
        source._poll()
        source._look()
    said = [one.what["text"] for one in source.history.after("log", 0, source.history.newest, 99)]
    assert re.fullmatch("every node has a way again after .* ms, as they say", said[-1])
    assert source.fields()["recovery"]["recovered_ms"] > 0


def with_processes(plan, cables, do):
    """Have `do(network, page)` happen to a network of processes that a page looks at."""

    async def main(folder):
        network = Processes(plan, folder, cables)
        try:
            await network.up()
            paths = [network.socket(name) for name in network.names]
            source = await asyncio.to_thread(Live, paths)
            async with serving(source) as served, Page(served.address) as page:
                await do(network, page)
        finally:
            await network.down()

    with tempfile.TemporaryDirectory(prefix="iv") as folder:
        asyncio.run(main(Path(folder)))


@pytest.mark.slow
@pytest.mark.parametrize("cables", ["udp", "pty"])
def test_a_skin_of_processes_is_drawn_with_its_tree(cables):
    plan = scenario.plan(scenario.load("loop-three", ["protocol.rule=feasible"]))

    async def look(_network, page):
        await page.until(lambda: page.state.get("unconnected") == 0)
        cells = plan.graph.cells
        roles = [node["role"] for node in page.scene["nodes"]]
        assert roles == ["cell"] * cells + ["port"] * plan.graph.interfaces
        assert len(page.scene["links"]) == len(list(plan.graph.links()))
        used = page.state["parent"][0]
        link = next(link["id"] for link in page.scene["links"]
                    if {link["a"], link["b"]} == {0, used})  # fmt: skip
        await page.give("cut", link=link)
        await page.until(lambda: page.state["link_up"][link] == 0)
        await page.give("heal", link=link)
        await page.until(lambda: page.state["link_up"][link] == 1)
        await page.until(lambda: page.state["unconnected"] == 0)

    with_processes(plan, cables, look)


def sent(path):
    """Send a packet, and wait until it is delivered."""
    lines = status.ask(path, {"do": "send", "payload": "00"})
    return next(line for line in lines if line["state"] == "delivered")


@pytest.mark.slow
def test_a_station_of_processes_is_cut_off_and_let_back():
    team = {"kind": "radio", "duration_s": 60, "stations": 4, "traffic": {"kind": "disaster"}}

    async def look(network, page):
        await page.until(lambda: page.state.get("node_up") == [1, 1, 1, 1])
        assert page.scene["can"] == ["kill", "revive"]
        await page.give("kill", node=1)
        await page.until(lambda: page.state["node_up"] == [1, 0, 1, 1])
        assert page.state["unconnected"] == 1
        said = asyncio.create_task(asyncio.to_thread(sent, network.socket("s1")))
        await page.until(lambda: page.state["radio"]["now"][1] in (1, 4))  # it tries
        done, _ = await asyncio.wait([said], timeout=3)
        assert not done  # and reaches nobody
        await page.give("revive", node=1)
        await page.until(lambda: page.state["node_up"] == [1, 1, 1, 1])
        await asyncio.wait_for(said, 30)
        await network.end_node("s3", gently=False)
        await page.until(lambda: page.state["node_up"] == [1, 1, 1, 0])
        assert page.state["cut_off"] == [0, 0, 0, 0]
        refused = await page.ask("revive", node=3)
        assert "does not answer" in refused["text"]
        await network.begin_node("s3")
        await page.until(lambda: page.state["node_up"] == [1, 1, 1, 1])

    with_processes(scenario.plan(scenario.from_dict(team)), "udp", look)


@pytest.mark.slow
def test_a_mesh_of_processes_loses_a_node_and_has_it_again():
    """SIGKILL, and the same node started once more."""
    plan = scenario.plan(
        scenario.from_dict(
            {
                "kind": "mesh", "duration_s": 60, "radio": {"profile": "ip"},
                "link": [{"a": f"n{a}", "b": f"n{b}"} for a, b in RING],
            }
        )
    )  # fmt: skip

    async def look(network, page):
        await page.until(lambda: page.scenes and len(page.scene["links"]) == len(RING))
        # Who was there late for a round hears the gateway in the next, and goes by n2 so long.
        await page.until(lambda: page.state.get("parent", [-1])[1::2] == [0, 0])
        await page.until(lambda: page.state.get("unconnected") == 0)
        links = page.scene["links"]
        await network.end_node("n2", gently=False)
        await page.until(lambda: page.state.get("node_up") == [1, 1, 0, 1])
        await page.until(lambda: "n2 does not answer any more" in page.text())
        await page.until(lambda: "unconnected" in page.state)  # a scene that is new comes before it
        assert page.state["unconnected"] == 0
        await network.begin_node("n2")
        await page.until(lambda: page.state.get("node_up") == [1, 1, 1, 1])
        await page.until(
            lambda: page.state.get("parent", [0] * 3)[2] in (1, 3) and not page.state["unconnected"]
        )
        await page.until(lambda: page.scene["links"] == links)

    with_processes(plan, "udp", look)


def test_a_poller_waits_for_nobody(tmp_path):
    """One that answers, one that is silent, one that talks rubbish, one that is not there."""
    kinds = {"good": b'{"kind": "mesh"}\n', "silent": b"", "rubbish": b"\xff[\n"}
    paths = []
    for name, says in kinds.items():
        server = socket.socket(socket.AF_UNIX)
        server.bind(str(tmp_path / name))
        server.listen()
        paths.append(tmp_path / name)

        def answer(server=server, says=says):
            link, _ = server.accept()
            while link.recv(1000):
                link.sendall(says)

        threading.Thread(target=answer, daemon=True).start()
    poller = Poller([*paths, tmp_path / "nobody"])
    requests = {index: {"do": "status"} for index in range(4)}
    for _ in range(2):
        assert poller.ask(requests, 0.2) == {0: {"kind": "mesh"}}
    poller.close()


def test_who_is_not_there_cannot_be_watched(tmp_path, monkeypatch):
    monkeypatch.setenv("INNERVATE_RUN", str(tmp_path))
    with pytest.raises(WatchError, match="no node runs here"):
        find([])
    with pytest.raises(LiveError, match="n7"):
        find(["n7"])
    with pytest.raises(WatchError, match="no node answers"):
        Live([tmp_path / "n0.sock"])


def test_networks_are_not_mixed(monkeypatch):
    told = {0: {"kind": "skin"}, 1: {"kind": "radio"}}
    monkeypatch.setattr(Poller, "ask_all", lambda self, request: told)
    with pytest.raises(WatchError, match="one network"):
        Live([Path("a"), Path("b")])


def test_a_group_is_not_cut(monkeypatch):
    near = [
        {"node": 1, "ports": [0], "suspect": False},
        {"node": 2, "ports": [0], "suspect": False},
    ]
    told = {
        i: {"kind": "mesh", "role": "node", "number": i, "gateway": None, "routes": {},
            "neighbours": near if i == 0 else [], "paths": [], "counters": {}}
        for i in range(3)
    }  # fmt: skip
    monkeypatch.setattr(Poller, "ask_all", lambda self, request: told)
    source = Live([Path("a"), Path("b"), Path("c")])
    with pytest.raises(Refused, match="same path"):
        source.carry_out(messages.Cut(0))
