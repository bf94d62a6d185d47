"""Which ends a path over UDP names, and what becomes of a group whose interface is away."""

import asyncio
import errno

from innervate.live import multicast, udp
from innervate.live.machine import Machine
from innervate.live.multicast import MulticastLink
from innervate.live.udp import UdpLink
from tests.live import time_by_hand
from tests.live.test_udp import free_port


class Routed:
    """A socket of a machine with an interface for each neighbour."""

    def __init__(self, *_):
        self.where = None

    def connect(self, where):
        if where[0] == "10.9.9.9":
            raise OSError(errno.ENETUNREACH, "Network is unreachable")
        self.where = where

    def getsockname(self):
        return f"{self.where[0][:-1]}7", 54_321

    def close(self):
        closed.append(self.where)


closed = []


def test_who_listens_on_every_interface_names_the_one_that_leads_to_a_neighbour(monkeypatch):
    monkeypatch.setattr(Machine, "socket", Routed)
    closed.clear()
    peers = [("10.0.1.2", 47), ("10.0.2.2", 48), ("10.9.9.9", 49)]
    ends = [path.bound_ends() for path in UdpLink(("0.0.0.0", 4700), peers).paths]
    assert ends == [("10.0.1.7:4700", "10.0.1.2:47"), ("10.0.2.7:4700", "10.0.2.2:48"),
                    ("0.0.0.0:4700", "10.9.9.9:49")]  # fmt: skip
    assert closed == [*peers[:2], None]
    (path,) = UdpLink(("10.0.1.7", 4700), peers[:1]).paths
    assert (path.own, path.name) == ("udp 10.0.1.7:4700", "udp 10.0.1.2:47")
    assert path.bound_ends() == path.ends == ("10.0.1.7:4700", "10.0.1.2:47")
    (path,) = UdpLink(("10.0.1.7", 0), peers[:1]).paths  # any port: nobody can know it
    assert path.bound_ends() == ("", "")
    assert len(closed) == 3


def test_a_group_whose_interface_is_away_is_joined_again_when_it_is_back():
    async def main():
        wrong = []
        asyncio.get_running_loop().set_exception_handler(lambda _, what: wrong.append(what))
        link = MulticastLink(("239.77.12.5", free_port()), "127.0.0.1")
        await link.open(lambda *_: None)
        make, link._make = link._make, nowhere
        link._lost(OSError(errno.ENODEV, "No such device"))
        assert not link.paths[0].up
        await asyncio.sleep(2.2 * multicast.RENEW_S)
        link.paths[0].send(b"lost")
        assert (wrong, link.socket, link.paths[0].up) == ([], None, False)
        link._make = make
        await asyncio.sleep(1.1 * udp.REOPEN_S)
        assert link.paths[0].up
        link.paths[0].send(b"goes")
        link.close()
        return link.paths[0].counters

    assert time_by_hand.run(main()) == {"unsent: closed": 1, "sent": 1, "sent bytes": 4}


def nowhere():
    raise OSError(errno.ENODEV, "No such device")
