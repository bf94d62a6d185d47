"""Lets so many callers in that a node never runs out of files or of time, whoever calls."""

import asyncio
import socket
from collections import Counter
from collections.abc import Awaitable, Callable
from contextlib import suppress
from typing import NamedTuple

BACKLOG = 100
REST_S = 0.05  # nobody is let in for so long once a burst was; frames have their turn
SPENT_S = 1.0  # the same when files have run out
CLOSE_S = 1.0  # a caller that does not read what it asked for has so long
LEFT_MAX = 1 << 20  # bytes: no socket of ours has more that were not read

# Serves one caller, and does not raise.
Serve = Callable[[asyncio.StreamReader, asyncio.StreamWriter], Awaitable[None]]


class Bounds(NamedTuple):
    """How much a listener stands.

    Attributes:
        most: callers that may be in at once.
        burst: how many are let in, or turned away, before a rest of 50 ms.
        full: what those are told that are one too many; then they are hung up on.
        limit: bytes that a caller may send without the end of a line.
    """

    most: int
    burst: int
    full: bytes
    limit: int


class Heard(asyncio.StreamReader):
    """What a caller sent can be read to its end, also when answers do not reach them any more."""

    def __init__(self, caller: socket.socket, limit: int, loop: asyncio.AbstractEventLoop) -> None:
        super().__init__(limit, loop)
        self._caller = caller

    def set_exception(self, exc: Exception) -> None:
        """The connection broke: what the system still has is the last that comes."""
        with suppress(OSError):
            if left := self._caller.recv(LEFT_MAX):
                self.feed_data(left)
        self.feed_eof()


class BoundedListener:
    """A listening socket with a bound on who is in at once, and on how fast they come in.

    Args:
        name: what is counted begins so.
        sock: bound; it listens from `open` on.
        serve: is given each caller that is let in.
        bounds: how much it stands.
        counts: callers that were one too many; how often a burst made others wait, and how often
            files or memory had run out.
    """

    def __init__(
        self, name: str, sock: socket.socket, serve: Serve, bounds: Bounds, counts: Counter[str]
    ) -> None:
        self._name = name
        self._sock = sock
        self._serve = serve
        self._bounds = bounds
        self._counts = counts
        self._inside: set[asyncio.Task[None]] = set()
        self._rest: asyncio.TimerHandle | None = None
        self._loop = asyncio.get_running_loop()

    def open(self) -> None:
        """Begin to listen; callers are let in from now on."""
        self._sock.setblocking(False)
        self._sock.listen(BACKLOG)
        self._loop.add_reader(self._sock.fileno(), self._knock)

    def close(self) -> None:
        """Listen no more; whoever is in is hung up on."""
        self._turn_away()
        for task in self._inside:
            task.cancel()

    def move(self, sock: socket.socket) -> None:
        """Listen at another socket from now on; whoever is in stays."""
        self._turn_away()
        self._sock = sock
        self.open()

    def _turn_away(self) -> None:
        if self._sock.fileno() < 0:
            return
        self._loop.remove_reader(self._sock.fileno())
        if self._rest is not None:
            self._rest.cancel()
        self._sock.close()

    def _knock(self) -> None:
        for _ in range(self._bounds.burst):
            try:
                caller, _ = self._sock.accept()
            except (BlockingIOError, ConnectionError):
                return
            except OSError:
                self._counts[f"{self._name}: no files left"] += 1
                self._pause(SPENT_S)
                return
            caller.setblocking(False)
            if len(self._inside) < self._bounds.most:
                task = self._loop.create_task(self._let_in(caller))
                self._inside.add(task)
                task.add_done_callback(self._inside.discard)
            else:
                self._counts[f"{self._name}: turned away"] += 1
                with caller, suppress(OSError):
                    caller.send(self._bounds.full)
        self._counts[f"{self._name}: made to wait"] += 1
        self._pause(REST_S)

    def _pause(self, seconds: float) -> None:
        self._loop.remove_reader(self._sock.fileno())
        again = self._loop.add_reader
        self._rest = self._loop.call_later(seconds, again, self._sock.fileno(), self._knock)

    async def _let_in(self, caller: socket.socket) -> None:
        reader = Heard(caller, self._bounds.limit, self._loop)
        protocol = asyncio.StreamReaderProtocol(reader, loop=self._loop)
        try:
            transport, _ = await self._loop.connect_accepted_socket(lambda: protocol, caller)
        except OSError:
            caller.close()
            return
        writer = asyncio.StreamWriter(transport, protocol, reader, self._loop)
        try:
            await self._serve(reader, writer)
            writer.close()
            async with asyncio.timeout(CLOSE_S):
                await writer.wait_closed()
        except (OSError, TimeoutError, asyncio.CancelledError):  # gone, or the node ends
            pass
        except MemoryError:
            self._counts[f"{self._name}: no memory left"] += 1
        finally:
            transport.abort()
