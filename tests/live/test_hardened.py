"""What other users of the machine, broken files and readers that stop cannot do to a node."""

import asyncio
import json
import os
import socket
import stat
import threading
import urllib.error
import urllib.request
from pathlib import Path

import pytest

from innervate.live import main, private, status
from innervate.live.channel import Medium
from innervate.live.channel_radio import JOIN, PLUG, SEND
from innervate.live.engine import clock_us
from innervate.live.errors import LiveError
from innervate.live.machine import Machine, on
from innervate.live.metrics import MetricsPage
from innervate.live.nodefile import load
from innervate.live.state import State
from tests.fixtures.node_files import of_mesh
from tests.live import time_by_hand
from tests.live.net import Mesh

SOMEBODY = 12_345
DEEP = "[" * 60_000


def mode_of(path):
    return stat.S_IMODE(path.stat().st_mode)


@pytest.fixture
def run_folder(tmp_path, monkeypatch):
    """Where sockets lie of a user who has said nothing."""
    for name in ("INNERVATE_RUN", "XDG_RUNTIME_DIR"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    return tmp_path / f"innervate-{os.getuid()}"


def test_the_folder_of_sockets_is_refused_if_others_may_change_it(run_folder, tmp_path):
    assert status.folder() == run_folder  # not there yet
    run_folder.mkdir(mode=0o700)
    assert status.folder() == run_folder
    run_folder.chmod(0o770)
    with pytest.raises(LiveError, match="not ours alone"):
        status.find("n0")
    run_folder.rmdir()
    (tmp_path / "elsewhere").mkdir(mode=0o700)
    run_folder.symlink_to(tmp_path / "elsewhere")
    with pytest.raises(LiveError, match="not ours alone"):
        status.sockets()


@pytest.mark.needs_root
def test_the_folder_of_sockets_is_refused_if_somebody_else_made_it(run_folder):
    run_folder.mkdir(mode=0o700)
    os.chown(run_folder, SOMEBODY, SOMEBODY)
    with pytest.raises(LiveError, match="not ours alone; remove it, or name another in INNERVATE"):
        status.folder()


def test_nobody_is_quicker_than_a_node_to_make_its_folder(run_folder):
    """It was not there when the node looked, and is somebody else's when its socket is made."""
    server = status.Server(run_folder / "n0.sock", None, is_ours=True)
    run_folder.mkdir()
    run_folder.chmod(0o777)
    with pytest.raises(LiveError, match="not ours alone"):
        asyncio.run(server.start())
    assert not list(run_folder.iterdir())


def test_what_is_secret_is_written_where_only_its_owner_reads(tmp_path):
    path = tmp_path / "n0.toml"
    path.touch(mode=0o644)
    private.write(path, "secret")
    assert (mode_of(path), path.read_text()) == (0o600, "secret")
    before = os.umask(0)
    try:
        with private.create(tmp_path / "capture.pcapng"):
            assert mode_of(tmp_path / "capture.pcapng") == 0o600  # before the first byte
        State(tmp_path / "n0.state").write()
    finally:
        os.umask(before)
    assert mode_of(tmp_path / "n0.state") == 0o600


def test_a_status_socket_is_never_open_to_others(tmp_path):
    async def start():
        server = status.Server(tmp_path / "n0.sock", None)
        before = os.umask(0)
        try:
            await server.start()
            return mode_of(server.path)
        finally:
            os.umask(before)
            await server.stop()

    assert asyncio.run(start()) == 0o600


STATES = [
    '{"epoch": 1e999}', '{"epoch": true}', f'{{"epoch": {2**60}}}', '{"epoch": 1.5}',
    '{"epoch": 256}', '{"epoch": 0, "revoked": 7}', '{"epoch": 0, "revoked": "xy"}', "null", "",
    "\0", DEEP, f'{{"epoch": {"9" * 5000}}}', '"counter"', "7", "[]",
]  # fmt: skip


@pytest.mark.parametrize("text", STATES, ids=range(len(STATES)))
def test_a_state_that_cannot_be_is_refused_in_a_line(tmp_path, text):
    path = tmp_path / "n0.state"
    path.write_text(text)
    with pytest.raises(LiveError, match="not a node's state; remove it") as found:
        State(path)
    assert "\n" not in str(found.value)


def test_a_request_without_a_bottom_is_answered():
    told = []

    class Writer:
        async def line(self, answer):
            told.append(answer)

    asyncio.run(status.answer(DEEP.encode(), None, Writer()))
    assert "recursion" in told[0]["error"]


FILE = of_mesh(0, 2, 'socket = "n0.sock"')


def test_a_listener_that_has_stopped_takes_no_more_room_than_others(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("n0.toml").write_text(FILE)
    count, payload = 60_000, bytes(80)

    async def run():
        process = main.Process(load(Path("n0.toml")))
        await process.server.start()
        await process.node.start()
        reader, writer = await asyncio.open_unix_connection("n0.sock", limit=1 << 20)
        writer.write(json.dumps({"do": "listen"}).encode() + b"\n")
        await reader.readline()
        writer.transport.pause_reading()  # from now on it reads nothing
        for _ in range(count // 100):
            for _ in range(100):
                process.node.arrivals.put((1, payload))
            process.node.arrivals.hand_up()
            await asyncio.sleep(0)
        held = max(len(kept._items) for kept in _pending())
        writer.transport.resume_reading()
        heard = missed = 0
        while heard + missed < count:
            told = json.loads(await reader.readline())
            heard, missed = heard + ("from" in told), missed + told.get("missed", 0)
        writer.close()
        await process.node.stop()
        await process.server.stop()
        return held, heard, missed

    def _pending():
        import gc

        return [one for one in gc.get_objects() if type(one) is main.Pending]  # no proxies

    held, heard, missed = asyncio.run(run())
    assert held <= main.HEARD_MAX
    assert missed > count // 2  # and it was told so
    assert heard + missed == count


class Jumping(Machine):
    """A machine whose clock is set back while nodes run."""

    at_ns = 5_000_000_000 * 10**9

    def time_ns(self):
        return self.at_ns


def test_up_is_by_no_clock_that_can_be_set():
    async def run(jumping):
        one = Mesh(1, []).nodes[0]
        jumping.at_ns = 0
        await one.start()
        told = one.status()["up_s"]
        await one.stop()
        return told

    jumping = Jumping()
    with on(jumping):
        assert 0 <= asyncio.run(run(jumping)) < 60


@pytest.mark.parametrize(
    ("host", "code"),
    [("127.0.0.1:9", 200), ("localhost", 200), ("[::1]:9", 200), ("evil.example:9", 421),
     ("", 421), ("127.0.0.1.evil.example", 421), (socket.gethostname(), 200)],
)  # fmt: skip
def test_metrics_are_for_who_calls_the_node_by_its_own_name(host, code):
    async def run():
        mesh = Mesh(1, [])
        one = mesh.nodes[0]
        await one.start()
        page = MetricsPage(("127.0.0.1", 0), one)
        await page.start()
        port = page.listener._sock.getsockname()[1]
        request = urllib.request.Request(f"http://127.0.0.1:{port}/metrics", headers={"Host": host})

        def get():
            try:
                with urllib.request.urlopen(request, timeout=10) as answer:
                    return answer.status
            except urllib.error.HTTPError as error:
                return error.code

        found = await asyncio.to_thread(get)
        await page.stop()
        await one.stop()
        return found

    assert asyncio.run(run()) == code


class Counted:
    """A medium that tells how much it sends."""

    def __init__(self):
        self.medium, self.sent = Medium(), 0
        self.medium._socket = self

    def sendto(self, data, _where):
        self.sent += len(data)

    def fileno(self):
        return -1


HERE, THERE = ("127.0.0.1", 9), ("127.0.0.1", 10)


def test_a_station_whose_plug_flickers_makes_no_flood():
    async def run():
        one = Counted()
        for number, where in enumerate((HERE, THERE)):
            one.medium.take(JOIN.pack(b"J", number), where)
        before = one.sent
        for k in range(100_000):
            one.medium.take(PLUG.pack(b"P", 0, k % 2), HERE)
        await asyncio.sleep(1.0)
        return one.sent - before, one.medium._ears[0].plugged

    sent, plugged = time_by_hand.run(run())
    assert plugged
    assert 0 < sent < 100


def test_a_station_is_one_and_its_frames_are_as_long_as_its_slots():
    async def run():
        one = Counted()
        medium = one.medium
        for number in range(100):
            medium.take(JOIN.pack(b"J", number), HERE)
        assert list(medium._ears) == [0]
        medium.take(JOIN.pack(b"J", 1), THERE)
        unsound = medium.unsound
        medium.take(SEND.pack(b"T", 0, clock_us(), 4) + bytes(1000), HERE)
        assert medium.unsound == unsound + 1
        before = one.sent
        medium.take(SEND.pack(b"T", 0, clock_us(), 4) + bytes(36), HERE)
        await asyncio.sleep(1.0)
        return one.sent - before

    assert 36 < time_by_hand.run(run()) < 150


def test_a_station_may_come_back_at_its_address_under_another_number():
    async def run():
        medium = Counted().medium
        medium.take(JOIN.pack(b"J", 5), HERE)
        await asyncio.sleep(3.0)
        medium.take(JOIN.pack(b"J", 6), HERE)
        return list(medium._ears)

    assert time_by_hand.run(run()) == [6]


def test_a_file_that_is_no_socket_stays_where_a_node_was_to_have_one(tmp_path):
    mine = tmp_path / "n0.sock"
    mine.write_text("mine")
    with pytest.raises(LiveError, match="is a file, and no node's socket"):
        Machine().listen_at(mine)
    assert mine.read_text() == "mine"


@pytest.mark.parametrize("what", ["status", "revoke"])
def test_a_node_that_hangs_is_not_waited_for(tmp_path, monkeypatch, what):
    """It takes the question, and says nothing; others are still to be asked."""
    monkeypatch.setattr(status, "ANSWER_S", 0.05)
    path = tmp_path / "n0.sock"
    with socket.socket(socket.AF_UNIX) as hung:
        hung.bind(str(path))
        hung.listen()
        end = threading.Timer(5, hung.close)
        end.start()
        with pytest.raises(LiveError, match="no node answers here: timed out"):
            status.ask_one(path, {"do": what})
        end.cancel()


def test_whoever_ended_asking_is_gone_once_both_directions_are_closed(tmp_path):
    async def main():
        told, half, over = [], asyncio.Event(), asyncio.Event()

        async def serve(reader, stream):
            writer = status.Writer(stream)
            await reader.read()
            told.append(writer.is_gone())  # it has only ended asking
            half.set()
            async with asyncio.timeout(5):
                while not writer.is_gone():
                    await asyncio.sleep(0.01)
            with pytest.raises(ConnectionError):
                await writer.line({})
            over.set()
            stream.close()

        async with await asyncio.start_unix_server(serve, tmp_path / "s"):
            _, caller = await asyncio.open_unix_connection(tmp_path / "s")
            caller.write_eof()
            await half.wait()
            caller.close()
            await asyncio.wait_for(over.wait(), 5)
        return told

    assert asyncio.run(main()) == [False]
