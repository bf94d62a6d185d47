"""Requests that come one behind the other at a node's socket, late, in parts, or from who left."""

import asyncio
import json
from collections import Counter
from contextlib import asynccontextmanager

import pytest

from innervate.live import status

NOBODY_ASKED = b'{"error": "no whole request came within 0.2 s"}\n'


@pytest.fixture(autouse=True)
def quick(monkeypatch):
    monkeypatch.setattr(status, "LOOK_S", 0.01)
    monkeypatch.setattr(status, "WHOLE_S", 0.2)


@asynccontextmanager
async def serving(where, handle):
    server = status.Server(where, handle, Counter())
    await server.start()
    try:
        yield
    finally:
        await server.stop()


def line(**request):
    return json.dumps(request).encode() + b"\n"


@pytest.mark.parametrize(("count", "size"), [(3, 0), (500, 0), (40, 10_000)])
@pytest.mark.parametrize("reads", [False, True])
def test_what_was_asked_is_done_though_its_caller_left(tmp_path, count, size, reads):
    """Also where the first request waits for what never comes, or nobody read its answer."""
    done, where = [], tmp_path / "s"

    async def handle(request, writer):
        done.append(request["n"])
        await writer.line({"state": "accepted"})
        await asyncio.Event().wait()

    async def main():
        async with serving(where, handle):
            reader, writer = await asyncio.open_unix_connection(where)
            for n in range(count):
                writer.write(line(n=n, payload="x" * size))
            if reads:
                await reader.readline()
            else:
                done.append(-1)
            writer.close()
            async with asyncio.timeout(20):
                while len(done) < count + (not reads):
                    await asyncio.sleep(0.01)

    asyncio.run(main())
    assert sorted(done) == list(range(-(not reads), count))


def test_of_who_reads_no_answers_and_leaves_all_that_came_is_done(tmp_path, monkeypatch):
    """Also what the node had not read yet when an answer could not be written."""
    done, where, count = [], tmp_path / "s", 600
    monkeypatch.setattr(status, "BOUNDS", status.BOUNDS._replace(limit=1_000))

    async def handle(request, writer):
        done.append(request["n"])
        await writer.line({"much": "x" * 200_000})

    async def main():
        async with serving(where, handle), asyncio.timeout(10):
            _, writer = await asyncio.open_unix_connection(where)
            writer.transport.set_write_buffer_limits(0)
            writer.write(b"".join(line(n=n, payload="x" * 500) for n in range(count)))
            await writer.drain()
            await asyncio.sleep(0.2)
            assert len(done) < 10  # its own answers are in its way
            writer.close()
            while len(done) < count:
                await asyncio.sleep(0.01)

    asyncio.run(main())
    assert done == list(range(count))


def test_who_asks_for_much_at_once_leaves_others_their_turn(tmp_path):
    turns, left, where = [0], [], tmp_path / "s"

    async def handle(request, writer):
        left.append(turns[0])
        await writer.line({"ok": True})

    async def count():
        while True:
            turns[0] += 1
            await asyncio.sleep(0)

    async def main():
        counting = asyncio.create_task(count())
        async with serving(where, handle), asyncio.timeout(20):
            reader, writer = await asyncio.open_unix_connection(where)
            writer.write(line(n=0) * 100)
            for _ in range(100):
                await reader.readline()
            writer.write(line(n=0) * 100)
            await writer.drain()
            writer.transport.abort()
            while len(left) < 200:
                await asyncio.sleep(0.01)
        counting.cancel()

    asyncio.run(main())
    assert len(set(left)) == 200


async def say_ok(request, writer):
    await writer.line({"ok": True})


@pytest.mark.parametrize("asked", [b"", b'{"do": ', line(do="x") + b'{"do": '])
def test_who_does_not_end_a_request_in_time_is_told_and_hung_up_on(tmp_path, asked):
    where = tmp_path / "s"

    async def main():
        async with serving(where, say_ok), asyncio.timeout(5):
            reader, writer = await asyncio.open_unix_connection(where)
            writer.write(asked)
            said = await reader.read()
            writer.close()
            return said

    answers = asked.count(b"\n") * b'{"ok": true}\n'
    assert asyncio.run(main()) == answers + NOBODY_ASKED


def test_who_has_asked_may_take_time_to_ask_again_and_an_empty_line_is_a_request(tmp_path):
    where = tmp_path / "s"

    async def main():
        async with serving(where, say_ok), asyncio.timeout(5):
            reader, writer = await asyncio.open_unix_connection(where)
            said = []
            for asked in (line(n=0), b"\n", b"\n\n", line(n=1), line(n=2)[:-1]):
                writer.write(asked)
                for _ in range(max(1, asked.count(b"\n"))):
                    if not asked.endswith(b"\n"):
                        writer.write_eof()
                    said.append(json.loads(await reader.readline()))
                await asyncio.sleep(3 * status.WHOLE_S / 2)
            writer.close()
            return ["ok" in one for one in said]

    assert asyncio.run(main()) == [True, False, False, False, True, True]


def test_behind_a_request_that_has_no_end_nothing_is_read(tmp_path):
    done, where = [], tmp_path / "s"

    async def handle(request, writer):
        done.append(request["n"])
        writer.is_last = request["n"] == 1
        await writer.line({"ok": True})
        if writer.is_last:
            await asyncio.Event().wait()

    async def main():
        async with serving(where, handle):
            reader, writer = await asyncio.open_unix_connection(where)
            writer.write(b"".join(line(n=n) for n in range(4)))
            for _ in range(2):
                await reader.readline()
            writer.close()
            await asyncio.sleep(0.1)

    asyncio.run(main())
    assert done == [0, 1]
