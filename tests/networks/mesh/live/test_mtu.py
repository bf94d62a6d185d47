"""Frames of up to 1200 bytes on IP links; what a link cannot carry is refused, and told."""

import asyncio

import pytest

from innervate.live.build import build
from innervate.live.errors import LiveError
from innervate.live.nodefile import load
from innervate.live.receipts import DELIVERED, EXPIRED
from innervate.networks.mesh.live.parameters import mesh_parameters
from innervate.networks.mesh.live.stack import MeshStack
from tests.fixtures.node_files import LINK, of_mesh
from tests.live import time_by_hand as live_time
from tests.live.net import Mesh

LINE = [(0, 1), (1, 2)]
SERIAL = '[[link]]\nkind = "serial"\ndevice = "/dev/ttyUSB7"\n'
FILE = of_mesh(0, 2, 'role = "gateway"\n{keys}\n[protocol]\nmtu = {mtu}', LINK + SERIAL)
KEYS = f'[keys]\nuse = 1\nsecret.1 = "{"ab" * 32}"'


def test_a_frame_carries_1163_bytes_of_a_message_at_an_mtu_of_1200():
    async def main():
        async with Mesh(3, LINE, mtu=1200) as mesh:
            got, sizes = [], []
            mesh.nodes[2].receive_messages(lambda _, data: got.append(data))
            mesh.nodes[2].taps.append(lambda *said: sizes.append(len(said[3])))
            told = await mesh.nodes[0].send_message(2, bytes(range(256)) * 4 + bytes(139)).wait()
            return told, got, max(sizes)

    told, got, longest = live_time.run(main())
    assert told == DELIVERED
    assert got == [bytes(range(256)) * 4 + bytes(139)]
    assert longest == 11 + 2 + 1163 + 2  # header, two nodes of the path, CRC


def test_a_node_with_a_smaller_mtu_drops_what_is_longer_and_says_so():
    async def main():
        async with Mesh(2, [(0, 1)], mtu=1200) as mesh:
            small = mesh.nodes[1]
            small.stack.params.mtu = 127
            short = await mesh.nodes[0].send_message(1, bytes(90)).wait()
            long = await mesh.nodes[0].send_message(1, bytes(900)).wait()
            await asyncio.sleep(1)
            return short, long, small.counters(), small.troubles(), mesh.nodes[0].troubles()

    short, long, counters, told, other = live_time.run(main())
    assert (short, long) == (DELIVERED, EXPIRED)
    assert counters["dropped: longer than our MTU"] >= 3
    assert "write the same mtu into all nodes' files" in told["mtu"]
    assert other == {}


@pytest.mark.parametrize(("keys", "most"), [("", 512), (KEYS, 487)])
def test_a_link_that_carries_less_is_named(tmp_path, keys, most):
    file = tmp_path / "n0.toml"
    file.write_text(FILE.format(mtu=most, keys=keys))
    build(load(file))
    file.write_text(FILE.format(mtu=1200, keys=keys))
    said = f"mtu = 1200, but serial /dev/ttyUSB7 carries frames of at most {most} bytes; write"
    with pytest.raises(LiveError, match=said):
        build(load(file))


def test_records_have_the_room_that_the_mtu_asks_for():
    for mtu, room, kept in ((64, 114, 90), (127, 114, 90), (1200, 1187, 1163)):
        stack = MeshStack(0, 0, mesh_parameters(2, {"mtu": mtu}), 5)
        stack.on_start(0, 0)
        node = stack.node
        assert (node.q_room, node.wait_room) == (room, kept)
        assert len(node.q_body) == 48 * room
        assert len(node.wait_body) == 32 * kept
        assert len(stack.inbox.body) == room
