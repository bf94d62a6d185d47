import asyncio
import socket

import pytest

from innervate.live.errors import LiveError
from innervate.live.receipts import DELIVERED
from innervate.live.udp import MulticastLink, UdpLink
from innervate.networks.mesh.live.node import MeshNode
from innervate.networks.mesh.live.parameters import mesh_parameters
from innervate.networks.mesh.live.stack import MeshStack

PARAMS = mesh_parameters(3, {"ack_us": 30_000, "e2e_us": 300_000})


def free_port():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        sock.bind(("127.0.0.1", 0))
        return sock.getsockname()[1]


def test_a_multicast_group_is_one_channel_for_all():
    async def main():
        group = ("239.77.12.1", free_port())
        nodes = []
        for i in range(3):
            stack = MeshStack(i, 0 if i == 0 else -1, PARAMS, 7919 * (i + 1))
            nodes.append(MeshNode(f"n{i}", stack, [MulticastLink(group, "127.0.0.1")]))
        for node in reversed(nodes):
            await node.start()
        states = [await nodes[a].send_message(b, b"x").wait() for a, b in ((0, 2), (2, 1))]
        near = {row["node"] for row in nodes[1].status()["neighbours"]}
        for node in nodes:
            await node.stop()
        return states, near

    assert asyncio.run(main()) == ([DELIVERED, DELIVERED], {0, 2})


def test_strangers_are_not_listened_to_but_counted():
    async def main():
        port = free_port()
        link = UdpLink(("127.0.0.1", port), [("127.0.0.1", 9)])
        node = MeshNode("n0", MeshStack(0, 0, PARAMS, 5), [link])
        async with node:
            with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
                for _ in range(7):
                    sock.sendto(b"\x50" + bytes(8), ("127.0.0.1", port))
            while link.strangers < 7:
                await asyncio.sleep(0.005)
            return node.counters(), node.paths[0].counters["received"]

    counters, received = asyncio.run(main())
    assert counters["dropped: from a stranger"] == 7
    assert received == 0


def test_a_neighbour_with_two_cables_is_reached_over_either():
    async def main():
        ports = [free_port() for _ in range(4)]

        def link(own, other, first):
            return UdpLink(("127.0.0.1", ports[own]), [("127.0.0.1", ports[other])], first)

        a = MeshNode("a", MeshStack(0, 0, PARAMS, 5), [link(0, 1, 0), link(2, 3, 1)])
        b = MeshNode("b", MeshStack(1, -1, PARAMS, 9), [link(1, 0, 0), link(3, 2, 1)])
        states = []
        async with b, a:
            states.append(await a.send_message(1, b"both").wait())
            for dead in (0, 1):
                a.paths[dead].cut, a.paths[1 - dead].cut = True, False
                states.append(await a.send_message(1, b"one").wait())
        return states

    assert asyncio.run(main()) == [DELIVERED] * 3


def test_an_address_that_is_not_ours_is_the_users_mistake():
    async def main():
        node = MeshNode("n", MeshStack(0, 0, PARAMS, 5), [UdpLink(("192.0.2.1", 4700), [])])
        with pytest.raises(LiveError, match=r"cannot use UDP address 192\.0\.2\.1:4700"):
            await node.start()
        await node.stop()

    asyncio.run(main())
