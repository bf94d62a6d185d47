"""Rehearsals: a node goes through what a frame takes before one comes.

To a node that hears little a message is a stranger: its code, Python's and the system's have left
the processor's caches, and are fetched line by line while the message waits.
"""

import asyncio
import socket
from collections.abc import Callable
from contextlib import suppress

from innervate.live.machine import machine

EVERY_S = 0.002
HERE = ("127.0.0.1", 0)
FRAME = bytes(64)


class Warmth:
    """Sends itself a datagram every `EVERY_S`, and calls `rehearse` when it comes.

    Raises:
        OSError: there is no socket to oneself.
    """

    def __init__(self, rehearse: Callable[[], None]) -> None:
        self._rehearse = rehearse
        self._loop = asyncio.get_running_loop()
        self._socket = machine().socket(socket.AF_INET, socket.SOCK_DGRAM)
        try:
            self._socket.setblocking(False)
            self._socket.bind(HERE)
            self._socket.connect(self._socket.getsockname())  # nobody else is heard
        except OSError:
            self._socket.close()
            raise
        self._loop.add_reader(self._socket.fileno(), self._came)
        self._timer = self._loop.call_later(EVERY_S, self._send)

    def stop(self) -> None:
        """No rehearsal comes any more."""
        self._timer.cancel()
        self._loop.remove_reader(self._socket.fileno())
        self._socket.close()

    def _send(self) -> None:
        self._timer = self._loop.call_later(EVERY_S, self._send)
        with suppress(OSError):
            self._socket.send(FRAME)

    def _came(self) -> None:
        try:
            self._socket.recvfrom(len(FRAME))
        except OSError:
            return
        self._rehearse()
