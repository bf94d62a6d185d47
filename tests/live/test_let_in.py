"""What the system lets in: of sealed frames those that bear an index which the node drew."""

import asyncio
import errno
import socket
import sys
from contextlib import contextmanager
from types import SimpleNamespace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from innervate.live import only_from as filters
from innervate.live import udp
from innervate.live.errors import LiveError
from innervate.live.only_from import Doors, of_peer, only_from, packed, unread
from innervate.live.receipts import DELIVERED
from innervate.live.udp import UdpLink, UdpPath
from innervate.networks.mesh.live.node import MeshNode
from innervate.networks.mesh.live.stack import MeshStack
from innervate.wire import seal
from tests.live.net import until
from tests.live.pair import network_sealer, own_sealer
from tests.live.test_udp import PARAMS, free_port, started_in

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="a filter of Linux")

WORDS = st.sampled_from([0, 1, 0x01020304, 0xFFFFFFFF])
FIRSTS = st.sampled_from([0x00, 0x45, seal.SECOND, seal.FRAME, seal.GROUP, seal.FIRST + 1, 0xFF])
COUNTERS = st.sampled_from([0, 255, 256, 257, 0x80000000, 0xFFFFFFFF])
DOORS = st.builds(
    Doors,
    st.lists(st.tuples(FIRSTS, FIRSTS), max_size=3),
    st.dictionaries(WORDS, st.sampled_from([0, 256, 0x80000000])),
)


@contextmanager
def sockets(*programs):
    """A socket behind a filter, and a neighbour of it."""
    with (
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as own,
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as far,
    ):
        far.bind(("127.0.0.1", 0))
        own.bind(("127.0.0.1", 0))
        own.setblocking(False)
        only_from(own, *(make(far.getsockname()) for make in programs))
        far.connect(own.getsockname())
        yield own, far


def comes(own, far, data):
    """True if a datagram comes in; what is sent over loopback is there at once."""
    dropped = unread(own)
    far.send(data)
    try:
        assert own.recv(99) == data
    except BlockingIOError:
        assert unread(own) == dropped + 1
        return False
    assert unread(own) == dropped
    return True


@settings(max_examples=60, deadline=None)
@given(DOORS, FIRSTS, WORDS, COUNTERS, st.integers(0, 20), st.booleans())
def test_of_sealed_frames_exactly_those_come_that_may_be_new(
    doors, first, word, counter, size, is_group
):
    data = (bytes([first]) + word.to_bytes(4, "big") + counter.to_bytes(4, "big") + bytes(11))[
        :size
    ]
    make = (lambda _: packed(doors.steps())) if is_group else (lambda peer: of_peer(peer, doors))
    least = doors.known.get(word) if size >= 5 else None
    wanted = size > 0 and (
        any(low <= first <= high for low, high in doors.anybody)
        or (least is not None and (not least or (size >= 9 and counter >= least)))
    )
    with sockets(make) as (own, far):
        assert comes(own, far, data) == wanted


def test_more_sessions_than_a_jump_can_pass_are_let_in_by_their_address():
    few, many = (Doors((), dict.fromkeys(range(count), 256)) for count in (40, 60))
    data = bytes([seal.FRAME]) + bytes(30)
    for doors, wanted in ((few, False), (many, True)):
        with sockets(lambda peer, doors=doors: of_peer(peer, doors)) as (own, far):
            assert comes(own, far, data) == wanted


@pytest.mark.parametrize("limit", [4096, 20])
def test_what_the_system_has_no_room_for_is_said_in_fewer_words_or_not_at_all(limit, monkeypatch):
    monkeypatch.setattr(filters, "STEPS_MAX", limit)
    most = packed(Doors((), dict.fromkeys(range(30), 0)).steps())
    data = bytes([seal.FRAME]) + bytes(30)
    with sockets(lambda _: most, of_peer) as (own, far):
        assert comes(own, far, data)  # by its index, or by its address
        assert comes(own, far, b"short") == (limit == 20)
        only_from(own, bytes(8 * 5000))
        assert comes(own, far, b"short")


def test_a_system_that_refuses_filters_lets_all_in():
    class Refusing(socket.socket):
        def setsockopt(self, level, name, value):
            raise OSError(errno.ENOMEM, "Cannot allocate memory")

    with Refusing(socket.AF_INET, socket.SOCK_DGRAM) as own:
        only_from(own, of_peer(("127.0.0.1", 9)))


def pair(make=network_sealer):
    """Two sealed nodes on UDP."""
    ports = [free_port(), free_port()]
    return [
        MeshNode(f"n{i}", MeshStack(i, i - 1 if i else 0, PARAMS, 7 + i),
                 [UdpLink(("127.0.0.1", ports[i]), [("127.0.0.1", ports[1 - i])])], make(i))
        for i in range(2)
    ]  # fmt: skip


@pytest.mark.parametrize("make", [network_sealer, own_sealer])
def test_a_flood_with_a_neighbours_address_is_dropped_unread_and_messages_come(make):
    async def main():
        a, b = pair(make)
        async with a, b:
            states = [await b.send_message(0, b"one").wait()]
            received, sock = a.paths[0].counters["received"], b.links[0].socket
            index = a.sealer._contacts[0].all_sessions()[0].own
            for k in range(1000):
                other = seal.header(seal.FRAME, index ^ (k + 1), k)
                sock.sendto(other + bytes(40), a.links[0].bind)
            unread_ = a.links[0].unread()
            for kind in (seal.FRAME, seal.CONTROL):
                sock.sendto(seal.header(kind, index, 999) + bytes(40), a.links[0].bind)
            states.append(await b.send_message(0, b"two").wait())
            wrong = a.sealer.dropped["sealed: wrong key or damaged"]
            return states, unread_, wrong, a.paths[0].counters["received"] - received

    states, dropped, wrong, received = asyncio.run(main())
    assert (states, dropped, wrong) == ([DELIVERED] * 2, 1000, 2)
    assert received < 30


def test_what_was_recorded_long_ago_is_dropped_unread():
    async def main():
        a, b = pair()
        async with a, b:
            await b.send_message(0, b"one").wait()
            sent, path = [], b.paths[0]
            send, path.send = path.send, lambda data: (sent.append(data), send(data))
            contact = b.sealer._contacts[0]
            for _ in range(seal.WINDOW + 2 * seal.STEP):
                contact.tell(contact.all_sessions()[0], 9)
                await asyncio.sleep(0)
            counts = a.sealer.counts
            await until(lambda: counts["control frames"] > seal.WINDOW + seal.STEP)
            a.sealer._contacts[0].listen()
            before = a.links[0].unread()
            send(sent[0])
            return a.links[0].unread() - before, await b.send_message(0, b"two").wait()

    assert asyncio.run(main()) == (1, DELIVERED)


def test_a_group_hears_its_members_while_strangers_flood_it():
    async def main():
        group = ("239.77.12.9", free_port())
        nodes = await started_in(group, network_sealer)
        states = [await nodes[0].send_message(2, b"x").wait()]
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
            own = socket.inet_aton("127.0.0.1")
            sock.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, own)
            before, received = nodes[2].links[0].unread(), nodes[2].paths[0].counters["received"]
            for k in range(500):
                sock.sendto(seal.header(seal.FRAME, k, k) + bytes(40), group)
                sock.sendto(bytes([0x45, k % 256]) + bytes(40), group)
        dropped = nodes[2].links[0].unread() - before
        states.append(await nodes[1].send_message(2, b"y").wait())
        received = nodes[2].paths[0].counters["received"] - received
        for node in nodes:
            await node.stop()
        return states, dropped, received

    states, dropped, received = asyncio.run(main())
    assert states == [DELIVERED] * 2
    assert dropped >= 1000
    assert received < 300


def test_a_neighbours_flood_takes_no_room_from_what_others_send_and_nobody_takes_the_address():
    async def main():
        ports = [free_port() for _ in range(3)]
        far = [("127.0.0.1", port) for port in ports[1:]]
        link, got = UdpLink(("127.0.0.1", ports[0]), far), []
        await link.open(lambda path, data: got.append((path.port, len(data))))
        with pytest.raises(LiveError, match="already in use"):
            await UdpLink(link.bind, far).open(print)
        with (
            socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as loud,
            socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as quiet,
        ):
            loud.bind(far[0])
            quiet.bind(far[1])
            for _ in range(2000):
                loud.sendto(bytes(900), link.bind)
            quiet.sendto(b"x", link.bind)
        assert link.unread() > 0
        while (1, 1) not in got:
            await asyncio.sleep(0)
        place = got.index((1, 1))
        link.close()
        return place

    assert asyncio.run(main()) <= 64  # nor does it wait for the rest of the flood


def test_the_first_of_very_many_neighbours_have_a_socket_each_and_the_others_share_one():
    async def main():
        port, last = free_port(), free_port()
        far = [("127.0.0.2", 20_000 + i) for i in range(35)] + [("127.0.0.1", last)]
        link, got = UdpLink(("127.0.0.1", port), far), []
        await link.open(lambda path, data: got.append((path.port, data)))
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
            sock.bind(far[-1])
            sock.sendto(b"x", link.bind)
        await until(lambda: got)
        count = len(link._sockets())
        link.close()
        return got, count

    assert asyncio.run(main()) == ([(35, b"x")], 32)


def test_where_neighbours_cannot_be_kept_apart_one_socket_hears_them_all(monkeypatch):
    def refuse(*_):
        raise OSError(errno.ENOPROTOOPT, "Protocol not available")

    async def main():
        ports = [free_port() for _ in range(3)]
        far = [("127.0.0.1", port) for port in ports[1:]]
        link, got = UdpLink(("127.0.0.1", ports[0]), far), []
        await link.open(lambda path, data: got.append((path.port, data)))
        for address in far:
            with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
                sock.bind(address)
                sock.sendto(b"x", link.bind)
        await until(lambda: len(got) == 2)
        link.close()
        return got, len(link._others)

    monkeypatch.setattr("innervate.live.udp.share", refuse)
    assert asyncio.run(main()) == ([(0, b"x"), (1, b"x")], 0)


def test_the_system_is_told_of_changes_alone():
    made, told = [], []
    link = SimpleNamespace(
        bind=("10.0.0.1", 4700),
        filter_of=lambda path, doors: made.append(doors) or doors.steps(),
        guard=lambda: told.append(len(made)),
    )
    path = UdpPath(link, ("10.0.0.2", 4700), 0)
    for known in ({7: 0}, {7: 0}, {7: 0}, {7: 5}, {7: 5}, {7: 5, 8: 0}):
        path.let_in([(0, 9)], dict(known))
    assert [len(doors.known) for doors in made] == [1, 1, 2]
    assert told == [1, 2, 3]


def test_who_has_one_address_on_two_interfaces_is_let_in_by_both(monkeypatch):
    programs = []
    monkeypatch.setattr(udp, "only_from", lambda _sock, *taken: programs.append(taken))
    link = UdpLink(("::1", 0), [("fd00::1", 4), ("fe80::1%a", 4), ("fe80::1%b", 4)])
    for path, number in zip(link.paths[1:], (1, 2), strict=True):
        path.lead_to(("fe80::1", 4, 0, number))
        link._by_address[path.address] = path
    link.socket = link
    for index, path in enumerate(link.paths):
        path.let_in([], {index: 0})
    ours = Doors([], {0: 0})
    both = [of_peer(path.address) for path in link.paths[1:]]
    assert programs[-1][0] == of_peer(link.paths[0].address, ours) + b"".join(both)
