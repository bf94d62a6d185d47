import asyncio
import os
import tty

import pytest

from innervate.live.errors import LiveError
from innervate.live.receipts import DELIVERED
from innervate.live.serial import SerialLink
from innervate.live.serial_cables import Cables
from innervate.networks.mesh.live.node import MeshNode
from innervate.networks.mesh.live.parameters import mesh_parameters
from innervate.networks.mesh.live.stack import MeshStack
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


def test_a_speed_that_does_not_exist_is_the_users_mistake():
    async def main():
        with pytest.raises(LiveError, match="no 12345 baud"):
            await SerialLink("/dev/null", 12_345).open(print)

    asyncio.run(main())
