import asyncio
import os
import termios
import tty
from contextlib import suppress

import pytest

from innervate.live import serial, serial_port
from innervate.live.errors import LiveError
from innervate.live.receipts import DELIVERED
from innervate.live.serial import SerialLink
from innervate.live.serial_cables import Cables
from innervate.networks.mesh.live.node import MeshNode
from innervate.networks.mesh.live.parameters import mesh_parameters
from innervate.networks.mesh.live.stack import MeshStack
from innervate.wire import cobs
from tests.live import time_by_hand
from tests.live.net import until

PARAMS = mesh_parameters(2, {"ack_us": 30_000, "e2e_us": 300_000})


def node(number, device):
    stack = MeshStack(number, 0 if number == 0 else -1, PARAMS, 31 * number + 7)
    return MeshNode(f"n{number}", stack, [SerialLink(device, 4_000_000)])


def test_messages_over_a_serial_cable():
    async def main():
        cables = Cables(1)
        cables.start()
        async with node(1, cables.devices[1]) as b, node(0, cables.devices[0]) as a:
            state = await a.send_message(1, bytes(range(90))).wait()
            received = b.paths[0].counters["received bytes"]
        cables.stop()
        return state, received, cables.carried[0]

    state, received, carried = asyncio.run(main())
    assert state == DELIVERED
    assert 90 < received < carried


def test_noise_on_the_line_is_counted_and_does_no_harm():
    async def main():
        master, slave = os.openpty()
        tty.setraw(slave)
        async with node(0, os.ttyname(slave)) as a:
            os.write(master, os.urandom(3000) + b"\0" + b"\x05ab\0" + bytes(20))
            await until(lambda: a.paths[0].counters["dropped: framing"] > 0)
            counters = a.counters()
        os.close(master)
        os.close(slave)
        return counters

    assert asyncio.run(main())["frames"] == 0


def test_an_unplugged_port_comes_back_by_itself(tmp_path):
    async def main():
        port = tmp_path / "tty"
        first, again = Cables(1), Cables(1)
        first.start()
        again.start()
        port.symlink_to(first.devices[0])
        a, b = node(0, str(port)), node(1, first.devices[1])
        await b.start()
        await a.start()
        assert await a.send_message(1, b"one").wait() == DELIVERED
        await b.stop()
        first.stop()  # hangs up: as an adapter that is pulled out
        await until(lambda: not a.paths[0].up)
        port.unlink()
        port.symlink_to(again.devices[0])
        b = node(1, again.devices[1])
        await b.start()
        await until(lambda: a.paths[0].up)
        await until(lambda: b.stack.node.version != 0)
        state = await a.send_message(1, b"two").wait()
        await a.stop()
        await b.stop()
        again.stop()
        return state

    assert asyncio.run(main()) == DELIVERED


class Port:
    """A serial link on one end of a pty, the other end in our hands."""

    def __init__(self):
        self.far, self.near = os.openpty()
        tty.setraw(self.near)
        os.set_blocking(self.far, False)
        self.link = SerialLink(os.ttyname(self.near), 4_000_000)
        self.path = self.link.path
        self.frames = []

    async def __aenter__(self):
        await self.link.open(lambda _, data: self.frames.append(data))
        return self

    async def __aexit__(self, *_):
        self.link.close()
        for fd in (self.far, self.near):
            with suppress(OSError):
                os.close(fd)

    def fill(self):
        """Send frames of two different bytes until there is no room; how many went."""
        while not self.path.counters["unsent: full"]:
            self.path.send(bytes([self.path.counters["sent"] % 250 + 1, 7]) * 100)
        return self.path.counters["sent"]

    async def read(self, count):
        """That many frames, as they come out at the other end."""
        decoder, found = cobs.Decoder(512), []
        while len(found) < count:
            with suppress(BlockingIOError):
                found += decoder.feed(os.read(self.far, 3000))
            await asyncio.sleep(0)
        return found


def test_what_the_line_does_not_take_at_once_waits_and_comes_in_order_then_all_is_quiet(
    monkeypatch,
):
    written = []

    def write(fd, data, write=os.write):
        count = write(fd, data)
        written.append((fd, count))
        return count

    async def main():
        async with Port() as port:
            sent = port.fill()
            assert sent * 200 > serial.WAITING_MAX
            for _ in range(5):
                port.path.send(b"no room for this one, or the next")
            assert (port.path.counters["sent"], port.path.counters["unsent: full"]) == (sent, 6)
            monkeypatch.setattr(serial_port.os, "write", write)
            got = await port.read(sent)
            assert got == [bytes([k % 250 + 1, 7]) * 100 for k in range(sent)]
            assert len(written) > 1
            written.clear()
            for _ in range(100):  # nobody is asked any more whether there is room
                await asyncio.sleep(0)
            assert written == []
            port.path.send(b"again")  # straight onto the line
            assert [count for _, count in written] == [len(cobs.encode(b"again"))]
            assert await port.read(1) == [b"again"]
            for _ in range(100):
                await asyncio.sleep(0)
            assert len(written) == 1
            return port.path.counters

    counters = asyncio.run(main())
    assert counters["unplugged"] == 0


def test_a_frame_is_kept_whole_however_full_the_line_is():
    async def main():
        async with Port() as port:
            sent = port.fill()
            assert len(port.link._waiting) > serial.WAITING_MAX
            assert len(port.link._waiting) <= serial.WAITING_MAX + len(cobs.encode(bytes(200)))
            got = await port.read(sent)
            return sent, len(set(got)), port.path.counters["sent bytes"]

    sent, different, count = asyncio.run(main())
    assert different == min(sent, 250)
    assert count == 200 * sent


def test_what_waited_when_the_plug_came_out_is_gone_and_nothing_goes_out_until_it_is_back(tmp_path):
    async def main():
        name = tmp_path / "tty"
        async with Port() as port, Port() as other:
            name.symlink_to(os.ttyname(port.near))
            link = SerialLink(str(name), 4_000_000)
            frames = []
            await link.open(lambda _, data: frames.append(data))
            while not link.path.counters["unsent: full"]:
                link.path.send(bytes([9]) * 300)
            name.unlink()
            port.link.close()
            os.close(port.near)
            os.close(port.far)  # pulled out
            await until(lambda: not link.path.up)
            sent = link.path.counters["sent"]
            link.path.send(b"nowhere")
            assert link.path.counters["unsent: unplugged"] == 1
            assert link.path.counters["unplugged"] == 1
            assert link.path.counters["sent"] == sent
            name.symlink_to(os.ttyname(other.near))
            other.link.close()
            await until(lambda: link.path.up)
            link.path.send(b"here")
            assert await other.read(1) == [b"here"]
            os.write(other.far, cobs.encode(b"there"))
            await until(lambda: frames)
            link.close()
            link.close()
            assert not link.path.up
            link.path.send(b"closed")
            assert link.path.counters["unsent: unplugged"] == 2
            return frames

    assert asyncio.run(main()) == [b"there"]


def test_a_port_that_is_closed_while_it_is_away_is_not_opened_when_it_comes(tmp_path):
    async def main():
        port = tmp_path / "tty"
        link = SerialLink(str(port), 4_000_000)
        await link.open(print)
        assert not link.path.up
        link.close()
        async with Port() as other:
            port.symlink_to(os.ttyname(other.near))
            await asyncio.sleep(4 * serial.REOPEN_S)
            return link.path.up

    assert time_by_hand.run(main()) is False


def test_a_file_that_is_no_serial_port_is_waited_for_and_let_go_of(tmp_path):
    async def main():
        path = tmp_path / "file"
        path.touch()
        before = len(os.listdir("/proc/self/fd"))
        link = SerialLink(str(path), 4_000_000)
        await link.open(print)
        await asyncio.sleep(10.1 * serial.REOPEN_S)
        assert len(os.listdir("/proc/self/fd")) == before
        assert not link.path.up
        async with Port() as port:
            port.link.close()
            path.unlink()
            path.symlink_to(os.ttyname(port.near))
            await asyncio.sleep(1.1 * serial.REOPEN_S)
            up = link.path.up
            link.close()
            return up

    assert time_by_hand.run(main()) is True


def test_a_serial_port_is_raw():
    async def main():
        async with Port() as port:
            every = bytes(range(256))
            port.path.send(every)
            assert await port.read(1) == [every]
            os.write(port.far, cobs.encode(every))
            await until(lambda: port.frames)
            mode = termios.tcgetattr(port.near)
            assert mode[:2] == [0, 0]
            assert mode[3:6] == [0, termios.B4000000, termios.B4000000]
            assert mode[2] & (termios.CSIZE | termios.PARENB | termios.CSTOPB) == termios.CS8
            return port.frames == [every]

    assert asyncio.run(main())


def test_a_speed_that_does_not_exist_is_the_users_mistake():
    async def main():
        with pytest.raises(LiveError, match="no 12345 baud"):
            await SerialLink("/dev/null", 12_345).open(print)

    asyncio.run(main())
