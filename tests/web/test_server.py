"""The server: who may look on and command, several pages, slow ones, and rubbish."""

import asyncio
import http.client
import json
import random
import signal
import socket
import subprocess
import sys
import time
from contextlib import asynccontextmanager
from urllib.parse import urlsplit

import pytest
import websockets

from innervate import scenario
from innervate.running import run
from innervate.web import hub as hubs
from innervate.web import server
from innervate.web.errors import WatchError
from innervate.web.serve import serving
from tests.web.page import Page, socket_of
from tests.web.runs import SKIN, simulated

SMALL = {**SKIN, "duration_s": 60.0}


@asynccontextmanager
async def watched(speed=0.1, tables=SMALL, **how):
    """A small skin behind a page."""
    async with serving(simulated(tables, speed), **how) as served:
        yield served


def ask(address, path, headers=None, method="GET"):
    """An HTTP request with headers of one's own: (status, headers, body)."""
    parts = urlsplit(address)
    link = http.client.HTTPConnection(parts.hostname, parts.port, timeout=10)
    try:
        link.putrequest(method, path, skip_host=bool(headers and "Host" in headers))
        for name, value in (headers or {}).items():
            link.putheader(name, value)
        link.endheaders()
        answer = link.getresponse()
        return answer.status, dict(answer.getheaders()), answer.read()
    finally:
        link.close()


def test_a_page_is_told_scene_then_state_and_commands_come_into_effect():
    async def main():
        async with watched() as served, Page(served.address) as page:
            assert await page.take() == "scene"
            assert await page.take() == "state"
            await page.until(lambda: page.state["t_s"] > 0.05)
            await page.give("cut", link=3)
            await page.until(lambda: page.state["link_up"][3] == 0)
            await page.until(lambda: page.state["recovery"]["cause"] in page.text())
            await page.give("heal", link=3)
            await page.until(lambda: page.state["link_up"][3] == 1)
            await page.give("pause")
            await page.until(lambda: page.state["paused"])
            held = page.state["t_s"]
            await page.give("kill", node=4)
            await page.until(lambda: page.state["node_up"][4] == 0)
            assert page.state["t_s"] - held < 1e-5
            await page.give("seek", t_s=0.01)
            await page.until(lambda: page.state["t_s"] == 0.01)
            assert page.backs
            assert page.state["node_up"][4] == 1

    asyncio.run(main())


def test_what_a_page_saves_is_replayed():
    async def main():
        tables = {**SKIN, "duration_s": 0.6}
        async with watched(0, tables) as served, Page(served.address) as page:
            await page.until(lambda: page.state.get("at_end"))
            await page.give("seek", t_s=0.2)
            await page.until(lambda: page.state["t_s"] >= 0.2 and not page.state["at_end"])
            await page.give("pause")
            await page.until(lambda: page.state["paused"])
            await page.give("kill", node=7)
            await page.give("go")
            await page.until(lambda: page.state["at_end"])
            answer = await page.ask("save")
            again = run(scenario.loads(answer["toml"]))
            engine = served.hub.source.engine
            assert again.result.fingerprint == engine.running.fingerprint
            assert (
                again.summary["recoveries"][0]["routed_ms"]
                == (page.state["recovery"]["recovered_ms"])
            )

    asyncio.run(main())


def test_two_pages_see_the_same_network():
    async def main():
        async with watched() as served, Page(served.address) as one, Page(served.address) as two:
            await one.give("pause")
            await one.give("cut", link=2)
            for page in (one, two):
                await page.until(lambda page=page: page.state.get("link_up", [1] * 3)[2] == 0)
                await page.until(lambda page=page: page.state["paused"])
            await two.give("heal", link=2)
            await one.until(lambda: one.state["link_up"][2] == 1)
            await two.until(lambda: two.state["link_up"][2] == 1)
            refused = await two.ask("heal", link=2)
            assert refused["type"] == "error"
            assert not one.answers
            for page in (one, two):
                await page.give("speed", value=1)
                await page.until(lambda page=page: page.state["speed"] == 1)
            assert one.state == two.state | {"t_s": one.state["t_s"]}

    asyncio.run(main())


@pytest.mark.parametrize(
    ("token", "headers"),
    [
        ("", {}),
        ("wrong", {}),
        ("tök€n", {}),
        (None, {"origin": "http://evil.example"}),
        (None, {"origin": "null"}),
        (None, {"origin": "http://127.0.0.1:1"}),
    ],
)
def test_without_the_token_or_from_another_page_there_is_no_socket(token, headers):
    async def main():
        async with watched() as served:
            async with websockets.connect(socket_of(served.address, token), **headers) as link:
                with pytest.raises(websockets.ConnectionClosed):
                    await asyncio.wait_for(link.recv(), 10)
                assert link.close_code == 4403
            assert not served.hub.pages

    asyncio.run(main())


def test_the_page_s_own_origin_is_let_in():
    async def main():
        async with watched() as served:
            own = served.address.split("/?")[0]
            async with Page(served.address, origin=own) as page:
                assert await page.take() == "scene"

    asyncio.run(main())


def test_a_name_that_is_not_ours_is_sent_away():
    async def main():
        async with watched() as served:
            for name in ("evil.example", "evil.example:80", "", "127.0.0.1.evil.example"):
                status, _, _ = await asyncio.to_thread(ask, served.address, "/", {"Host": name})
                assert status == 421
            parts = urlsplit(served.address)
            for name in (parts.netloc, f"localhost:{parts.port}", "[::1]:9", "192.168.1.7"):
                status, _, _ = await asyncio.to_thread(ask, served.address, "/", {"Host": name})
                assert status in (200, 404)
            with pytest.raises(websockets.InvalidStatus):
                await websockets.connect(
                    socket_of(served.address), additional_headers={"Host": "evil.example"}
                )

    asyncio.run(main())


def test_files_are_served_and_no_others(tmp_path, monkeypatch):
    static = tmp_path / "static"
    static.mkdir()
    (static / "index.html").write_text("<title>page</title>")
    (static / "page.js").write_text("1")
    (tmp_path / "secret").write_text("secret")
    monkeypatch.setattr(server, "STATIC", static)
    report = tmp_path / "report.html"
    report.write_text("<p>report")

    async def main():
        async with watched(report=report) as served:

            async def get(path, method="GET"):
                return await asyncio.to_thread(ask, served.address, path, None, method)

            status, headers, body = await get("/")
            assert (status, body) == (200, b"<title>page</title>")
            assert headers["content-security-policy"].startswith("default-src 'self'")
            assert headers["referrer-policy"] == "no-referrer"
            status, headers, body = await get("/static/page.js")
            assert (status, body) == (200, b"1")
            assert "javascript" in headers["content-type"]
            for path in ("/static/../secret", "/static/%2e%2e%2fsecret", "/static/..", "/secret",
                         "/static/%00", "/static//etc/passwd", "/static/nothing.js",
                         "/static/" + 5000 * "a"):  # fmt: skip
                status, _, body = await get(path)
                assert status == 404, path
                assert b"secret" not in body
            status, _, _ = await get("/", "POST")
            assert status == 405
            query = urlsplit(served.address).query
            status, headers, body = await get(f"/report?{query}")
            assert (status, body) == (200, b"<p>report")
            assert "sandbox" in headers["content-security-policy"]
            for path in ("/report", "/report?token=x"):
                assert (await get(path))[0] == 403

    asyncio.run(main())


def test_rubbish_is_answered_and_nothing_breaks():
    rubbish = random.Random(5)
    words = [
        '{"do":"',
        "cut",
        '","link":',
        "-1",
        "}",
        "kill",
        "null",
        "[",
        "1e9",
        '"',
        "go",
        "\x00",
    ]

    async def main():
        async with watched() as served, Page(served.address) as page, Page(served.address) as other:
            for _ in range(200):
                await page.socket.send("".join(rubbish.choices(words, k=rubbish.randrange(1, 9))))
                await page.socket.send(rubbish.randbytes(rubbish.randrange(40)))
            for command in ({"do": "cut", "link": 10**6}, {"do": "kill", "node": 99},
                            {"do": "touch", "node": 0, "value": 7}):  # fmt: skip
                await page.socket.send(json.dumps(command))
            await page.until(lambda: any("no link" in a["text"] for a in page.answers))
            await page.until(lambda: any("no node 99" in a["text"] for a in page.answers))
            assert {answer["type"] for answer in page.answers} == {"error"}
            t_s = other.state.get("t_s", 0)
            await other.until(lambda: other.state.get("t_s", 0) > t_s + 0.01)
            assert not other.answers
            await page.socket.send("x" * 100_000)
            assert await page.closed() == 1009
            t_s = other.state["t_s"]
            await other.until(lambda: other.state["t_s"] > t_s + 0.01)

    asyncio.run(main())


def test_a_page_that_does_not_read_slows_nobody_and_misses_no_point():
    async def main():
        tables = {**SKIN, "duration_s": 1.0}
        async with watched(0.02, tables) as served, Page(served.address) as other:
            parts = urlsplit(served.address)
            slow = socket.create_connection((parts.hostname, parts.port))
            slow.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
            key = "dGhlIHNhbXBsZSBub25jZQ=="
            path = f"/socket?{parts.query}"
            slow.sendall(
                f"GET {path} HTTP/1.1\r\nHost: {parts.netloc}\r\nUpgrade: websocket\r\n"
                f"Connection: Upgrade\r\nSec-WebSocket-Key: {key}\r\n"
                "Sec-WebSocket-Version: 13\r\n\r\n".encode()
            )
            await other.until(lambda: len(served.hub.pages) == 2)
            began = time.monotonic()
            before = other.states
            await other.until(lambda: other.states >= before + 40)
            assert time.monotonic() - began < 10
            await other.give("speed", value=0)
            await other.until(lambda: other.state["at_end"])
            points = [t for t, _ in other.series["unconnected"]]
            assert points == sorted(set(points))
            assert len(points) == 500
            slow.close()

    asyncio.run(main())


def test_states_come_at_most_thirty_times_a_second():
    async def main():
        async with watched(1.0) as served, Page(served.address) as page:
            await page.take()
            began, before = time.monotonic(), page.states
            while time.monotonic() - began < 1.0:
                await page.take()
            assert page.states - before <= 33

    asyncio.run(main())


def test_pages_are_told_that_the_server_goes():
    async def main():
        async with watched() as served:
            page = await Page(served.address).__aenter__()
            await page.take()
        await page.closed()
        assert page.answers[-1] == {"type": "end", "text": "the server was stopped"}

    asyncio.run(main())


def test_a_source_that_cannot_go_on_says_so(monkeypatch):
    async def main():
        source = simulated(SMALL, 0.1)
        async with serving(source) as served, Page(served.address) as page:
            await page.take()

            def fails():
                raise MemoryError("no more room")

            source.work = fails
            await page.until(lambda: page.answers)
            assert page.answers[-1] == {"type": "end", "text": "no more room"}
            async with Page(served.address) as late:
                await late.until(lambda: late.answers)
                assert late.scenes

    asyncio.run(main())


def test_there_is_room_for_so_many_pages(monkeypatch):
    monkeypatch.setattr(hubs, "PAGES_MAX", 1)

    async def main():
        async with watched() as served, Page(served.address) as page:
            await page.take()
            async with Page(served.address) as other:
                assert await other.closed() == 1013

    asyncio.run(main())


def test_a_port_that_is_taken_is_said():
    async def main():
        with socket.create_server(("127.0.0.1", 0)) as taken:
            port = taken.getsockname()[1]
            with pytest.raises(WatchError, match=str(port)):
                async with watched(port=port):
                    pass

    asyncio.run(main())


def test_the_command_prints_an_address_and_ends_with_ctrl_c():
    process = subprocess.Popen(
        [sys.executable, "-m", "innervate.cli", "watch", "line", "--speed", "0.5"],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    try:
        address = process.stdout.readline().split()[1]
        assert "Ctrl-C" in process.stdout.readline()

        async def look():
            async with Page(address) as page:
                await page.until(lambda: page.state.get("t_s", 0) > 0)
                process.send_signal(signal.SIGINT)
                await page.until(lambda: page.answers)

        asyncio.run(look())
        assert process.wait(timeout=20) == 0
        assert process.stderr.read() == ""
    finally:
        process.kill()


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["line", "--speed", "-1"], "--speed"),
        (["line", "--port", "70000"], "--port"),
        (["line", "n1"], "innervate watch live"),
        (["nothing-like-that"], "no bundled scenario"),
        (["loop-three", "--set", "nothing=1"], "nothing"),
        (["live", "--seed", "1"], "--seed"),
        (["."], "not a run folder"),
    ],
)
def test_mistakes_are_one_line(arguments, says, capsys, tmp_path, monkeypatch):
    from innervate.cli import main as command

    monkeypatch.chdir(tmp_path)
    assert command(["watch", *arguments]) == 2
    err = capsys.readouterr().err
    assert says in err
    assert err.count("\n") == 1


def test_a_missing_part_is_named(capsys, monkeypatch):
    from innervate.cli import main as command

    for name in [name for name in sys.modules if name.startswith(("starlette", "innervate.web."))]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "starlette.applications", None)
    monkeypatch.setitem(sys.modules, "starlette", None)
    assert command(["watch", "line"]) == 2
    assert "innervate[web]" in capsys.readouterr().err
