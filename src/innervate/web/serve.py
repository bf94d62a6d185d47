"""Serves a source until Ctrl-C."""

import asyncio
import signal
import socket
from collections.abc import AsyncIterator, Callable, Iterator
from contextlib import asynccontextmanager, contextmanager
from pathlib import Path
from typing import NamedTuple
from urllib.parse import quote

import uvicorn
from uvicorn.protocols.websockets.websockets_sansio_impl import WebSocketsSansIOProtocol

from innervate.web.errors import WatchError
from innervate.web.guard import Guard
from innervate.web.hub import Hub
from innervate.web.server import application
from innervate.web.source import Source

MESSAGE_MAX = 65_536
GOODBYE_S = 0.2
LINGER_S = 2
ANYWHERE = ("0.0.0.0", "::", "")  # every address of this machine

Announce = Callable[[str], None]


class Served(NamedTuple):
    """A page that can be opened; `address` has the token."""

    address: str
    hub: Hub


@asynccontextmanager
async def serving(
    source: Source, host: str = "127.0.0.1", port: int = 0, report: Path | None = None
) -> AsyncIterator[Served]:
    """Serve a source's page; at the end pages are told, and the source is closed.

    Args:
        source: what is watched.
        host: address to listen at.
        port: 0 = any that is free.
        report: a run's page.

    Raises:
        WatchError: nobody can listen there.
    """
    guard, hub = Guard(host), Hub(source)
    try:
        sock = _bound(host, port)
    except WatchError:
        source.close()
        raise
    with sock:
        server, ready = _Server(_config(hub, guard, report)), asyncio.Event()
        server.ready = ready.set
        hub.start()
        running = asyncio.create_task(server.serve(sockets=[sock]))
        running.add_done_callback(lambda _task: ready.set())
        try:
            await ready.wait()
            yield Served(_address(host, sock.getsockname()[1], guard.token), hub)
        finally:
            hub.say_end("the server was stopped")
            await asyncio.sleep(GOODBYE_S if hub.pages else 0)
            server.should_exit = True
            await running
            hub.stop()


def _config(hub: Hub, guard: Guard, report: Path | None) -> uvicorn.Config:
    return uvicorn.Config(
        application(hub, guard, report),
        log_level="critical",
        access_log=False,
        lifespan="off",
        server_header=False,
        ws=WebSocketsSansIOProtocol,
        ws_max_size=MESSAGE_MAX,
        ws_per_message_deflate=False,
        timeout_graceful_shutdown=LINGER_S,
    )


def _address(host: str, port: int, token: str) -> str:
    """Where a browser finds the page."""
    shown = socket.gethostname() if host in ANYWHERE else host
    shown = f"[{shown}]" if ":" in shown else shown
    return f"http://{shown}:{port}/?token={quote(token, safe='')}"  # a given one may be any text


async def serve(
    source: Source, host: str, port: int, announce: Announce, report: Path | None = None
) -> None:
    """Serve a source's page, as `serving` does, until SIGINT or SIGTERM.

    `announce` is given the page's address, once it can be opened.
    """
    asked, loop = asyncio.Event(), asyncio.get_running_loop()
    for number in (signal.SIGINT, signal.SIGTERM):
        loop.add_signal_handler(number, asked.set)
    async with serving(source, host, port, report) as served:
        announce(served.address)
        await asked.wait()


class _Server(uvicorn.Server):
    """A server that leaves signals alone and says when it can be reached."""

    ready: Callable[[], None]

    @contextmanager
    def capture_signals(self) -> Iterator[None]:
        """Signals are for who serves."""
        yield

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """Begin to listen; then call `ready`, once the port is open."""
        await super().startup(sockets)
        self.ready()


def _bound(host: str, port: int) -> socket.socket:
    """A socket that listens at the address."""
    try:
        family = socket.getaddrinfo(host or None, port, type=socket.SOCK_STREAM)[0][0]
        return socket.create_server((host, port), family=family)
    except (OSError, OverflowError) as error:
        why = getattr(error, "strerror", None) or str(error)
        raise WatchError(
            f"cannot listen at {host}:{port}: {why}; try another --host or --port"
        ) from None
