"""Serves a source until Ctrl-C."""

from __future__ import annotations

import asyncio
import contextlib
import signal
import socket
from collections.abc import Callable, Iterator
from pathlib import Path

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


async def serve(
    source: Source, host: str, port: int, announce: Announce, report: Path | None = None
) -> None:
    """Serve a source's page until SIGINT or SIGTERM.

    Args:
        source: what is watched; it is closed at the end.
        host: address to bind.
        port: 0 = any that is free.
        announce: is given the page's address, once it can be opened.
        report: a run's page.

    Raises:
        WatchError: nobody can listen there.
    """
    guard = Guard(host)
    hub = Hub(source)
    try:
        sock = _bound(host, port)
    except WatchError:
        source.close()
        raise
    with sock:
        shown = socket.gethostname() if host in ANYWHERE else f"[{host}]" if ":" in host else host
        address = f"http://{shown}:{sock.getsockname()[1]}/?token={guard.token}"
        config = uvicorn.Config(
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
        server = _Server(config, lambda: announce(address))
        hub.start()
        ending = asyncio.create_task(_end_on_signal(hub, server))
        try:
            await server.serve(sockets=[sock])
        finally:
            ending.cancel()
            hub.stop()


async def _end_on_signal(hub: Hub, server: uvicorn.Server) -> None:
    """Wait for a signal, say goodbye to the pages, end."""
    loop, asked = asyncio.get_running_loop(), asyncio.Event()
    for number in (signal.SIGINT, signal.SIGTERM):
        loop.add_signal_handler(number, asked.set)
    await asked.wait()
    hub.say_end("the server was stopped")
    await asyncio.sleep(GOODBYE_S if hub.pages else 0)
    server.should_exit = True


class _Server(uvicorn.Server):
    """A server that leaves signals alone and says when it can be reached."""

    def __init__(self, config: uvicorn.Config, ready: Callable[[], None]) -> None:
        super().__init__(config)
        self._ready = ready

    @contextlib.contextmanager
    def capture_signals(self) -> Iterator[None]:
        """Signals are handled by `serve`."""
        yield

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """Listen, and say so."""
        await super().startup(sockets)
        self._ready()


def _bound(host: str, port: int) -> socket.socket:
    """A socket that listens at the address."""
    try:
        family = socket.getaddrinfo(host or None, port, type=socket.SOCK_STREAM)[0][0]
        return socket.create_server((host, port), family=family)
    except (OSError, OverflowError) as error:
        why = getattr(error, "strerror", None) or str(error)
        raise WatchError(f"cannot listen at {host}:{port}: {why}; try --port 0") from None
