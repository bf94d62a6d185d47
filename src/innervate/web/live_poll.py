"""Asks running nodes over their status sockets, all at once, and waits for none of them long."""

import json
import selectors
import socket
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

ANSWER_S = 0.5
AGAIN_S = 2.0  # a node that is not there is left alone for so long
LINE_MAX = 1 << 20

Answer = dict[str, Any]


class _Line:
    """The connection to one node."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.sock: socket.socket | None = None
        self.read = b""
        self.not_before = 0.0
        self.is_gone = False  # nobody holds the other end; else it may only be slow

    def send(self, request: Answer) -> bool:
        """Send a request; False = nobody is there."""
        try:
            if self.sock is None:
                if time.monotonic() < self.not_before:
                    return False
                self.sock = socket.socket(socket.AF_UNIX)
                self.sock.settimeout(ANSWER_S)
                self.sock.connect(str(self.path))
            self.sock.sendall(json.dumps(request).encode() + b"\n")
        except OSError:
            self.drop(gone=True)
            return False
        return True

    def take(self) -> Answer | None:
        """What has come, if it is whole.

        Raises:
            OSError: the node is gone.
            ValueError: what came is no answer.
        """
        assert self.sock is not None
        data = self.sock.recv(65_536)
        if not data or len(self.read) > LINE_MAX:
            raise OSError
        self.read += data
        line, newline, rest = self.read.partition(b"\n")
        if not newline:
            return None
        self.read = rest
        answer = json.loads(line)
        if not isinstance(answer, dict):
            raise ValueError
        return answer

    def drop(self, gone: bool = False) -> None:
        """Hang up: an answer that comes later is not taken for that to another request."""
        if self.sock is not None:
            self.sock.close()
        self.sock, self.read = None, b""
        self.is_gone = gone
        self.not_before = time.monotonic() + AGAIN_S if gone else 0.0


class Poller:
    """Connections to nodes, which are known by the places of their sockets in a list."""

    def __init__(self, paths: list[Path]) -> None:
        self._lines = [_Line(path) for path in paths]

    def ask(self, requests: Mapping[int, Answer], limit_s: float = ANSWER_S) -> dict[int, Answer]:
        """The answers of those nodes that answer in time, each to its request."""
        found: dict[int, Answer] = {}
        until = time.monotonic() + limit_s
        with selectors.DefaultSelector() as selector:
            waiting = set()
            for index, request in requests.items():
                line = self._lines[index]
                if line.send(request):
                    assert line.sock is not None
                    selector.register(line.sock, selectors.EVENT_READ, index)
                    waiting.add(index)
            while waiting and (left := until - time.monotonic()) > 0:
                for key, _events in selector.select(left):
                    line = self._lines[key.data]
                    try:
                        answer = line.take()
                    except (OSError, ValueError):
                        selector.unregister(key.fileobj)
                        waiting.discard(key.data)
                        line.drop(gone=True)
                        continue
                    if answer is not None:
                        line.is_gone = False
                        found[key.data] = answer
                        selector.unregister(key.fileobj)
                        waiting.discard(key.data)
            for index in waiting:
                self._lines[index].drop()
        return found

    def ask_all(self, request: Answer) -> dict[int, Answer]:
        """The answers of all nodes to one request; who turns us away is hung up on."""
        found = self.ask(dict.fromkeys(range(len(self._lines)), request))
        for index in [index for index, answer in found.items() if "error" in answer]:
            del found[index]
            self._lines[index].drop()
        return found

    def is_gone(self, index: int) -> bool:
        """True if nobody is at a node's socket; False: it answers, or is only slow."""
        return self._lines[index].is_gone

    def close(self) -> None:
        """Drop the connections to all nodes."""
        for line in self._lines:
            line.drop()
