"""A full disk and a flood of callers do not end a node: it goes on, and says so."""

import asyncio
import json
import os
import resource
import signal
import socket
import subprocess
import sys
import threading
import urllib.request
from collections import Counter
from contextlib import ExitStack, contextmanager, suppress

import pytest

from innervate.cli import live_status
from innervate.live import status
from innervate.live.errors import LiveError
from innervate.live.notices import PERIOD_S, Notices
from innervate.live.state import State
from tests.live.net import until
from tests.live.pair import KEY
from tests.live.test_process import free_port

FIRST_S = 30.0
FULL = (resource.RLIMIT_FSIZE, (0, resource.RLIM_INFINITY))  # no file can grow
FILES = (resource.RLIMIT_NOFILE, (48, 48))
OFTEN = """
import sys
from innervate.live import main
main.SAVE_S = 0.05
from innervate.cli import main as cli
sys.exit(cli(["live", "node", sys.argv[1]]))
"""


def write_file(folder, **more):
    lines = [
        'kind = "mesh"', "number = 0", "nodes = 2", 'role = "gateway"',
        f'socket = "{folder / "n0.sock"}"',
        *(f"{key} = {json.dumps(value)}" for key, value in more.items()),
        "[keys]", "use = 1", f'secret.1 = "{KEY.hex()}"',
        "[[link]]", 'kind = "udp"', 'bind = "127.0.0.1:0"', 'peers = ["127.0.0.1:9"]',
    ]  # fmt: skip
    path = folder / "n0.toml"
    path.write_text("\n".join(lines) + "\n")
    return path


class Running:
    """A node as a process that saves its state many times a second, and what it wrote so far."""

    def __init__(self, folder, limits=(), **more):
        command = [sys.executable, "-c", OFTEN, str(write_file(folder, **more))]
        self.process = subprocess.Popen(
            command, stderr=subprocess.PIPE, text=True,
            preexec_fn=lambda: [resource.setrlimit(*limit) for limit in limits],
        )  # fmt: skip
        self.where = folder / "n0.sock"
        self.said = []
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def _read(self):
        self.said.extend(iter(self.process.stderr.readline, ""))

    def told(self):
        return status.ask_one(self.where, {"do": "status"})

    def lines(self, word):
        return [line for line in self.said if word in line]

    def end(self):
        self.process.send_signal(signal.SIGTERM)
        code = self.process.wait(FIRST_S)
        self._reader.join(FIRST_S)
        return code


@contextmanager
def running(folder, **more):
    node = Running(folder, **more)
    try:
        asyncio.run(until(lambda: node.lines("ready") or node.process.poll() is not None, FIRST_S))
        yield node
    finally:
        node.process.kill()
        node.process.wait()


def wait_until(what):
    asyncio.run(until(what, FIRST_S))


def test_a_disk_that_is_full_for_a_while_does_not_end_a_node(tmp_path):
    port = free_port()
    page = f"http://127.0.0.1:{port}/metrics"
    kept = b'{"epoch": 3}'
    (tmp_path / "n0.state").write_bytes(kept)
    with running(tmp_path, limits=[FULL], metrics=f"127.0.0.1:{port}") as node:
        wait_until(lambda: node.told()["counters"].get("state not written", 0) > 5)
        told = node.told()
        assert told["state"]["file"] == str(tmp_path / "n0.state")
        assert told["state"]["trouble"] == "File too large"
        assert any("STATE NOT WRITTEN: File too large" in line for line in live_status.lines(told))
        text = urllib.request.urlopen(page, timeout=10).read().decode()
        assert 'innervate_state_written{node="n0"} 0' in text
        assert 'what="state not written"' in text
        assert (tmp_path / "n0.state").read_bytes() == kept
        assert not list(tmp_path.glob("*.new"))
        resource.prlimit(node.process.pid, resource.RLIMIT_FSIZE, (-1, -1))
        wait_until(lambda: node.told()["state"]["trouble"] == "")
        wait_until(lambda: node.lines("written again"))
        assert node.end() == 0
    assert len(node.lines("cannot be written: File too large; going on")) == 1
    assert not node.lines("Traceback")


def test_a_node_starts_though_its_disk_is_full(tmp_path):
    with running(tmp_path, limits=[FULL]) as node:
        wait_until(lambda: node.lines("cannot be written: File too large; going on"))
        assert node.told()["state"]["written_s"] is None
        assert node.end() == 0
    assert not node.lines("Traceback")


@contextmanager
def log_on_a_full_disk():
    with open("/dev/full", "w") as log:
        yield log


@contextmanager
def log_that_nobody_reads():
    reader, writer = os.pipe()
    os.close(reader)
    with open(writer, "w") as log:
        yield log


@contextmanager
def log_whose_reader_is_stuck():
    reader, writer = os.pipe()
    os.set_blocking(writer, False)
    with open(reader), open(writer, "w") as log:
        with suppress(BlockingIOError):
            while True:
                os.write(writer, bytes(4096))
        os.set_blocking(writer, True)
        yield log


def is_answering(where):
    with suppress(LiveError):
        return status.ask_one(where, {"do": "status"})["state"]["trouble"] == ""
    return False


@pytest.mark.parametrize(
    "log", [log_on_a_full_disk, log_that_nobody_reads, log_whose_reader_is_stuck]
)
def test_a_node_whose_log_cannot_be_written_goes_on(tmp_path, log):
    command = [sys.executable, "-c", OFTEN, str(write_file(tmp_path))]
    with log() as stderr, subprocess.Popen(command, stderr=stderr) as process:
        try:
            wait_until(lambda: is_answering(tmp_path / "n0.sock") or process.poll() is not None)
            process.send_signal(signal.SIGHUP)  # it has another word to say
            assert is_answering(tmp_path / "n0.sock")
            process.send_signal(signal.SIGTERM)
            assert process.wait(FIRST_S) == 0
        finally:
            process.kill()


def test_the_device_that_is_always_full(tmp_path):
    state = State(tmp_path / "n.state")
    (tmp_path / "n.state.new").symlink_to("/dev/full")
    assert not state.write()
    assert state.trouble == "No space left on device"
    assert list(tmp_path.iterdir()) == []


def test_a_state_file_in_a_folder_that_is_not_there_is_the_users_mistake(tmp_path):
    where = tmp_path / "none" / "s"
    with running(tmp_path, state=str(where)) as node:
        assert node.process.wait(FIRST_S) == 2
        wait_until(lambda: node.said)
    assert "".join(node.said).count("\n") == 1
    assert f"{where}: cannot be written: No such file or directory" in node.said[0]


def flood(port, seconds):
    """Connections as fast as they come, closed at once or held; how many there were."""
    count, until_done = 0, threading.Event()
    timer = threading.Timer(seconds, until_done.set)
    timer.start()
    held = []
    while not until_done.is_set():
        with suppress(OSError):
            sock = socket.create_connection(("127.0.0.1", port), timeout=0.2)
            count += 1
            if count % 2:
                sock.close()
            else:
                held.append(sock)
                if len(held) > 300:
                    held.pop(0).close()
    for sock in held:
        sock.close()
    return count


def test_a_flood_of_callers_leaves_a_node_its_files_and_a_short_log(tmp_path):
    port = free_port()
    with running(tmp_path, limits=[FILES], metrics=f"127.0.0.1:{port}") as node:
        assert flood(port, 1.0) > 100
        told = node.told()
        assert told["counters"]["metrics: turned away"] > 0
        assert told["counters"]["metrics: made to wait"] > 0
        assert told["state"]["trouble"] == ""
        page = f"http://127.0.0.1:{port}/metrics"

        def is_served():
            with suppress(OSError):
                return b"innervate_up_seconds" in urllib.request.urlopen(page, timeout=1).read()

        wait_until(is_served)
        wait_until(lambda: node.lines("too many callers"))
        assert node.end() == 0
    assert len(node.said) <= 3
    assert not node.lines("Traceback")


def test_one_caller_too_many_is_told_so_and_the_others_are_served(tmp_path):
    async def main():
        async def handle(request, writer):
            await writer.line({"you": request["n"]})

        counts = Counter()
        server = status.Server(tmp_path / "n.sock", handle, counts)
        await server.start()
        streams = []
        async with asyncio.timeout(FIRST_S):
            for n in range(status.BOUNDS.most):
                reader, writer = await asyncio.open_unix_connection(tmp_path / "n.sock")
                writer.write(json.dumps({"n": n}).encode() + b"\n")
                assert json.loads(await reader.readline()) == {"you": n}
                streams.append(writer)
            reader, writer = await asyncio.open_unix_connection(tmp_path / "n.sock")
            assert "64 are connected" in json.loads(await reader.readline())["error"]
            assert await reader.read() == b""
            streams.pop().close()
            answered = b""
            while b"you" not in answered:  # the place is free once the node has seen the end
                reader, writer = await asyncio.open_unix_connection(tmp_path / "n.sock")
                with suppress(OSError):
                    writer.write(b'{"n": 99}\n')
                    answered = await reader.readline()
        await server.stop()
        return counts, answered

    counts, answered = asyncio.run(main())
    assert json.loads(answered) == {"you": 99}
    assert counts["status: turned away"] >= 1


def test_what_lasts_is_said_once_in_a_period_and_at_its_end():
    said, now = [], [0.0]
    notices = Notices(said.append, clock=lambda: now[0])
    notices.over("disk", "never said")
    for _ in range(4 * 64 - 20):
        notices.tell("disk", f"full at {now[0]:g}")
        now[0] += PERIOD_S / 64
    notices.tell("door", "many")
    for _ in range(3):  # it comes and goes
        notices.over("disk", "written again")
        notices.tell("disk", "not said so soon")
    now[0] += PERIOD_S
    notices.tell("disk", "full again")
    assert said == ["full at 0", "full at 60", "full at 120", "full at 180", "many",
                    "written again", "full again"]  # fmt: skip


@pytest.mark.needs_root
def test_a_real_disk_that_is_full_and_has_room_again(tmp_path):
    disk = tmp_path / "disk"
    disk.mkdir()
    subprocess.run(["mount", "-t", "tmpfs", "-o", "size=64k", "none", str(disk)], check=True)
    with ExitStack() as stack:
        stack.callback(subprocess.run, ["umount", str(disk)], check=True)
        state = State(disk / "n.state")
        state.revoked = bytes(3000)
        assert state.write()
        with suppress(OSError), (disk / "junk").open("wb") as junk:
            while True:
                junk.write(bytes(4096))
                junk.flush()
        assert not state.write()
        assert state.trouble == "No space left on device"
        assert State(disk / "n.state").revoked == state.revoked
        (disk / "junk").unlink()
        assert state.write()
