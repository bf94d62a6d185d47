"""A node that keeps warm rehearses while it runs; nothing comes of that but heat."""

import asyncio
import socket

import pytest

from innervate.dialect import plain
from innervate.live import warm
from innervate.live.build import build
from innervate.live.engine import Engine
from innervate.live.machine import Machine, on
from innervate.live.nodefile import load
from innervate.live.warm import Warmth
from innervate.networks.babel.packets import Packets, const
from innervate.networks.babel.protocol import fields
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
BABEL = """kind = "babel"
number = 1
warm = true
[[link]]
kind = "udp"
bind = "127.0.0.1:{}"
peers = ["127.0.0.1:9", "127.0.0.1:10"]
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


class Down(socket.socket):
    """A socket of a machine whose loopback is down."""

    def connect(self, address):
        raise OSError(101, "Network is unreachable")


class Unreachable(Machine):
    """A machine whose loopback is down, but for who is bound there already."""

    def socket(self, family, kind):
        return Down(family, kind)


def test_without_a_socket_to_itself_a_node_says_so_and_goes_on(tmp_path, capsys):
    async def main():
        first, second = pair(tmp_path, "python")
        async with first, second:
            assert await second.send_message(0, b"x").wait() == "delivered"
            return first.is_warm, second.is_warm

    with on(Unreachable()):
        assert asyncio.run(main()) == (False, False)
    why = "warm = true: no socket to itself: Network is unreachable; goes on without"
    assert capsys.readouterr().err.splitlines() == [f"n0: {why}", f"n1: {why}"]


def test_a_socket_that_cannot_be_used_is_closed():
    made = []

    class Counting(Unreachable):
        def socket(self, family, kind):
            made.append(super().socket(family, kind))
            return made[-1]

    async def main():
        with pytest.raises(OSError, match="unreachable"):
            Warmth(lambda: None)

    with on(Counting()):
        asyncio.run(main())
    assert made[0].fileno() == -1


def test_the_rest_of_a_rehearsed_datagram_is_not_taken_with_the_next(tmp_path):
    """Three Hellos came in one datagram; what another path refuses is none of them."""
    port = free_port()
    path = tmp_path / "n1.toml"
    path.write_text(BABEL.format(port))
    node = build(load(path))
    hello = plain.make("Frame", fields.FRAME)()
    hello.kind, hello.hello = const.HELLO, 400
    peer = Packets(2, node.stack.params)
    body = peer.sender + 3 * peer._tlvs(hello)
    data, taken = b"\x2a\x02" + len(body).to_bytes(2, "big") + body, []

    async def main():
        async with node:
            real = node.engine.receive
            node.engine.receive = lambda port, *at: taken.append(port) or real(port, *at)
            node._receive(node.paths[0], data)
            node.engine.rehearse()
            node.engine.rehearse()
            node.change(1, "cut")
            node._receive(node.paths[1], data)

    asyncio.run(main())
    assert taken == [0, 0, 0]


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
