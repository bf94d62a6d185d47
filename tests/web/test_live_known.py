"""A page that is opened late shows who died before, as far as files and sockets tell."""

import asyncio
import shutil
import tempfile
from contextlib import suppress
from pathlib import Path

from innervate.live import status
from innervate.web.live import Live, find
from innervate.web.live_known import silent
from innervate.web.live_poll import Poller
from innervate.web.live_view import LiveView
from innervate.web.serve import serving
from tests.live.net import Mesh
from tests.web.page import Page

NODE = """
kind = "{kind}"
name = "{name}"
number = {number}
nodes = 9
socket = "{folder}/{name}.sock"
{more}
"""
LINK = '[[link]]\nkind = "udp"\nbind = "127.0.0.1:{own}"\npeers = ["127.0.0.1:{far}"]\n'


def file(folder, kind, name, number, more="", started=True):
    text = NODE.format(kind=kind, name=name, number=number, folder=folder, more=more)
    (folder / f"{name}.toml").write_text(text)
    if started:
        (folder / f"{name}.log").touch()


def server(node, folder):
    async def answer(_request, writer):
        await writer.line(node.status())

    return status.Server(folder / f"{node.name}.sock", answer)


def test_a_node_that_ended_before_the_page_was_opened_is_on_the_map_and_comes_back(monkeypatch):
    """Node 3 of a ring ended, node 4 has not been started yet, node 1 was killed."""

    async def main(folder):
        async with Mesh(4, [(0, 1), (1, 2), (2, 3), (3, 0)]) as mesh:
            for number in range(5):
                file(folder, "mesh", f"n{number}", number, LINK.format(own=9, far=8), number != 4)
            (folder / "scenario.toml").write_text('kind = "mesh"\nnodes = 5\n')
            servers = [server(node, folder) for node in mesh.nodes]
            for one in servers[:3]:
                await one.start()
            left = folder / "left"
            servers[1].path.rename(left)  # a socket that nobody serves
            await servers[1].stop()
            left.rename(servers[1].path)
            sockets = find([])
            assert [path.stem for path in sockets] == ["n0", "n1", "n2", "n3"]
            source = await asyncio.to_thread(Live, sockets)
            async with serving(source) as served, Page(served.address) as page:
                await page.until(lambda: page.state.get("node_up") == [1, 0, 1, 0])
                assert [one["label"] for one in page.scene["nodes"]] == ["n0", "n1", "n2", "n3"]
                assert page.state["headline"]["level"] in ("degraded", "down")
                assert page.state["headline"]["nodes"][-1] == 3
                await page.until(lambda: "n3: nobody answers at its socket" in page.text())
                await servers[3].start()
                await page.until(lambda: page.state.get("node_up") == [1, 0, 1, 1])
                await page.until(lambda: "n3 answers" in page.text())
                assert "n3 answers again" not in page.text()
                await page.until(lambda: len(page.scene["links"]) >= 3)
            for one in servers:
                with suppress(OSError):
                    await one.stop()

    folder = Path(tempfile.mkdtemp(prefix="iv"))
    monkeypatch.setenv("INNERVATE_RUN", str(folder))
    try:
        asyncio.run(main(folder))
    finally:
        shutil.rmtree(folder)


def cell(number, paths):
    return {
        "kind": "skin", "role": "cell", "number": number, "parent": 0, "load": 1, "counters": {},
        "ports": [{"port": at, "path": at} for at in range(len(paths))],
        "paths": [{"own": f"udp 127.0.0.1:{a}", "name": f"udp 127.0.0.1:{b}", "port": at,
                   "up": True, "counters": {}} for at, (a, b) in enumerate(paths)],
    }  # fmt: skip


def test_the_cables_of_a_cell_that_ended_are_drawn_as_its_file_has_them(tmp_path, monkeypatch):
    """PC - c0 - c1; c1 is gone, and a station's file lies there from another time."""
    pc = {**cell(2, [(1, 2)]), "role": "sink", "cells": [1]}
    told = {0: cell(0, [(2, 1), (3, 4)]), 3: pc}
    monkeypatch.setattr(Poller, "ask_all", lambda self, request: dict(told))
    file(tmp_path, "skin", "c1", 1, 'role = "cell"\nports = [0]\n' + LINK.format(own=4, far=3))
    file(tmp_path, "radio", "s1", 1, LINK.format(own=9, far=8))
    paths = [tmp_path / f"{name}.sock" for name in ("c0", "c1", "s1", "pc")]
    source = Live(paths)
    scene = source.scene()
    assert [node["label"] for node in scene["nodes"]] == ["c0", "c1", "pc.0"]
    assert [node["role"] for node in scene["nodes"]] == ["cell", "cell", "port"]
    assert [(link["a"], link["b"]) for link in scene["links"]] == [(0, 1), (0, 2)]
    state = source.fields()
    assert state["node_up"].tolist() == [1, 0, 1]
    assert state["link_up"].tolist() == [0, 1]
    assert state["headline"] == {
        "level": "degraded", "nodes": [1],
        "text": "1 of 2 cells (c1) does not answer; the other cell has a way to the PC.",
    }  # fmt: skip


def test_a_pc_that_ended_has_the_ports_of_its_file(tmp_path, monkeypatch):
    told = {0: cell(0, [(2, 1)]), 1: cell(1, [(6, 5)])}
    monkeypatch.setattr(Poller, "ask_all", lambda self, request: dict(told))
    links = LINK.format(own=1, far=2) + LINK.format(own=5, far=6)
    file(tmp_path, "skin", "pc", 2, 'role = "sink"\n' + links)
    source = Live([tmp_path / f"{name}.sock" for name in ("c0", "c1", "pc")])
    assert [node["label"] for node in source.scene()["nodes"]] == ["c0", "c1", "pc.0", "pc.1"]
    assert [(link["a"], link["b"]) for link in source.scene()["links"]] == [(0, 2), (1, 3)]
    assert source.fields()["headline"]["level"] == "down"
    assert source.fields()["headline"]["text"].startswith("The PC")


def test_without_a_file_a_socket_that_nobody_serves_is_a_node_too(tmp_path, monkeypatch):
    told = {0: cell(0, [(2, 1)])}
    monkeypatch.setattr(Poller, "ask_all", lambda self, request: dict(told))
    for name, level in ("c1", "degraded"), ("pc", "down"):  # a cell that has a way has it by a PC
        source = Live([tmp_path / "c0.sock", tmp_path / f"{name}.sock"])
        assert source.fields()["node_up"].tolist() == [1, 0]
        assert source.fields()["headline"]["level"] == level


def test_who_is_called_as_a_node_without_a_name_has_the_number_of_that_name(tmp_path):
    heard = [{"kind": "mesh", "number": 7}]
    paths = [tmp_path / f"{name}.sock" for name in ("n3", "n07", "n7", "arm")]
    found = silent(LiveView(), heard, paths)
    assert [found[path].get("number") for path in paths] == [3, None, None, None]
