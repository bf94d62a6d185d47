"""A node that keeps warm rehearses while it runs; nothing comes of that but heat."""

import asyncio
import socket

import pytest

from innervate.live import warm
from innervate.live.build import build
from innervate.live.engine import Engine
from innervate.live.errors import LiveError
from innervate.live.machine import Machine, on
from innervate.live.nodefile import load
from innervate.live.warm import Warmth
from tests.live.test_udp import free_port

NODE = """kind = "mesh"
number = {}
nodes = 2
role = "{}"
engine = "{}"
warm = true
[[link]]
kind = "udp"
bind = "127.0.0.1:{}"
peers = ["127.0.0.1:{}"]
"""
MANY = 40


def pair(folder, engine):
    ports = free_port(), free_port()
    for number, role in enumerate(("gateway", "node")):
        path = folder / f"n{number}.toml"
        path.write_text(NODE.format(number, role, engine, ports[number], ports[1 - number]))
        yield build(load(path))


def values(record):
    """All fields of a record of ours, in Python or in C."""
    names = [name for name, *_ in getattr(record, "_fields_", ())] or type(record).__slots__
    return {name: list(one) if hasattr(one := getattr(record, name), "__len__") else one
            for name in names}  # fmt: skip


def rehearsals(monkeypatch, count, done):
    """An event that comes when nodes rehearsed so often."""
    told, real = asyncio.Event(), Engine.rehearse

    def rehearse(engine):
        real(engine)
        done.append(engine)
        if len(done) >= count:
            told.set()

    monkeypatch.setattr(Engine, "rehearse", rehearse)
    return told


@pytest.mark.parametrize("engine", ["python", "auto"])
def test_nothing_comes_of_a_rehearsal(tmp_path, monkeypatch, engine):
    """Neither counters, nor state, nor a frame to the neighbour, nor a message to the user."""

    async def main():
        first, second = pair(tmp_path, engine)
        async with first, second:
            assert await second.send_message(0, b"valve 3 is open").wait() == "delivered"
            heard = []
            first.receive_messages(lambda *one: heard.append(one))
            for node in first, second:
                # What was an answer when it came may be one to nothing by now.
                monkeypatch.setattr(node.stack, "objection", lambda _sender: "ack of nothing")
                before = node.counters(), node.paths[0].counters.copy(), values(node.stack.node)
                for _ in range(MANY):
                    node.engine.rehearse()
                after = node.counters(), node.paths[0].counters.copy(), values(node.stack.node)
                assert before == after
            assert not heard

    asyncio.run(main())


def test_who_hears_much_does_not_rehearse(tmp_path):
    async def main():
        first, second = pair(tmp_path, "python")
        async with first, second:
            assert await second.send_message(0, b"x").wait() == "delivered"
            engine, encoded = first.engine, []
            engine.rehearse()
            real = engine.stack.coder.encode
            engine.stack.coder.encode = lambda frame: encoded.append(1) or real(frame)
            engine.rehearse()
            quiet = len(encoded)
            engine.counters["frames"] += 1
            engine.rehearse()
            return quiet, len(encoded)

    assert asyncio.run(main()) == (1, 1)


def test_it_rehearses_by_itself_from_start_to_stop(tmp_path, monkeypatch):
    async def main():
        first, _ = pair(tmp_path, "python")
        done = []
        told = rehearsals(monkeypatch, MANY, done)
        async with first:
            await asyncio.wait_for(told.wait(), 30)
        count = len(done)
        await asyncio.sleep(10 * warm.EVERY_S)
        assert len(done) == count
        assert first._warmth is None

    asyncio.run(main())


def test_nobody_else_makes_it_rehearse():
    async def main():
        done = []
        warmth = Warmth(lambda: done.append(1))
        warmth._timer.cancel()
        to = warmth._socket.getsockname()
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as stranger:
            stranger.sendto(b"stranger", to)
        warmth._socket.send(b"itself")
        while not done:
            await asyncio.sleep(0)
        warmth.stop()
        return done

    assert asyncio.run(main()) == [1]


class Full(Machine):
    """A machine that has no file left."""

    def socket(self, family, kind):
        raise OSError(24, "Too many open files")


def test_a_machine_that_has_no_socket_left_says_so():
    async def main():
        with pytest.raises(LiveError, match=r"^warm = true: no socket to itself: Too many open"):
            Warmth(lambda: None)

    with on(Full()):
        asyncio.run(main())


def test_a_frame_that_cannot_be_said_again_ends_no_rehearsal(tmp_path):
    async def main():
        first, second = pair(tmp_path, "python")
        async with first, second:
            assert await second.send_message(0, b"x").wait() == "delivered"

            def encode(_frame):
                raise ValueError("no frame has this kind")

            first.engine.rehearse()
            first.engine.stack.coder.encode = encode
            first.engine.rehearse()

    asyncio.run(main())
