"""`innervate live capture` where a node was killed or hangs, and where the disk runs full."""

import asyncio
import io
import os
import resource
import signal
import socket
import subprocess
import sys
from contextlib import contextmanager

import pytest

from innervate import scenario as scenarios
from innervate.cli import capturing
from innervate.cli.errors import UserError
from innervate.export.reading import Capture
from tests.live.net import Mesh, running, until
from tests.live.test_capture import serving

FIRST_S = 30.0
ROOM = 6000  # bytes that a full disk still takes
SKIN = {"kind": "skin", "patch": [{"columns": 2, "rows": 1}],
        "interface": [{"row": 0, "column": 0}], "data": {"rate_hz": 50}}  # fmt: skip


def left_socket(path):
    """The socket of a node that was killed."""
    with socket.socket(socket.AF_UNIX) as sock:
        sock.bind(str(path))
    return path


@contextmanager
def hanging(path):
    """The socket of a node that was stopped: callers queue up, and nobody answers."""
    with socket.socket(socket.AF_UNIX) as sock:
        sock.bind(str(path))
        sock.listen()
        yield path


def recorded(folder, others, are_named=False):
    """The end of a capture of two nodes and others, and what it holds."""
    file = io.BytesIO()

    async def main():
        async with Mesh(2, [(0, 1)]) as net:
            servers = await serving(net.nodes, folder)
            paths = [*(server.path for server in servers), *others]
            recorder = capturing.Recorder(paths, file, are_named)
            running = asyncio.create_task(recorder.run(0))
            await until(lambda: recorder.frames > 2 or running.done())
            for server in servers:
                await server.stop()
            return await running

    return asyncio.run(main()), file.getvalue()


def test_of_all_nodes_those_that_answer_are_captured(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(capturing, "ANSWER_S", 2.0)  # others may be slow for a while
    with hanging(tmp_path / "n8.sock") as stopped:
        code, data = recorded(tmp_path, [left_socket(tmp_path / "n7.sock"), stopped])
    assert code == 0
    (tmp_path / "x.pcapng").write_bytes(data)
    read = Capture(tmp_path / "x.pcapng")
    assert len(list(read.packets())) > 2
    assert {one.name for one in read.interfaces} == {"n0", "n1"}
    *silent, last = capsys.readouterr().err.splitlines()
    assert silent == [f"innervate: {name}: does not answer; its process was killed, or hangs"
                      for name in ("n7", "n8")]  # fmt: skip
    assert last.endswith(" frames of 2 nodes")


def test_a_node_that_is_named_has_to_answer(tmp_path, monkeypatch):
    monkeypatch.setattr(capturing, "ANSWER_S", 2.0)  # others may be slow for a while
    with pytest.raises(UserError, match=r"n7\.sock: no node answers here"):
        recorded(tmp_path, [left_socket(tmp_path / "n7.sock")], are_named=True)
    late = pytest.raises(UserError, match=r"n8\.sock: no node answers here: timed out")
    with hanging(tmp_path / "n8.sock") as stopped, late:
        recorded(tmp_path, [stopped], are_named=True)


def test_where_all_were_killed_there_is_nothing_to_capture(tmp_path, monkeypatch):
    monkeypatch.setenv("INNERVATE_RUN", str(tmp_path))
    for name in ("n0", "n1"):
        left_socket(tmp_path / f"{name}.sock")
    with pytest.raises(UserError, match="no node answers here"):
        capturing.capture(out=tmp_path / "none.pcapng")


def capture(folder, *words, room=None, **more):
    """What `live capture` of a folder's nodes ends with, as a process of its own."""

    def limited():
        resource.setrlimit(resource.RLIMIT_FSIZE, (room, resource.RLIM_INFINITY))

    return subprocess.run(
        [sys.executable, "-m", "innervate.cli", "live", "capture", *words],
        env={**os.environ, "INNERVATE_RUN": str(folder)}, stderr=subprocess.PIPE, text=True,
        timeout=60, check=False, preexec_fn=None if room is None else limited, **more,
    )  # fmt: skip


def on_a_skin(folder, what):
    """What comes of something done beside a running skin of processes."""

    async def main():
        async with running(scenarios.plan(scenarios.from_dict(SKIN)), folder) as network:
            done = await asyncio.to_thread(what, network)
            assert all(process.poll() is None for process in network.processes.values())
        return done

    return asyncio.run(main())


def test_a_disk_that_runs_full_ends_a_capture_in_one_line(tmp_path):
    out = tmp_path / "out.pcapng"
    done = on_a_skin(tmp_path, lambda _: capture(tmp_path, "--out", str(out), room=ROOM))
    assert done.returncode == 2
    assert done.stderr == f"innervate: {out} cannot be written: File too large\n"
    assert out.stat().st_size == ROOM
    read = Capture(out)
    assert sum(1 for _ in read.packets()) > 20  # all that there was room for


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="no device that is always full")
def test_a_disk_that_is_full_takes_no_capture(tmp_path):
    def both(_):
        with open("/dev/full", "wb") as full:
            return capture(tmp_path, "--out", "/dev/full"), capture(tmp_path, stdout=full)

    named, piped = on_a_skin(tmp_path, both)
    assert named.returncode == 2
    assert named.stderr == "innervate: /dev/full cannot be written: No space left on device\n"
    assert piped.returncode == 1
    assert piped.stderr == "innervate: No space left on device\n"


def test_a_killed_node_of_a_folder_is_named_and_the_others_are_captured(tmp_path):
    def killed(network):
        network.processes["c1"].send_signal(signal.SIGKILL)
        network.processes.pop("c1").wait()
        return capture(tmp_path, "--out", str(tmp_path / "out.pcapng"), "--for", "1")

    done = on_a_skin(tmp_path, killed)
    assert done.returncode == 0
    silent, last = done.stderr.splitlines()
    assert silent == "innervate: c1: does not answer; its process was killed, or hangs"
    assert last.endswith("frames of 2 nodes")
