"""A process that was stopped for long: what waited meanwhile is too old for others."""

import asyncio
import os
import socket
import tty
from contextlib import contextmanager, suppress

import pytest

from innervate.dialect.arith import HALF16, MASK16, MASK30
from innervate.live.receipts import ACCEPTED, DELIVERED, EXPIRED
from innervate.live.serial import SerialLink
from innervate.live.udp import UdpLink
from innervate.wire import cobs
from tests.live import time_by_hand
from tests.live.net import Mesh
from tests.networks.mesh.live.test_order import until_simulated

PAIR = [(0, 1)]
PROFILE = {"ack_us": 5000, "e2e_us": 30_000}
END = b"\0"  # of a frame on a line
BEGUN = "begun anew: did not run for long"


def stop_all(seconds):
    """Nobody runs for so long; all timers are late then."""
    asyncio.get_running_loop()._passing.passed += seconds


def held_up(seconds, **settings):
    """Two nodes, one of which sends, and then neither runs for a while; what comes of it."""

    async def main():
        mesh = Mesh(2, PAIR, **PROFILE | settings)
        for node in mesh.nodes:
            await node.start()
        await until_simulated(mesh.has_tables)
        heard = []
        mesh.nodes[1].receive_messages(lambda _, payload: heard.append(payload))
        mesh.cut(0, 1)
        before = mesh.nodes[0].send_message(1, b"before")
        await asyncio.sleep(0.02)
        stop_all(seconds)
        mesh.cut(0, 1, cut=False)
        state = await before.wait()
        await until_simulated(mesh.has_tables)
        after = mesh.nodes[0].send_message(1, b"after")
        found = state, before.reason, await after.wait(), heard
        begun = [node.counters()[BEGUN] for node in mesh.nodes]
        numbers = before.seq, after.seq
        for node in mesh.nodes:
            await node.stop()
        return found, begun, numbers

    return time_by_hand.run(main())


# 1,073 s later its clock of 30 bits shows the same again.
@pytest.mark.parametrize("seconds", [16, 100, (MASK30 + 1) / 1e6])
def test_what_was_under_way_has_expired_and_says_why(seconds):
    found, begun, (old, new) = held_up(seconds)
    why = f"the node did not run for {seconds:.0f} s"
    assert found == (EXPIRED, why, DELIVERED, [b"after"])
    assert begun == [1, 1]
    assert 0 < (new - old) & MASK16 < HALF16


@pytest.mark.parametrize("seconds", [16, (MASK30 + 1) / 1e6])
def test_what_is_sent_first_after_a_long_stop_is_no_part_of_what_has_expired(seconds):
    async def main():
        mesh = Mesh(2, PAIR, **PROFILE)
        for node in mesh.nodes:
            await node.start()
        await until_simulated(mesh.has_tables)
        mesh.cut(0, 1)
        before = mesh.nodes[0].send_message(1, b"before")
        await asyncio.sleep(0.02)
        stop_all(seconds)
        mesh.cut(0, 1, cut=False)
        after = mesh.nodes[0].send_message(1, b"after")
        found = before.state, before.reason, after.state
        await after.wait()
        for node in mesh.nodes:
            await node.stop()
        return found, after.reason

    why = f"the node did not run for {seconds:.0f} s"
    found, after = time_by_hand.run(main())
    assert found == (EXPIRED, why, ACCEPTED)
    assert after != why  # as of any message before there are ways


def test_a_robot_that_says_where_it_is_first_after_a_long_stop_begins_anew_before():
    async def main():
        mesh = Mesh(2, PAIR, **PROFILE)
        robot = mesh.nodes[1]
        robot.stack.node.robot = 1
        async with robot:
            stop_all(16)
            robot.locate((1.0, 2.0))
            return robot.counters()[BEGUN], robot.status()["robot"]["at_cm"]

    assert time_by_hand.run(main()) == (1, [1, 2])


@pytest.mark.parametrize(("seconds", "settings"), [(14, {}), (100, {"tick_us": 2_000_000})])
def test_a_while_that_others_remember_is_no_matter(seconds, settings):
    found, begun, _ = held_up(seconds, **settings)
    assert found[2:] == (DELIVERED, found[3])
    assert found[3][-1] == b"after"
    assert begun == [0, 0]


def test_datagrams_that_wait_at_a_socket_are_thrown_away():
    async def main():
        taken = []
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as peer:
            peer.bind(("127.0.0.1", 0))
            link = UdpLink(("127.0.0.1", 0), [peer.getsockname()])
            await link.open(lambda _, data: taken.append(data))
            for data in (b"old", b"older", b"new"):
                if data == b"new":
                    link.forget()
                peer.sendto(data, link.socket.getsockname())
            await asyncio.sleep(0.05)
            link.close()
            link.forget()
        return taken

    assert asyncio.run(main()) == [b"new"]


@contextmanager
def serial_port():
    """The other end of a serial port, and a link on it."""
    master, slave = os.openpty()
    tty.setraw(slave)
    link = SerialLink(os.ttyname(slave), 4_000_000)
    yield master, link
    link.close()
    os.close(master)
    os.close(slave)


def test_what_was_read_from_a_serial_port_together_is_thrown_away_together():
    """The first of several old frames shows how late it is; those read with it are as old."""

    async def main():
        taken = []

        def take(_, data):
            taken.append(data)
            if data == b"old":
                link.forget()

        with serial_port() as (master, link):
            await link.open(take)
            os.write(master, b"\x04old\x00\x04old\x00")
            await asyncio.sleep(0.05)
            os.write(master, b"\x04new\x00")
            await asyncio.sleep(0.05)
        return taken

    assert asyncio.run(main()) == [b"old", b"new"]


def test_bytes_that_wait_at_a_serial_port_are_thrown_away():
    async def main():
        taken = []
        with serial_port() as (master, link):
            link.forget()
            await link.open(lambda _, data: taken.append(data))
            os.write(master, b"\x04old\x00\x04ol")
            await asyncio.sleep(0.05)
            os.write(master, b"d\x00\x04old\x00")
            link.forget()
            os.write(master, b"\x04new\x00")
            await asyncio.sleep(0.05)
            link.write(b"x" * 1_000_000)
            waiting = len(link._waiting)
            link.forget()
            left = bytes(link._waiting)
        return taken, waiting > 0, left

    assert asyncio.run(main()) == ([b"old", b"new"], True, END)


def test_half_a_frame_that_was_forgotten_does_no_harm_to_the_next():
    async def main():
        master, slave = os.openpty()
        tty.setraw(slave)
        os.set_blocking(master, False)
        link = SerialLink(os.ttyname(slave), 4_000_000)
        await link.open(lambda *_: None)
        while not link._waiting:
            link.path.send(b"old" * 100)
        link.forget()
        link.path.send(b"new")
        far, found = cobs.Decoder(512), []
        while b"new" not in found:
            with suppress(BlockingIOError):
                found += far.feed(os.read(master, 3000))
            await asyncio.sleep(0)
        link.close()
        os.close(master)
        os.close(slave)
        return far.dropped

    async def in_time():
        async with asyncio.timeout(5):
            return await main()

    assert asyncio.run(in_time()) <= 1
