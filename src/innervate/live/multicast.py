"""UDP to a multicast group."""

import asyncio
import errno
import socket
import struct
import sys

from innervate.live.addresses import Address, Peer
from innervate.live.links import Receiver
from innervate.live.machine import machine
from innervate.live.only_from import TAKE, Doors, only_from, packed
from innervate.live.udp import UdpLink, UdpPath

RENEW_S = 1.0
IP_MULTICAST_ALL = 49  # Linux: what came by an interface is for its members alone


class MulticastLink(UdpLink):
    """A group on one interface: everybody in it hears everything, as on a radio channel.

    Args:
        group: address and port of the group.
        interface: own address on the interface.
        port: port number of the path.
    """

    def __init__(self, group: Peer, interface: str, port: int = 0) -> None:
        super().__init__((interface, 0), [group], port)
        self.paths[0].name += f" on {interface}"
        self.group = group
        self.interface = interface
        self.where = f"{group[0]}:{group[1]} on interface {interface}"
        self._group: UdpPath = self.paths[0]
        self._group.is_group = True
        self._group.filter = packed([TAKE])

    def filter_of(self, path: UdpPath, doors: Doors) -> bytes:
        """Instructions that let in what is for members, whatever their addresses."""
        return packed(doors.steps())

    def guard(self, *socks: socket.socket) -> None:
        """Have the system let in what is for us, or all if that is too much to say."""
        for sock in socks or self._sockets():
            only_from(sock, self._group.filter)

    def _make(self) -> socket.socket:
        sock = machine().socket(socket.AF_INET, socket.SOCK_DGRAM)
        try:
            sock.setblocking(False)
            sock.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            if sys.platform == "linux":
                sock.setsockopt(socket.IPPROTO_IP, IP_MULTICAST_ALL, 0)
            self.guard(sock)
            sock.bind(self.group)
            self._join(sock)
            sock.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, struct.pack("B", 1))
            sock.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_LOOP, 1)
        except BaseException:
            sock.close()
            raise
        return sock

    async def open(self, receive: Receiver) -> None:
        """Join the group; a wrong address is the user's mistake."""
        await super().open(receive)
        self._again = asyncio.get_running_loop().call_later(RENEW_S, self._renew)

    def _renew(self) -> None:
        """A membership goes with its interface, and nobody is told: join anew now and then."""
        if self._closed:
            return
        self._again = asyncio.get_running_loop().call_later(RENEW_S, self._renew)
        if self.socket is None:
            return
        group, why = self._group, ""
        try:
            self._join(self.socket)
        except OSError as error:
            if error.errno != errno.EADDRINUSE:  # that says: it is a member
                why = error.strerror or "error"
        if why:
            group.trouble = f"{group.name}: not in the group: {why}; trying again"
        elif not group.up:
            group.trouble = ""
        group.up = not why

    def _join(self, sock: socket.socket) -> None:
        own = socket.inet_aton(self.interface)
        sock.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, own)
        member = socket.inet_aton(self.group[0]) + own
        sock.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, member)

    def _origin(self, address: Address) -> UdpPath | None:
        """Whoever sends to the group is in it; our own frames come back, too: protocols know."""
        return self._group
