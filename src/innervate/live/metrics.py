"""A page for Prometheus: the status as text, for whoever asks by HTTP."""

import asyncio
import re
import socket
from collections.abc import Iterator

from innervate.live.admission import BoundedListener, Bounds
from innervate.live.errors import LiveError
from innervate.live.hosts import OwnNames
from innervate.live.node import LiveNode

REQUEST_MAX = 8192
ASK_S = 5.0
FULL = b"HTTP/1.1 503 Service Unavailable\r\nContent-Length: 0\r\nConnection: close\r\n\r\n"
BOUNDS = Bounds(most=16, burst=8, full=FULL, limit=REQUEST_MAX)


class MetricsPage:
    """Answers GET /metrics at an address and port, with the status of a node."""

    def __init__(self, where: tuple[str, int], node: LiveNode) -> None:
        self.where = where
        self.node = node
        self._names = OwnNames(where[0])
        self.listener: BoundedListener | None = None

    async def start(self) -> None:
        """Listen; LiveError if the address cannot be used."""
        try:
            sock = socket.create_server(self.where)
        except OSError as error:
            host, port = self.where
            raise LiveError(f"metrics: cannot use {host}:{port}: {error.strerror}") from None
        self.listener = BoundedListener("metrics", sock, self._serve, BOUNDS, self.node.callers)
        self.listener.open()

    async def stop(self) -> None:
        """Stop listening, and hang up on whoever is served."""
        if self.listener is not None:
            self.listener.close()

    async def _serve(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        try:
            async with asyncio.timeout(ASK_S):
                head = await reader.readuntil(b"\r\n\r\n")
                code, body = self._answer(head)
                data = body.encode()
                writer.write(
                    f"HTTP/1.1 {code}\r\nContent-Type: text/plain; version=0.0.4\r\n"
                    f"Content-Length: {len(data)}\r\nConnection: close\r\n\r\n".encode()
                    + data
                )
                await writer.drain()
        except (TimeoutError, ConnectionError, asyncio.IncompleteReadError,
                asyncio.LimitOverrunError):  # fmt: skip
            pass

    def _answer(self, head: bytes) -> tuple[str, str]:
        """A page of somebody else's that has led a name of its own here reads nothing."""
        if not self._is_ours(head):
            return "421 Misdirected Request", "not the name of this node\n"
        if not head.startswith(b"GET /metrics "):
            return "404 Not Found", "see /metrics\n"
        return "200 OK", "".join(f"{line}\n" for line in lines(self.node))

    def _is_ours(self, head: bytes) -> bool:
        """True if a request is addressed to us: by number, or by a name of this machine's."""
        hosts = [line[5:].strip() for line in head.decode("latin-1").split("\r\n")
                 if line[:5].lower() == "host:"]  # fmt: skip
        return len(hosts) == 1 and self._names.hold(hosts[0])


def lines(node: LiveNode) -> Iterator[str]:
    """The page, line by line."""
    status = node.status()
    label = f'node="{node.name}"'
    yield "# TYPE innervate_up_seconds gauge"
    yield f"innervate_up_seconds{{{label}}} {status['up_s']}"
    if status["state"] is not None:
        yield "# TYPE innervate_state_written gauge"
        yield f"innervate_state_written{{{label}}} {int(not status['state']['trouble'])}"
    yield "# TYPE innervate_events_total counter"
    for what, count in status["counters"].items():
        yield f'innervate_events_total{{{label},what="{_text(what)}"}} {count}'
    yield "# TYPE innervate_path_broken gauge"
    for path in status["paths"]:
        yield f'innervate_path_broken{{{label},path="{_text(path["name"])}"}} {int(path["broken"])}'
    yield "# TYPE innervate_path_total counter"
    for path in status["paths"]:
        for what, count in path["counters"].items():
            where = f'{label},path="{_text(path["name"])}",what="{_text(what)}"'
            yield f"innervate_path_total{{{where}}} {count}"
    yield "# TYPE innervate_link_quality gauge"
    for near in status.get("neighbours", ()):
        if near["quality"] is not None:
            yield f'innervate_link_quality{{{label},neighbour="{near["node"]}"}} {near["quality"]}'


def _text(text: str) -> str:
    return re.sub(r'[\\"\n]', "_", text)
