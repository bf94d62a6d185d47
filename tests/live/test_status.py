"""What `innervate live status` prints names the broken cable, and what is on either side of it."""

import asyncio
import os
import shutil
import socket
import time
from contextlib import ExitStack, contextmanager
from pathlib import Path
from types import SimpleNamespace

import pytest

from innervate import scenario as scenarios
from innervate.cli import app, live, live_enrol, live_status
from innervate.live import status
from innervate.live.engine import NEVER
from innervate.live.errors import LiveError
from innervate.live.node import is_broken
from innervate.live.up import Processes
from tests.live import test_trouble
from tests.live.net import Mesh, Skin, until


def test_a_cells_ports_have_the_names_of_its_sockets_and_a_cut_is_shown():
    async def main():
        async with Skin(2, 2, [(0, 0)]) as skin:
            await until(skin.fresh())
            skin.cells[0].change(1, "cut")
            assert "  CUT HERE" in live_status.lines(skin.cells[0].status())[3]
            await until(lambda: skin.cells[2].status()["broken"])
            return [node.status() for node in (*skin.cells, skin.pc)]

    told = asyncio.run(main())
    lines = live_status.lines(told[0])
    assert lines[1].startswith("  to the PC: by port 2 (W), 1 hop, load ")
    assert lines[2].startswith("  port 0 (E): local 0-1, heard ")
    assert lines[3].startswith("  port 1 (down): local 0-2, heard ")
    assert live_status.lines(told[-1])[1] == f"  cells per interface port: {told[-1]['cells']}"
    assert {"broken: c0 port 1", "broken: c2 port 0"} & set(live_status.broken(told))


@pytest.mark.parametrize(
    ("up", "heard_at", "most_us", "broken"),
    [
        (True, 0, 50, True), (True, 949, 50, True), (True, 950, 50, False), (False, 950, 50, True),
        (True, 0, NEVER, False), (True, 1, NEVER, False), (False, 950, NEVER, True),
    ],
)  # fmt: skip
def test_a_path_is_broken_that_was_silent_for_longer_than_its_protocol_allows(
    up, heard_at, most_us, broken
):
    """A token goes one way round: who sends over a cable need never hear anything on it."""
    assert is_broken(SimpleNamespace(up=up, heard_at=heard_at), 1000, most_us) == broken


def path(own, far, broken=True):
    return {"own": own, "name": far, "broken": broken, "port": 0}


def test_a_cable_is_named_once_by_both_its_ends():
    told = [{"name": "n0", "paths": [path("udp a:1", "udp b:1")]},
            {"name": "n1", "paths": [path("udp b:1", "udp a:1"), path("", "serial x")]},
            {"name": "n2", "paths": [path("udp c:1", "udp d:1", broken=False)]}]  # fmt: skip
    assert live_status.broken(told) == ["broken: n0 port 0 - n1 port 0", "broken: n1 port 0"]


def mesh_status():
    """What a mesh node says that has heard nobody."""
    return {"kind": "mesh", "name": "n0", "role": "node", "up_s": 1, "sealed": False,
            "counters": {}, "gateway": None, "epoch": 0, "table": 0, "neighbours": [],
            "routes": {}}  # fmt: skip


def test_where_a_name_leads_is_shown_and_its_cable_named_once():
    here = path("udp 10.0.0.1:1", "udp arm:2") | {"far": "udp 10.0.0.2:2"}
    there = path("udp 10.0.0.2:2", "udp 10.0.0.1:1")
    told = [{"name": "n0", "paths": [here]}, {"name": "n1", "paths": [there]}]
    assert live_status.broken(told) == ["broken: n0 port 0 - n1 port 0"]
    node = mesh_status() | {"paths": [
        here | {"heard_s": None, "up": True, "counters": {}},
        path("", "udp [fe80::1%eth0]:2", False)
        | {"far": "udp [fe80::1]:2", "heard_s": None, "up": True, "counters": {}, "port": 1},
        path("", "udp [fe80::1%eth9]:2", False)
        | {"heard_s": None, "up": True, "counters": {}, "port": 2},
    ]}  # fmt: skip
    lines = live_status.lines(node)
    assert any("udp arm:2 (10.0.0.2:2), heard" in line for line in lines)
    assert any("udp [fe80::1%eth0]:2, heard" in line for line in lines)
    assert any("udp [fe80::1%eth9]:2, heard" in line for line in lines)


@pytest.mark.parametrize("what", ["status", "revoke"])
def test_nodes_that_hang_are_waited_for_together(tmp_path, monkeypatch, capsys, what):
    monkeypatch.setenv("INNERVATE_RUN", str(tmp_path))
    monkeypatch.setattr(status, "ANSWER_S", 0.5)
    (tmp_path / "revoked.list").write_text("00")
    with ExitStack() as stack:
        for i in range(6):
            sock = stack.enter_context(socket.socket(socket.AF_UNIX))
            sock.bind(str(tmp_path / f"n{i}.sock"))
            sock.listen()
        began = time.monotonic()
        asked = live.show() if what == "status" else live_enrol.revoke(tmp_path / "revoked.list")
        assert asked == 1
        assert time.monotonic() - began < 2
    said = capsys.readouterr()
    words = {"status": "does not answer", "revoke": "no node answers here"}[what]
    assert (said.out + said.err).count(words) == 6


def test_nodes_that_have_one_number_are_named():
    nodes = (("mesh", "n0", 0), ("mesh", "arm", 1), ("mesh", "leg", 1), ("skin", "c1", 1))
    told = [dict(zip(("kind", "name", "number"), node, strict=True)) for node in nodes]
    told.append({"kind": "skin", "name": "pc"})
    same = "number 1: arm and leg have it; in one network others take them for the same node"
    assert live_status.twins(told) == [same]


def test_nodes_are_in_order_of_their_numbers(tmp_path, monkeypatch):
    monkeypatch.setenv("INNERVATE_RUN", str(tmp_path))
    for name in ("n10", "pc", "n2", "n0"):
        with socket.socket(socket.AF_UNIX) as sock:
            sock.bind(str(tmp_path / f"{name}.sock"))
    assert [found.stem for found in status.sockets()] == ["n0", "n2", "n10", "pc"]


@pytest.fixture
def own(tmp_path, monkeypatch):
    """A user's own folder for sockets, and no other that is named."""
    monkeypatch.delenv("INNERVATE_RUN", raising=False)
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path / "runtime"))
    return tmp_path / "runtime" / "innervate"


@contextmanager
def running(folder, name):
    folder.mkdir(parents=True, exist_ok=True)
    with socket.socket(socket.AF_UNIX) as sock:
        sock.bind(str(folder / f"{name}.sock"))
        yield sock
    (folder / f"{name}.sock").unlink()


def test_what_live_up_started_last_is_found_without_its_folder(own, tmp_path, monkeypatch):
    first, second = tmp_path / "first", tmp_path / "second"
    with running(first, "n1"), running(second, "n2"):
        assert status.sockets() == []
        older = status.findable(first)
        older.__enter__()
        assert [found.stem for found in status.sockets()] == ["n1"]
        with status.findable(second):
            assert status.find("n2") == second / "n2.sock"
            older.__exit__(None, None, None)  # takes no note away but its own
            assert status.where() == second
            with running(own, "alone"):
                assert [found.stem for found in status.sockets()] == ["alone"]
            monkeypatch.setenv("INNERVATE_RUN", str(first))
            assert status.where() == first
            with status.findable(first):
                monkeypatch.delenv("INNERVATE_RUN")
                assert status.where() == second, "who named a folder leaves no note"
        assert status.where() == own
        assert list(own.iterdir()) == []


def test_those_that_run_on_are_found_again_when_a_newer_live_up_has_ended(own, tmp_path):
    first, second = tmp_path / "first", tmp_path / "second"
    second.mkdir()
    with status.findable(first):
        with running(first, "n1") as sock:
            sock.listen()
            with status.findable(second):
                assert status.where() == second
            assert status.find("n1") == first / "n1.sock"
        with status.findable(second):
            pass
        assert status.where() == own, "nobody runs there any more"


def test_the_first_of_three_is_found_again_when_those_between_and_after_it_have_ended(
    own, tmp_path
):
    runs = [tmp_path / name for name in ("first", "second", "third")]
    ups = [status.findable(run) for run in runs]
    with running(runs[0], "n1") as sock:
        sock.listen()
        for run, up in zip(runs, ups, strict=True):
            run.mkdir(exist_ok=True)
            up.__enter__()
            assert status.where() == run
        ups[1].__exit__(None, None, None)
        assert status.where() == runs[2]
        ups[2].__exit__(None, None, None)
        assert status.where() == runs[0]
    ups[0].__exit__(None, None, None)
    assert status.where() == own
    assert list(own.iterdir()) == []


def test_where_the_own_folder_is_not_ours_nodes_run_all_the_same(tmp_path, monkeypatch):
    for name in ("INNERVATE_RUN", "XDG_RUNTIME_DIR"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr("tempfile.gettempdir", lambda: str(tmp_path))
    theirs = tmp_path / f"innervate-{os.getuid()}"
    theirs.mkdir()
    theirs.chmod(0o777)
    with status.findable(tmp_path / "run"):
        assert list(theirs.iterdir()) == []
    with pytest.raises(LiveError, match="not ours alone"):
        status.where()


def test_a_note_of_a_folder_that_is_gone_leads_nowhere(own, tmp_path):
    (tmp_path / "run").mkdir()
    with status.findable(tmp_path / "run"):
        (tmp_path / "run").rmdir()
        assert status.where() == own


def test_a_message_from_standard_input_is_no_option(tmp_path, monkeypatch, capsys):
    monkeypatch.setenv("INNERVATE_RUN", str(tmp_path))
    assert app.main(["live", "send", "n0", "2", "-"]) == 2
    assert 'no node "n0" runs here' in capsys.readouterr().err


def test_two_networks_do_not_share_a_folder(tmp_path):
    links = [{"a": 0, "b": 1}]
    told = {"kind": "mesh", "nodes": 2, "radio": {"profile": "ip"}, "link": links}
    network = Processes(scenarios.plan(scenarios.from_dict(told)), tmp_path, "udp")
    with socket.socket(socket.AF_UNIX) as sock:
        sock.bind(str(network.socket("n1")))
        sock.listen()
        with pytest.raises(LiveError, match="another network runs here"):
            asyncio.run(network.up())
    assert network.processes == {}


def test_the_first_line_says_whether_all_is_well_with_a_mesh():
    async def main():
        async with Mesh(5, [(0, 1), (1, 2), (2, 3), (3, 4), (0, 4)]) as mesh:
            return [node.status() for node in mesh.nodes]

    told = asyncio.run(main())
    assert live_status.headline(told, []) == "ok: All 5 nodes have a way to the gateway."
    assert (
        live_status.headline(told[:3] + told[4:], [Path("n3.sock")])
        == "degraded: 1 of 5 nodes is silent."
    )
    assert live_status.headline(told[1:], [Path("n0.sock")]).startswith(
        "down: No node leads as gateway"
    )
    silent = [Path(f"n{i}.sock") for i in range(5)]
    assert live_status.headline([], silent) == "no data: None of the 5 nodes answers."


def test_the_first_line_says_whether_all_is_well_with_a_skin():
    async def main():
        async with Skin(2, 2, [(0, 0)]) as skin:
            await until(skin.fresh())
            await until(lambda: all(cell.status()["parent"] is not None for cell in skin.cells))
            return [node.status() for node in (*skin.cells, skin.pc)]

    told = asyncio.run(main())
    assert live_status.headline(told, []) == "ok: Every cell has a way to the PC."
    for silent in (0, 2):  # wherever in the row it is, and not as a number of those that are left
        others = [one for i, one in enumerate(told) if i != silent]
        said = live_status.headline(others, [Path(f"c{silent}.sock")])
        assert said.startswith(f"degraded: 1 of 4 cells (c{silent}) does not answer")
    assert live_status.headline(told[:-1], [Path("pc.sock")]).startswith("down: The PC ")
    assert live_status.headline([told[0], {"kind": "mesh"}], []).startswith("mesh and skin nodes:")


def test_nodes_that_were_killed_are_named_and_the_others_are_shown(tmp_path, monkeypatch, capsys):
    monkeypatch.setenv("INNERVATE_RUN", str(tmp_path))
    with socket.socket(socket.AF_UNIX) as sock:  # what a killed process leaves behind
        sock.bind(str(tmp_path / "n1.sock"))

    async def main():
        async with Mesh(2, [(0, 1)]) as mesh:

            async def answer(_request, writer):
                await writer.line(mesh.nodes[0].status())

            server = status.Server(tmp_path / "n0.sock", answer)
            await server.start()
            codes = [await asyncio.to_thread(app.main, ["live", "status", *more])
                     for more in ([], ["--json"], ["n1"])]  # fmt: skip
            await server.stop()
            return codes

    assert asyncio.run(main()) == [1, 1, 2]
    shown = capsys.readouterr()
    assert shown.out.splitlines()[0] == "down: 1 of 2 nodes is silent."
    assert "n0: mesh gateway" in shown.out
    assert shown.err.count("n1: does not answer; its process was killed, or hangs") == 2
    assert "no node answers here" in shown.err


def test_where_files_of_nodes_are_gone_it_is_said_that_the_dead_are_not_counted(
    tmp_path, monkeypatch, capsys
):
    folder = tmp_path / "run"
    folder.mkdir()
    monkeypatch.setenv("INNERVATE_RUN", str(folder))
    gone = f"n0: {folder / 'n0.toml'} is gone; nodes that died since then may not be counted\n"
    with test_trouble.running(folder) as node:
        for said in ("", gone):
            test_trouble.wait_until(node.where.is_socket)
            assert app.main(["live", "status"]) == 0
            assert capsys.readouterr().err == said
            shutil.rmtree(folder)
        test_trouble.wait_until(node.where.is_socket)


def test_a_node_that_was_started_again_has_a_status_before_it_hears_a_gateway():
    async def main():
        node = Mesh(2, [(0, 1)]).nodes[1]
        node.state.fresh, node.stack.epoch = False, 79
        async with node:
            return node.status()

    told = asyncio.run(main())
    assert (told["epoch"], told["gateway"], told["onward"]) == (79, None, [])
    assert "  gateway none yet, epoch 79, table 0" in live_status.lines(told)
    assert live_status.headline([told], []) == "no data: No node leads as gateway yet."
