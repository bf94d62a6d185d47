"""Neighbours by name, and over IPv6."""

import asyncio
import errno
import socket
from types import SimpleNamespace

import pytest

from innervate.live import udp
from innervate.live.build import build
from innervate.live.errors import LiveError
from innervate.live.machine import Machine, on
from innervate.live.nodefile import load
from innervate.live.only_from import Doors, of_peer, only_from
from innervate.live.udp import UdpLink
from tests.live import time_by_hand
from tests.live.net import until
from tests.live.test_udp import free_port, passes

HERE = "127.0.0.1"


class Named(Machine):
    """A machine that knows names: what each stands for, or why for nothing."""

    def __init__(self, **names):
        self.names, self.asked = names, []

    def monotonic_ns(self):
        return round(1e9 * asyncio.get_running_loop().time())

    async def addresses(self, host, port, family):
        self.asked.append(host)
        found = self.names[host]
        if isinstance(found, Exception):
            raise found
        return [(one, port) for one in found]


def with_names(test, **names):
    """Run under simulated time, on such a machine."""

    async def main():
        known = Named(**names)
        with on(known):
            return await test(known)

    return time_by_hand.run(main())


UNKNOWN = socket.gaierror(socket.EAI_NONAME, "Name or service not known")


def test_a_name_that_leads_nowhere_is_said_and_asked_for_until_it_does():
    async def test(known):
        port = free_port()
        link, got = UdpLink((HERE, 0), [("robot", port)]), []
        await link.open(lambda path, data: got.append(data))
        (path,) = link.paths
        path.send(b"lost")
        said = path.trouble
        known.names["robot"] = [HERE]
        await passes(udp.LOOK_S + 0.1)
        far = UdpLink((HERE, port), [link.socket.getsockname()])
        await far.open(lambda path, data: got.append(data))
        path.send(b"there")
        await passes(0.1)
        far.paths[0].send(b"and back")
        await passes(0.1)
        link.close()
        far.close()
        asked = len(known.asked)
        await passes(10 * udp.LOOK_S)
        assert len(known.asked) == asked
        return said, path, got, port

    said, path, got, port = with_names(test, robot=UNKNOWN)
    assert said == f"udp robot:{port}: Name or service not known; trying again"
    assert (path.up, path.trouble, path.again) == (True, "", f"leads to {HERE}:{port}")
    assert path.far == f"udp {HERE}:{port}"
    assert path.counters["unsent: no address"] == 1
    assert got == [b"there", b"and back"]


def test_a_neighbour_that_is_heard_is_not_looked_up_and_one_that_is_not_is_where_its_name_leads():
    async def test(known):
        link = UdpLink((HERE, 0), [("near", 9), ("gone", 9)])
        await link.open(print)
        await passes(0.5)  # looks are between what is looked at
        near, gone = link.paths
        for _ in range(20):
            near.heard_at = udp.clock_us()
            await passes(1)
        asked = set(known.asked[2:])
        known.names["gone"] = UNKNOWN  # the names' server is away
        await passes(udp.LOOK_S)
        kept, trouble = gone.address, gone.trouble
        known.names["gone"] = ["127.0.0.3", "127.0.0.1", "127.0.0.2"]
        turns = []
        for _ in range(3):
            await passes(udp.LOOK_S)
            turns.append(gone.address[0])
        await passes(1)
        gone.heard_at = udp.clock_us()  # it is there, and says little
        for seconds in (udp.MUTE_US / 1e6 - 1, udp.LOOK_S + 2):
            await passes(seconds)
            turns.append(gone.address[0])
        link.close()
        return asked, kept, trouble, turns, near.address

    found = with_names(test, near=["127.0.0.1"], gone=["127.0.0.2"])
    turns = ["127.0.0.3", "127.0.0.2", "127.0.0.3"]  # of which the other neighbour's is none
    turns += ["127.0.0.3", "127.0.0.2"]
    assert found == ({"gone"}, ("127.0.0.2", 9), "", turns, ("127.0.0.1", 9))


def test_two_names_for_one_neighbour_are_one_too_many():
    async def test(known):
        link = UdpLink((HERE, 0), [("127.0.0.2", 9), ("other", 9)])
        await link.open(print)
        link.close()
        return link.paths[1].trouble

    why = "leads to another neighbour's address; trying again"
    assert with_names(test, other=["127.0.0.2"]) == f"udp other:9: {why}"


def test_a_link_bound_to_a_name_is_called_by_its_address():
    async def test(known):
        link = UdpLink(("me", 0), [(HERE, 9)])
        await link.open(print)
        link.close()
        with pytest.raises(LiveError, match="cannot use UDP address nobody:4: Name or service"):
            await UdpLink(("nobody", 4), [(HERE, 9)]).open(print)
        return link.paths[0].own

    assert with_names(test, me=[HERE], nobody=UNKNOWN) == f"udp {HERE}:0"


def test_the_system_looks_names_up_and_nobody_waits_for_it_at_the_end():
    async def main():
        told = await Machine().addresses("localhost", 7, socket.AF_INET)
        with pytest.raises(OSError, match=r"not known|No address|Temporary failure"):
            await Machine().addresses("no-such-robot.invalid", 7, socket.AF_INET)
        return told

    assert asyncio.run(main()) == [("127.0.0.1", 7)]


class Hung(Named):
    """One that is never told anything of the name "hung"."""

    async def addresses(self, host, port, family):
        if host == "hung":
            await asyncio.Event().wait()
        return await super().addresses(host, port, family)


def test_a_name_of_which_nothing_is_said_holds_up_no_other():
    async def main():
        known = Hung(robot=[HERE], moves=[HERE])
        with on(known):
            link = UdpLink((HERE, 0), [("hung", 7), ("robot", 8), ("moves", 9)])
            began = asyncio.get_running_loop().time()
            await link.open(print)
            took_s = asyncio.get_running_loop().time() - began
            at = [path.address for path in link.paths]
            said = link.paths[0].trouble
            known.names["moves"] = ["127.0.0.2"]
            await passes(udp.LOOK_S + 0.1)
            link.close()
            return took_s, at, link.paths[2].address, said

    took_s, at, moved, said = time_by_hand.run(main())
    assert took_s == pytest.approx(udp.FIRST_S)
    assert at == [None, (HERE, 8), (HERE, 9)]
    assert moved == ("127.0.0.2", 9)
    assert said == "udp hung:7: no answer yet; waiting for it"


def mesh_of_two(tmp_path, *links, head=""):
    """The nodes of two files, each with links of (own address, neighbours)."""
    for i, own in enumerate(links):
        tables = [f'[[link]]\nkind = "udp"\nbind = "{bind}"\npeers = {peers!r}\n'
                  for bind, peers in own]  # fmt: skip
        (tmp_path / f"n{i}.toml").write_text(
            f'kind = "mesh"\nnumber = {i}\nnodes = 2\nrole = "{("gateway", "node")[i]}"\n'
            f"{head}{''.join(tables)}"
        )
    return [build(load(tmp_path / f"n{i}.toml")) for i in range(2)]


def test_while_names_are_waited_for_a_node_neither_hears_nor_takes_messages(tmp_path):
    ports = [free_port() for _ in range(3)]

    async def main():
        with on(Hung()):
            there, late = mesh_of_two(
                tmp_path,
                [(f"{HERE}:{ports[0]}", [f"{HERE}:{ports[1]}"])],
                [(f"{HERE}:{ports[1]}", [f"{HERE}:{ports[0]}", "hung:7"]),
                 (f"{HERE}:{ports[2]}", ["hung:8"])],
            )  # fmt: skip
            loop = asyncio.get_running_loop()
            async with there:
                began, starting = loop.time(), asyncio.ensure_future(late.start())
                await passes(udp.FIRST_S / 2)
                early = late.idle(), late.counters().total(), late.send_message(0, b"x").state
                await starting
                took_s = loop.time() - began
                await passes(3)
                state = late.send_message(0, b"y")
                await passes(1)
                await late.stop()
            starting = asyncio.ensure_future(late.start())
            await passes(udp.FIRST_S / 2)
            await late.stop()
            with pytest.raises(LiveError, match="n1: was stopped before it was started"):
                await starting
            return early, took_s, state.state, late.idle()

    early, took_s, state, idle = time_by_hand.run(main())
    assert early == ("node not started", 0, "refused")
    assert took_s == pytest.approx(udp.FIRST_S)
    assert (state, idle) == ("delivered", "node not started")


def test_sessions_end_where_names_lead_elsewhere(tmp_path):
    """Who answers for both names can take nobody's session through addresses of its own."""
    ports, elsewhere = [free_port(), free_port()], "127.0.0.2"

    def relay(socks, nearer):
        data, _ = socks[nearer].recvfrom(2048)  # it poses as node `nearer`
        socks[1 - nearer].sendto(data, (HERE, ports[nearer]))

    async def test(known):
        nodes = mesh_of_two(
            tmp_path,
            [(f"{HERE}:{ports[0]}", [f"b:{ports[1]}"])],
            [(f"{HERE}:{ports[1]}", [f"a:{ports[0]}"])],
            head=f'[keys]\nuse = 1\nsecret.1 = "{"ab" * 32}"\n',
        )
        socks = [socket.socket(socket.AF_INET, socket.SOCK_DGRAM) for _ in ports]
        for nearer, (sock, port) in enumerate(zip(socks, ports, strict=True)):
            sock.bind((elsewhere, port))
            asyncio.get_running_loop().add_reader(sock.fileno(), relay, socks, nearer)
        async with nodes[0], nodes[1]:
            await passes(5)
            before = nodes[1].send_message(0, b"x")
            await passes(1)
            known.names.update(a=[elsewhere], b=[elsewhere])
            for what in ("cut", "restore"):
                for node in nodes:
                    node.change(0, what)
                await passes(2.5 * udp.LOOK_S)
            led = {node.paths[0].address[0] for node in nodes}
            relayed = nodes[1].send_message(0, b"y")
            await passes(30)
            known.names.update(a=[HERE], b=[HERE])
            await passes(2.5 * udp.LOOK_S)
            back = nodes[1].send_message(0, b"z")
            await passes(5)
            why = nodes[1].counters()["dropped: sealed: from another place"]
        for sock in socks:
            asyncio.get_running_loop().remove_reader(sock.fileno())
            sock.close()
        return before.state, led, relayed.state, why, back.state

    before, led, relayed, why, back = with_names(test, a=[HERE], b=[HERE])
    assert (before, led, relayed, back) == ("delivered", {elsewhere}, "expired", "delivered")
    assert why


def sealed_mesh(tmp_path, *binds):
    """Two nodes with a key, each with the other as its only neighbour."""
    for i, own in enumerate(binds):
        (tmp_path / f"n{i}.toml").write_text(
            f'kind = "mesh"\nnumber = {i}\nnodes = 2\nrole = "{("gateway", "node")[i]}"\n'
            f'[keys]\nuse = 1\nsecret.1 = "{"ab" * 32}"\n'
            f'[[link]]\nkind = "udp"\nbind = "{own[0]}"\npeers = ["{own[1]}"]\n'
        )
    return [build(load(tmp_path / f"n{i}.toml")) for i in range(2)]


@pytest.mark.parametrize("host", ["[::1]", "localhost"])
def test_sealed_nodes_reach_each_other(tmp_path, host):
    ports = [free_port(), free_port()]
    wide = "[::]" if "[" in host else "0.0.0.0"
    nodes = sealed_mesh(
        tmp_path,
        (f"{wide}:{ports[0]}", f"{host}:{ports[1]}"),
        (f"{host}:{ports[1]}", f"{host}:{ports[0]}"),
    )

    async def main():
        async with nodes[0], nodes[1]:
            await until(lambda: nodes[1].status()["table"])
            return await nodes[1].send_message(0, b"hello").wait(), nodes[1].status()

    state, told = asyncio.run(main())
    assert state == "delivered"
    at = "[::1]" if "[" in host else HERE
    assert told["paths"][0]["own"] == f"udp {at}:{ports[1]}"
    assert told["paths"][0].get("far", told["paths"][0]["name"]) == f"udp {at}:{ports[0]}"


@pytest.mark.parametrize("peers", [[("::1", 0)], [("::1", 0), ("::1", 1)]])
def test_of_ipv6_the_system_lets_in_what_is_for_us(peers):
    """Of a neighbour with the right index; of strangers and other indices nothing."""
    socks = [socket.socket(socket.AF_INET6, socket.SOCK_DGRAM) for _ in range(4)]
    for sock in socks:
        sock.bind(("::1", 0))
        sock.settimeout(0.2)
    own, near, other, stranger = socks
    known = [near.getsockname(), other.getsockname()]
    doors = Doors([(0xD1, 0xD1)], {7: 0})
    only_from(own, b"".join(of_peer(one, doors) for one in known))
    wrong = b"\xc0" + (8).to_bytes(4, "big") + bytes(9)
    right = b"\xc0" + (7).to_bytes(4, "big") + bytes(9)
    for sock, data in ((stranger, right), (near, wrong), (near, right), (other, b"\xd1call")):
        sock.sendto(data, own.getsockname())
    got = [own.recvfrom(99)[0] for _ in range(2)]
    with pytest.raises(TimeoutError):
        own.recvfrom(99)
    for sock in socks:
        sock.close()
    assert got == [right, b"\xd1call"]


def test_neighbours_of_ipv6_have_rooms_of_their_own():
    async def main():
        socks = [socket.socket(socket.AF_INET6, socket.SOCK_DGRAM) for _ in range(3)]
        for sock in socks:
            sock.bind(("::1", 0))
        link, got = UdpLink(("::1", 0), [sock.getsockname()[:2] for sock in socks]), []
        await link.open(lambda path, data: got.append((path.port, data)))
        for i, sock in enumerate(socks):
            sock.sendto(bytes([i]), link.socket.getsockname())
        await passes(0.1)
        held = len(link._others)
        link.close()
        for sock in socks:
            sock.close()
        return sorted(got), held

    assert time_by_hand.run(main()) == ([(0, b"\0"), (1, b"\1"), (2, b"\2")], 2)


def test_who_moved_is_let_in_from_there_and_others_have_their_rooms_still():
    async def test(known):
        socks = [socket.socket(socket.AF_INET, socket.SOCK_DGRAM) for _ in range(3)]
        for sock, host in zip(socks, ("127.0.0.1", "127.0.0.2", "127.0.0.3"), strict=True):
            sock.bind((host, 0 if sock is socks[0] else socks[0].getsockname()[1]))
        port = socks[0].getsockname()[1]
        link, got = UdpLink((HERE, 0), [("a", port), ("b", port)]), []
        await link.open(lambda path, data: got.append((path.port, data)))
        known.names["b"] = ["127.0.0.3"]
        await passes(udp.LOOK_S + 0.1)
        for i, sock in enumerate(socks):
            sock.sendto(bytes([i]), link.socket.getsockname())
        await passes(0.1)
        link.close()
        for sock in socks:
            sock.close()
        return sorted(got)

    found = with_names(test, a=["127.0.0.1"], b=["127.0.0.2"])
    assert found == [(0, b"\0"), (1, b"\2")]


def test_an_interface_that_comes_back_with_another_address_is_told(monkeypatch):
    link = UdpLink(("0.0.0.0", 4700), [("10.0.0.2", 4700)])
    (path,) = link.paths
    path.reached_from = "10.0.0.1:4700"
    error = [OSError(errno.ENETUNREACH, "Network is unreachable"), None, None]
    own = "10.0.0.9:4700"

    def sendto(data, address):
        if why := error.pop(0):
            raise why

    link.socket = SimpleNamespace(sendto=sendto)
    monkeypatch.setattr(path, "bound_ends", lambda: (own, "10.0.0.2:4700"))
    path.send(b"a")
    assert path.trouble
    path.send(b"b")
    assert (path.trouble, path.again) == ("", f"there again, reached from {own}")
    path.trouble = "again"
    path.send(b"c")
    assert path.again == ""
