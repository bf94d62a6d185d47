import asyncio
import errno
import socket
import sys

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from innervate.live import multicast, udp
from innervate.live.errors import LiveError
from innervate.live.machine import Machine
from innervate.live.multicast import MulticastLink
from innervate.live.only_from import of_peer, only_from, unread
from innervate.live.receipts import DELIVERED
from innervate.live.udp import UdpLink
from innervate.networks.mesh.live.node import MeshNode
from innervate.networks.mesh.live.parameters import mesh_parameters
from innervate.networks.mesh.live.stack import MeshStack
from tests.live import time_by_hand
from tests.live.time_by_hand import timed

PARAMS = mesh_parameters(3, {"ack_us": 30_000, "e2e_us": 300_000})


def free_port():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        sock.bind(("127.0.0.1", 0))
        return sock.getsockname()[1]


async def started_in(group, sealer_of=lambda i: None):
    """Three nodes of a multicast group."""
    nodes = []
    for i in range(3):
        stack = MeshStack(i, 0 if i == 0 else -1, PARAMS, 7919 * (i + 1))
        nodes.append(MeshNode(f"n{i}", stack, [MulticastLink(group, "127.0.0.1")], sealer_of(i)))
    for node in reversed(nodes):
        await node.start()
    return nodes


def test_a_multicast_group_is_one_channel_for_all():
    async def main():
        group = ("239.77.12.1", free_port())
        nodes = await started_in(group)
        states = [await nodes[a].send_message(b, b"x").wait() for a, b in ((0, 2), (2, 1))]
        near = {row["node"] for row in nodes[1].status()["neighbours"]}
        for node in nodes:
            await node.stop()
        return states, near

    assert asyncio.run(main()) == ([DELIVERED, DELIVERED], {0, 2})


async def stranger_to(link):
    """Counters of a node with that link, and frames received, after seven of a stranger."""
    node = MeshNode("n0", MeshStack(0, 0, PARAMS, 5), [link])
    async with node:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
            for _ in range(7):
                sock.sendto(b"\x50" + bytes(8), link.bind)
        while sum(n for what, n in node.counters().items() if what.startswith("dropped")) < 7:
            await asyncio.sleep(0.005)
        return node.counters(), node.paths[0].counters["received"]


def test_strangers_are_not_listened_to_but_counted(monkeypatch):
    monkeypatch.setattr(sys, "platform", "another")
    link = UdpLink(("127.0.0.1", free_port()), [("127.0.0.1", 9)])
    counters, received = asyncio.run(stranger_to(link))
    assert counters["dropped: from a stranger"] == 7
    assert received == 0


def test_on_linux_the_system_drops_and_counts_them():
    link = UdpLink(("127.0.0.1", free_port()), [("127.0.0.1", 9)])
    counters, received = asyncio.run(stranger_to(link))
    assert counters["dropped by the system: not for this node, or no room"] == 7
    assert counters["dropped: from a stranger"] == received == 0


PLACES = st.tuples(st.sampled_from(["127.0.0.1", "127.0.0.2", "127.9.0.1"]), st.integers(0, 3))


@settings(max_examples=25, deadline=None)
@given(st.lists(PLACES, max_size=254), PLACES)
def test_the_system_lets_in_exactly_the_neighbours(peers, who):
    ports = [free_port() for _ in range(4)]
    peers = [(host, ports[k]) for host, k in peers]
    with (
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as own,
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as far,
    ):
        own.bind(("127.0.0.1", 0))
        own.setblocking(False)
        only_from(own, b"".join(map(of_peer, peers)))
        far.bind((who[0], ports[who[1]]))
        far.sendto(b"x", own.getsockname())
        try:  # what is sent over loopback is there when sendto returns
            came = own.recvfrom(9) == (b"x", far.getsockname())
        except BlockingIOError:
            came = False
        assert came == (far.getsockname() in peers)
        assert unread(own) == (not came)


class Flaky(socket.socket):
    """A socket on an interface that can go away."""

    away = False  # nothing is received: the interface went down
    gone = False  # it is not there either for a new socket
    refused = 0  # so many receptions say that a neighbour is not there yet

    def recvfrom(self, *args):
        if Flaky.refused:
            Flaky.refused -= 1
            raise ConnectionRefusedError
        if Flaky.away:
            raise OSError(errno.ENETDOWN, "Network is down")
        return super().recvfrom(*args)

    def bind(self, where):
        if Flaky.gone:
            raise OSError(errno.EADDRNOTAVAIL, "Cannot assign requested address")
        super().bind(where)


@pytest.fixture
def flaky(monkeypatch):
    monkeypatch.setattr(Machine, "socket", lambda _, family, kind: Flaky(family, kind))
    for name, value in (("away", False), ("gone", False), ("refused", 0)):
        monkeypatch.setattr(Flaky, name, value)


async def passes(seconds):
    """Simulated time goes by, and what is under way in sockets arrives."""
    for _ in range(20):
        await asyncio.sleep(0)
    await asyncio.sleep(seconds)


def poke(port, near):
    """A datagram from a neighbour's port, so that a socket looks what came."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        sock.bind(("127.0.0.1", near))
        sock.sendto(b"x", ("127.0.0.1", port))


def test_paths_are_down_while_their_interface_is_and_come_back_by_themselves(flaky):
    async def main():
        port, near, far = free_port(), free_port(), free_port()
        link = UdpLink(("127.0.0.1", port), [("127.0.0.1", near), ("127.0.0.1", far)])
        got = []
        await link.open(lambda path, data: got.append((path.port, data)))
        assert [path.up for path in link.paths] == [True, True]
        Flaky.away = Flaky.gone = True
        poke(port, near)
        await passes(0.1)
        assert [path.up for path in link.paths] == [False, False]
        link.paths[1].send(b"lost")
        await passes(4.6 * udp.REOPEN_S)  # tried again and again
        assert [path.up for path in link.paths] == [False, False]
        link.paths[1].send(b"lost")
        assert link.paths[1].counters == {"unsent: closed": 2}
        Flaky.away = Flaky.gone = False
        await passes(1.1 * udp.REOPEN_S)
        assert [path.up for path in link.paths] == [True, True]
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
            sock.bind(("127.0.0.1", far))
            sock.setblocking(False)
            sock.sendto(b"in", ("127.0.0.1", port))
            link.paths[1].send(b"out")
            await passes(0.1)
            assert sock.recv(99) == b"out"
        assert got == [(1, b"in")]
        assert link.paths[1].counters["sent"] == 1
        link.close()
        return link

    link = time_by_hand.run(main())
    assert link.socket is None


@timed
async def test_a_link_that_is_closed_while_its_interface_is_away_stays_closed(flaky):
    port, near = free_port(), free_port()
    link = UdpLink(("127.0.0.1", port), [("127.0.0.1", near)])
    await link.open(print)
    Flaky.away = Flaky.gone = True
    poke(port, near)
    await passes(0.1)
    link.close()
    Flaky.away = Flaky.gone = False
    await passes(5 * udp.REOPEN_S)
    assert link.socket is None
    assert not link.paths[0].up
    await link.open(print)  # until it is opened again
    assert link.paths[0].up
    link.close()
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        sock.bind(("127.0.0.1", port))  # given back to the system


def test_a_neighbour_that_is_not_there_yet_takes_no_path_away(flaky):
    async def main():
        port, near = free_port(), free_port()
        link, got = UdpLink(("127.0.0.1", port), [("127.0.0.1", near)]), []
        await link.open(lambda path, data: got.append(data))
        Flaky.refused = 1
        poke(port, near)
        await passes(0.1)
        up = link.paths[0].up
        link.close()
        return up, got, Flaky.refused

    assert time_by_hand.run(main()) == (True, [b"x"], 0)


def test_who_receives_may_close_the_link():
    async def main():
        port, near = free_port(), free_port()
        link, got = UdpLink(("127.0.0.1", port), [("127.0.0.1", near)]), []

        def receive(_path, data):
            got.append(data)
            link.close()

        await link.open(receive)
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
            sock.bind(("127.0.0.1", near))
            sock.sendto(b"one", ("127.0.0.1", port))
            sock.sendto(b"two", ("127.0.0.1", port))
            await passes(0.1)
        return got, link.socket

    assert time_by_hand.run(main()) == ([b"one"], None)


def test_a_flood_of_datagrams_is_read_in_batches():
    async def main():
        port, near = free_port(), free_port()
        link, got, steps = UdpLink(("127.0.0.1", port), [("127.0.0.1", near)]), [], []
        await link.open(lambda _, data: got.append(data))
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
            sock.bind(("127.0.0.1", near))
            for k in range(udp.BATCH + 5):
                sock.sendto(b"%d" % k, ("127.0.0.1", port))
        while len(got) < udp.BATCH + 5:
            await asyncio.sleep(0)
            steps.append(len(got))
        link.close()
        return got, steps

    got, steps = time_by_hand.run(main())
    assert got == [b"%d" % k for k in range(udp.BATCH + 5)]
    assert udp.BATCH in steps  # timers had their turn between


def test_what_cannot_be_sent_is_counted_by_reason():
    async def main():
        link = UdpLink(("127.0.0.1", 0), [("127.0.0.1", 9), ("192.0.2.1", 9)])
        await link.open(print)
        link.paths[0].send(b"fits")
        link.paths[0].send(bytes(70_000))
        link.paths[1].send(b"nowhere from here")
        link.close()
        return [path.counters for path in link.paths]

    here, there = asyncio.run(main())
    assert here == {"sent": 1, "sent bytes": 4, "unsent: Message too long": 1}
    assert "sent" not in there


def test_a_group_on_one_machine_is_heard_by_all_members_the_sender_too_and_no_router():
    async def main():
        group = ("239.77.12.3", free_port())
        links = [MulticastLink(group, "127.0.0.1", port) for port in (0, 4)]
        got = []
        for i, link in enumerate(links):
            await link.open(lambda path, data, i=i: got.append((i, path.port, data)))
        links[0].paths[0].send(b"a")
        await passes(0.1)
        links[1].paths[0].send(b"b")
        await passes(0.1)
        # The loopback interface brings frames back in any case; others do as they are told.
        told = [
            links[0].socket.getsockopt(socket.IPPROTO_IP, what)
            for what in (socket.IP_MULTICAST_TTL, socket.IP_MULTICAST_LOOP)
        ]
        for link in links:
            link.close()
        return sorted(got), told

    assert time_by_hand.run(main()) == (
        [(0, 0, b"a"), (0, 0, b"b"), (1, 4, b"a"), (1, 4, b"b")], [1, 1])  # fmt: skip


@pytest.mark.parametrize(
    ("code", "up"), [(None, True), (errno.EADDRINUSE, True), (errno.ENODEV, False)]
)
def test_a_member_joins_anew_now_and_then_and_is_down_while_it_cannot(code, up, monkeypatch):
    joined = []

    class Joining(socket.socket):
        def setsockopt(self, level, name, value):
            if name == socket.IP_ADD_MEMBERSHIP:
                joined.append(value)
                if code is not None and 1 < len(joined) < 4:
                    raise OSError(code, "why")
                if len(joined) > 1:
                    return
            super().setsockopt(level, name, value)

    async def main():
        monkeypatch.setattr(Machine, "socket", lambda _, family, kind: Joining(family, kind))
        link = MulticastLink(("239.77.12.4", free_port()), "127.0.0.1")
        await link.open(print)
        assert (link.paths[0].up, len(joined)) == (True, 1)
        await passes(2.5 * multicast.RENEW_S)
        assert (link.paths[0].up, len(joined)) == (up, 3)
        await passes(multicast.RENEW_S)
        assert (link.paths[0].up, len(joined)) == (True, 4)
        link.close()
        await passes(5 * multicast.RENEW_S)
        return len(joined)

    assert time_by_hand.run(main()) == 4
    assert set(joined) == {socket.inet_aton("239.77.12.4") + socket.inet_aton("127.0.0.1")}


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


@pytest.mark.skipif(sys.platform != "linux", reason="the system counts them on Linux")
def test_what_the_system_dropped_is_counted_when_the_socket_is_gone_too():
    async def main():
        port = free_port()
        link = UdpLink(("127.0.0.1", port), [("127.0.0.1", free_port())])
        await link.open(print)
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as stranger:
            for _ in range(3):
                stranger.sendto(b"x", ("127.0.0.1", port))
            counts = [link.unread()]
            link.close()
            counts.append(link.unread())
            await link.open(print)
            counts.append(link.unread())
            stranger.sendto(b"x", ("127.0.0.1", port))
            counts.append(link.unread())
        link.close()
        return [*counts, link.unread()]

    assert asyncio.run(main()) == [3, 3, 3, 4, 4]
