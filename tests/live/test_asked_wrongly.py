"""A node's socket comes back when somebody takes it away, and says in words what it cannot do."""

import asyncio
import errno
import json
import shutil
import socket
import threading
from collections import Counter

import pytest

from innervate.dialect.bounded import EndlessLoop
from innervate.live import status
from innervate.live.errors import LiveError
from tests.live.net import until
from tests.live.test_trouble import running, wait_until

WRONG = [
    ({"do": "command", "code": 1}, 'a mesh node cannot do "command"; it can: status, send, '),
    ({"do": ["status"]}, "a mesh node cannot do \"['status']\"; it can: status, send, "),
    ({"to": 3}, 'this request needs "do"'),
    ({"do": "send", "to": 1.5, "payload": "00"}, "to is a whole number, the recipient's"),
    ({"do": "send", "to": "1", "payload": "00"}, "to is a whole number, the recipient's"),
    ({"do": "cut"}, 'this request needs "port"'),
    ({"do": "cut", "port": None}, "port is a whole number, loss a share from 0 to 1"),
    ({"do": "loose", "port": 0, "loss": "much"}, "port is a whole number, loss a share from 0 "),
]


def test_a_nodes_socket_that_was_taken_away_is_made_anew(tmp_path):
    with running(tmp_path) as node, socket.socket(socket.AF_UNIX) as listener:
        listener.settimeout(10)
        listener.connect(str(node.where))
        lines = listener.makefile("rw")
        print(json.dumps({"do": "listen"}), file=lines, flush=True)
        assert json.loads(lines.readline()) == {"listening": "n0"}
        node.where.unlink()
        wait_until(node.where.is_socket)
        assert node.told()["name"] == "n0"
        listener.settimeout(0.3)
        with pytest.raises(TimeoutError):  # whoever listened does so still
            listener.recv(1)
        assert node.end() == 0
        assert not node.where.exists()
    assert not node.lines("Traceback")


def test_a_socket_whose_folder_was_taken_away_is_made_anew_and_anothers_is_let_alone(tmp_path):
    where = tmp_path / "run" / "n0.sock"

    async def main():
        server, other = (status.Server(where, None, Counter()) for _ in range(2))
        await server.start()
        shutil.rmtree(where.parent)
        server.look()
        assert await asyncio.to_thread(status.answers, where)
        where.unlink()
        await other.start()
        with pytest.raises(LiveError, match="a node with this name runs already"):
            server.look()
        await server.stop()
        assert await asyncio.to_thread(status.answers, where)
        await other.stop()
        assert not where.exists()

    asyncio.run(main())


def test_a_socket_at_which_nobody_could_listen_is_made_anew_at_the_next_look(tmp_path, monkeypatch):
    where = tmp_path / "n0.sock"

    def no_room(self):
        raise OSError(errno.ENOBUFS, "No buffer space available")

    async def main():
        server = status.Server(where, None, Counter())
        await server.start()
        where.unlink()
        with monkeypatch.context() as now:
            now.setattr(status.BoundedListener, "open", no_room)
            with pytest.raises(LiveError, match="No buffer space available"):
                server.look()
        server.look()
        assert await asyncio.to_thread(status.answers, where)
        await server.stop()
        assert not where.exists()

    asyncio.run(main())


def test_a_key_that_is_missing_in_the_node_itself_is_not_said_to_be_the_requests():
    said = []

    class Kept:
        async def line(self, answer):
            said.append(answer)

    async def handle(request, writer):
        if request["do"] == "loop":
            raise EndlessLoop("too long")
        {}[request["do"]]

    for do, error in (("x", KeyError), ("loop", EndlessLoop)):
        with pytest.raises(error):
            asyncio.run(status.answer(json.dumps({"do": do}).encode(), handle, Kept()))
    asyncio.run(status.answer(b"{}", handle, Kept()))
    assert said == [
        {"error": "this node cannot answer, by a mistake of its own: KeyError('x')"},
        {"error": "this node cannot answer, by a mistake of its own: EndlessLoop('too long')"},
        {"error": 'this request needs "do"'},
    ]


def test_a_node_that_ends_while_another_has_its_socket_does_not_say_that_it_is_back(tmp_path):
    with running(tmp_path) as node, socket.socket(socket.AF_UNIX) as other:
        other.bind(str(tmp_path / "other.sock"))
        other.listen()
        (tmp_path / "other.sock").replace(node.where)
        wait_until(lambda: node.lines("a node with this name runs already; stop it; going on"))
        assert node.end() == 0
        assert node.where.is_socket()
    assert not node.lines("there again")


def test_a_request_that_a_node_cannot_do_is_answered_in_words(tmp_path):
    with running(tmp_path) as node:
        for request, why in WRONG:
            with pytest.raises(LiveError) as told:
                status.ask_one(node.where, request)
            assert str(told.value).startswith(f"n0: {why}"), request
        assert node.end() == 0


def test_who_waits_for_an_end_and_leaves_gives_its_place_back(tmp_path, monkeypatch):
    """A message to all has none: nobody acknowledges to have been one of them."""
    monkeypatch.setattr(status, "LOOK_S", 0.01)
    where, ended = tmp_path / "n0.sock", []

    async def handle(request, writer):
        await writer.line({"state": "accepted"})
        try:
            await asyncio.Event().wait()
        finally:
            ended.append(request["to"])

    async def main():
        server = status.Server(where, handle, Counter())
        await server.start()
        for to in range(status.BOUNDS.most + 1):
            reader, writer = await asyncio.open_unix_connection(where)
            writer.write(json.dumps({"do": "send", "to": to}).encode() + b"\n")
            assert await reader.readline() == b'{"state": "accepted"}\n'
            writer.close()
            await asyncio.sleep(0.05)
        await server.stop()

    asyncio.run(main())
    assert ended == list(range(status.BOUNDS.most + 1))


def test_who_is_turned_away_before_it_has_asked_is_told_why(tmp_path, monkeypatch):
    where = tmp_path / "n0.sock"
    full = status.Bounds(most=0, burst=64, full=status.FULL, limit=status.LINE_MAX)
    monkeypatch.setattr(status, "BOUNDS", full)
    dumps, turned_away = json.dumps, threading.Event()

    def late(request):
        assert turned_away.wait(5)
        return dumps(request)

    async def main():
        server = status.Server(where, None, counts := Counter())
        await server.start()
        monkeypatch.setattr(status.json, "dumps", late)
        asking = asyncio.create_task(asyncio.to_thread(status.ask_one, where, {"do": "status"}))
        await until(lambda: counts["status: turned away"])
        turned_away.set()
        with pytest.raises(LiveError, match="n0: 64 are connected to this node already"):
            await asking
        await server.stop()

    asyncio.run(main())
