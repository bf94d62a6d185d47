"""UDP to neighbours, by address or name."""

from __future__ import annotations

import asyncio
import socket
import sys
from collections import Counter
from collections.abc import Iterator, Mapping
from contextlib import closing, contextmanager, suppress

from innervate.live.addresses import ANY, Address, Peer, as_written, family_of, known, text
from innervate.live.engine import clock_us
from innervate.live.errors import LiveError
from innervate.live.links import FORGOTTEN_MAX, Link, Path, Receiver
from innervate.live.machine import machine
from innervate.live.only_from import Doors, Ranges, keep_apart, of_peer, only_from, share, unread

DATAGRAM_MAX = 2048
BATCH = 64  # datagrams read at once, before timers and other neighbours have their turn
SOCKETS = 32  # of a link at most
REOPEN_S = 0.5
FIRST_S = 2.0  # a node's start waits so long for its neighbours' names
LOOK_S = 5.0  # names of whom nothing was heard for so long are looked up, so often
MUTE_US = 60_000_000  # who was heard at an address may be silent for so long and be there still


class UdpPath(Path):
    """A neighbour's address, or a group's; None until its name has led to one."""

    reached_from = ""  # our address to it, when that was looked at last

    def __init__(self, link: UdpLink, peer: Peer, port: int) -> None:
        super().__init__(f"udp {as_written(peer)}", port)
        self.link, self.peer = link, peer
        self.doors: Doors | None = None
        self.lead_to(known(peer))

    def lead_to(self, address: Address | None) -> None:
        """What the neighbour's name stands for now."""
        self.address, self.led_at, link = address, clock_us(), self.link
        here, far = text(link.bind), text(address) if address else ""
        self.own = f"udp {here}"
        self.far = f"udp {far}" if far and known(self.peer) is None else ""
        self.ends = (here, far) if link.bind[1] and far else ("", "")
        plain = of_peer(address) if address else b""
        self.filter = link.filter_of(self, self.doors) if self.doors else plain
        self.up = address is not None

    def let_in(self, anybody: Ranges, known: Mapping[int, int]) -> None:
        """Have the system drop the rest, if it can."""
        doors = Doors(anybody, known)
        if doors != self.doors:
            self.doors = doors
            self.filter = self.link.filter_of(self, doors)
            self.link.guard()

    def bound_ends(self) -> tuple[str, str]:
        """Both addresses; ours on any interface is the one from which the neighbour is reached."""
        own, far = self.ends
        if own and self.address and self.link.bind[0] in ANY:
            sock = machine().socket(self.link.family, socket.SOCK_DGRAM)
            with suppress(OSError), closing(sock):
                sock.connect(self.address)
                own = text((sock.getsockname()[0], self.link.bind[1]))
        return own, far

    def send(self, data: bytes) -> None:
        """Send a datagram to the path's address; what has no room is counted and lost."""
        sock = self.link.socket
        if sock is None or self.address is None:
            self.counters[f"unsent: {'closed' if self.address else 'no address'}"] += 1
            return
        try:
            sock.sendto(data, self.address)
        except BlockingIOError:
            self.counters["unsent: full"] += 1
        except OSError as error:
            why = error.strerror or "error"
            self.counters[f"unsent: {why}"] += 1
            self.trouble = f"{self.name}: cannot be sent to: {why}; trying again"
        else:
            if self.trouble:
                self._is_back()
            self.sent(data)

    def _is_back(self) -> None:
        """It can be sent to again; from another address of ours it may not hear us."""
        self.trouble, own = "", self.bound_ends()[0]
        self.again = f"there again, reached from {own}" * (own != self.reached_from)
        self.reached_from = own


class UdpLink(Link):
    """One address for any number of neighbours; each has room of its own for what it sends.

    Args:
        bind: own address; ("0.0.0.0", port) or ("::", port) takes frames on every interface. Its
            family is that of all neighbours; a name is one of IPv4.
        peers: the neighbours' addresses, or names that are looked up; others are not listened to.
        first_port: port number of the first peer.
    """

    def __init__(self, bind: Peer, peers: list[Peer], first_port: int = 0) -> None:
        self.bind: Address = known(bind) or bind
        self._named, self.family = bind, family_of(bind[0])
        self.where = as_written(bind)
        self.socket: socket.socket | None = None  # sends; hears, too
        self._others: list[socket.socket] = []
        self.paths: list[UdpPath] = [
            UdpPath(self, peer, first_port + i) for i, peer in enumerate(peers)
        ]
        self.strangers = 0
        self._unread = 0
        self._by_address = {path.address: path for path in self.paths if path.address}
        self._asking: list[asyncio.Future[None]] = []
        self._receive: Receiver = lambda _path, _data: None  # until one is known
        self._closed = False
        self._again: asyncio.TimerHandle | None = None

    async def find(self) -> None:
        """Have names lead somewhere: what is known after `FIRST_S` is used, the rest when it comes.

        Our own is waited for; a wrong one is the user's mistake.
        """
        self._closed = False
        with self._own_is_right():
            await self._find_own()
        named = [path for path in self.paths if known(path.peer) is None]
        first = [asyncio.ensure_future(self._find(path)) for path in named]
        self._asking = [*first]
        if first:
            await asyncio.wait(first, timeout=FIRST_S)
        if self._closed:
            return
        self._asking = []
        for asked, path in zip(first, named, strict=True):
            if not asked.done() and path.address is None:
                path.trouble = f"{path.name}: no answer yet; waiting for it"
            self._asking.append(asyncio.ensure_future(self._follow(asked, path)))
        if known(self._named) is None:
            self._asking.append(asyncio.ensure_future(self._follow_own()))

    async def open(self, receive: Receiver) -> None:
        """Bind the socket; a wrong address is the user's mistake."""
        if not self._asking:
            await self.find()
        self._receive = receive
        with self._own_is_right():
            self._open()

    @contextmanager
    def _own_is_right(self) -> Iterator[None]:
        try:
            yield
        except OSError as error:
            why = error.strerror or error
            raise LiveError(f"cannot use UDP address {self.where}: {why}") from None

    async def _find_own(self) -> bool:
        """What the name of our own address leads to; True = elsewhere than before.

        Raises:
            OSError: there is none.
        """
        if known(self._named) is not None:
            return False
        before, found = self.bind, await machine().addresses(*self._named, self.family)
        if before not in found:
            self.bind = found[0]
            for path in self.paths:
                path.lead_to(path.address)
        return self.bind != before

    async def _follow(self, first: asyncio.Future[None], path: UdpPath) -> None:
        """Look again where a name leads, as long as its neighbour is silent."""
        await first
        while True:
            await asyncio.sleep(LOOK_S)
            if _is_silent(path):
                await self._find(path)

    async def _follow_own(self) -> None:
        while True:
            await asyncio.sleep(LOOK_S)
            is_elsewhere = False
            if any(map(_is_silent, self.paths)):
                with suppress(OSError):
                    is_elsewhere = await self._find_own()
            if is_elsewhere:
                if self._again is not None:
                    self._again.cancel()
                self._drop()
                self._reopen()

    async def _find(self, path: UdpPath) -> None:
        """Ask where a name leads; to what it does not lead any more nobody listens."""
        try:
            found = await machine().addresses(*path.peer, self.family)
        except OSError as error:
            self._lead(path, [], error.strerror or str(error))
        else:
            self._lead(path, found, "leads to another neighbour's address")

    def _lead(self, path: UdpPath, found: list[Address], why: str) -> None:
        """Have a path lead to one of the addresses found, of those that are nobody else's.

        It stays where it is if its neighbour may be there, else it is the next one's turn; `why`
        says why there is none.
        """
        taken = {one.address for one in self.paths if one is not path}
        free = [address for address in found if address not in taken]
        is_mute = path.heard_at < max(path.led_at, clock_us() - MUTE_US)
        at = free.index(path.address) + is_mute if path.address in free else 0
        if free and free[at % len(free)] != path.address:
            path.lead_to(free[at % len(free)])
            path.trouble, path.again = "", f"leads to {path.far.removeprefix('udp ')}"
            self._by_address = {one.address: one for one in self.paths if one.address}
            if self.socket is not None:
                self.guard()
                with suppress(OSError):
                    keep_apart(self._sockets(), self._by_address)
            path.moved()
        elif path.address is None:
            path.trouble = f"{path.name}: {why}; trying again"

    def _open(self) -> None:
        sock = self._make()
        self.socket = sock
        self._others = self._more(sock)
        for one in (sock, *self._others):
            asyncio.get_running_loop().add_reader(one.fileno(), self._readable, one)
        for path in self.paths:
            if path.address:
                path.up, path.trouble, path.reached_from = True, "", path.bound_ends()[0]

    def _make(self) -> socket.socket:
        sock = machine().socket(self.family, socket.SOCK_DGRAM)
        try:
            self._prepare(sock)
            sock.bind(self.bind)
        except BaseException:
            sock.close()
            raise
        return sock

    def _prepare(self, sock: socket.socket) -> None:
        """Before it is bound: it never waits, and hears what is for us."""
        sock.setblocking(False)
        if self.family == socket.AF_INET6:  # the same port of IPv4 is another link's
            sock.setsockopt(socket.IPPROTO_IPV6, socket.IPV6_V6ONLY, 1)
        self.guard(sock)

    def _more(self, first: socket.socket) -> list[socket.socket]:
        """Sockets for all neighbours but the first, if the system can keep them apart."""
        others: list[socket.socket] = []
        if sys.platform != "linux":
            return others
        try:
            for _ in self.paths[1:SOCKETS]:
                others.append(machine().socket(self.family, socket.SOCK_DGRAM))
                self._prepare(others[-1])
            if others:
                share(first, others)
                keep_apart((first, *others), self._by_address)
        except OSError:
            for sock in others:
                sock.close()
            return []
        return others

    def filter_of(self, path: UdpPath, doors: Doors) -> bytes:
        """Instructions that let in what is for a path."""
        return of_peer(path.address, doors) if path.address else b""

    def guard(self, *socks: socket.socket) -> None:
        """Have the system let in what is for our paths; at the least what bears their addresses.

        It does not look at interfaces: who has one address on two of them has one door.
        """
        hosts = Counter(address[:2] for address in self._by_address)
        filters = [path.filter if hosts[address[:2]] == 1 else of_peer(address)
                   for address, path in self._by_address.items()]  # fmt: skip
        for sock in socks or self._sockets():
            only_from(sock, b"".join(filters), b"".join(map(of_peer, self._by_address)))

    def _sockets(self) -> list[socket.socket]:
        return [] if self.socket is None else [self.socket, *self._others]

    def unread(self) -> int:
        """How many datagrams the system dropped: not for us, and those that found no room."""
        return self._unread + sum(map(unread, self._sockets()))

    def forget(self) -> None:
        """Read and throw away the datagrams that wait."""
        for sock in self._sockets():
            with suppress(OSError):
                for _ in range(FORGOTTEN_MAX):
                    sock.recvfrom(DATAGRAM_MAX)

    def close(self) -> None:
        """Close the socket, and do not open it again."""
        self._closed = True
        if self._again is not None:
            self._again.cancel()
        for asking in self._asking:
            asking.cancel()
        self._asking = []
        self._drop()

    def _drop(self) -> None:
        self._unread = self.unread()
        for sock in self._sockets():
            with suppress(RuntimeError):  # the loop may be closed already
                asyncio.get_running_loop().remove_reader(sock.fileno())
            sock.close()
        self.socket, self._others = None, []

    def _readable(self, sock: socket.socket) -> None:
        for _ in range(BATCH):
            if self.socket is None:  # whoever received may have closed us
                return
            try:
                data, address = sock.recvfrom(DATAGRAM_MAX)
            except (BlockingIOError, ConnectionError):  # refused: a neighbour is not there yet
                return
            except OSError as error:
                self._lost(error)
                return
            path = self._origin(address)
            if path is None:
                self.strangers += 1
            else:
                self._receive(path, data)

    def _origin(self, address: Address) -> UdpPath | None:
        return self._by_address.get(address)

    def _lost(self, error: OSError) -> None:
        """The interface went away: try until it is back."""
        self._drop()
        for path in self.paths:
            path.up = False
            path.trouble = f"{path.own}: cannot be used: {error.strerror}; trying again"
        self._again = asyncio.get_running_loop().call_later(REOPEN_S, self._reopen)

    def _reopen(self) -> None:
        if self._closed:
            return
        try:
            self._open()
        except OSError as error:
            self._lost(error)


def _is_silent(path: UdpPath) -> bool:
    """True if nothing was heard for so long that its neighbour may be elsewhere."""
    return path.heard_at < clock_us() - round(LOOK_S * 1e6)
