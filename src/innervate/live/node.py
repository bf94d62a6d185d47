"""A live node: a protocol on an engine, the paths its frames take, and what is known of them."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable
from typing import Any

from innervate.live.engine import Engine, Stack, clock_us
from innervate.live.links import Link, Path


class LiveNode:
    """One running node. Subclasses know what its user says and hears.

    Args:
        name: as shown to people.
        stack: its protocol.
        links: what carries its frames; their paths are numbered through from 0.

    Attributes:
        paths: all paths, by port.
        reports: how often the protocol reported what, by code.
    """

    def __init__(self, name: str, stack: Stack, links: list[Link]) -> None:
        self.name = name
        self.stack = stack
        self.links = links
        self.paths: list[Path] = [path for link in links for path in link.paths]
        self.reports: Counter[int] = Counter()
        self.engine: Engine | None = None
        self.started_at = time.time()

    async def start(self, cause: int = 0) -> None:
        """Open the links and switch the protocol on.

        Raises:
            LiveError: a link cannot be opened as written.
        """
        self.engine = Engine(
            self.stack, self._transmit, self._deliver, self._note_report, self._settled
        )
        for link in self.links:
            await link.open(self._receive)
        self.engine.start(cause)

    async def stop(self) -> None:
        """Stop at once, as if switched off; `drain` first to get rid of what is under way."""
        if self.engine is not None:
            self.engine.stop()
        for link in self.links:
            link.close()

    async def __aenter__(self) -> LiveNode:
        await self.start()
        return self

    async def __aexit__(self, *_: object) -> None:
        await self.stop()

    def _receive(self, path: Path, data: bytes) -> None:
        path.counters["received"] += 1
        path.counters["received bytes"] += len(data)
        assert self.engine is not None
        if self.engine.receive(path.port, data) == 0:
            path.heard_at = clock_us()

    def _transmit(self, port: int, frame: Any, attempt: int, flags: int) -> None:
        data = self.stack.encode(frame)
        ports = self.stack.ports_of(port, frame, attempt)
        for path in self.paths if ports is None else [self.paths[i] for i in ports]:
            path.send(data)

    def _note_report(self, code: int, a: int, b: int) -> None:
        self.reports[code] += 1
        self._reported(code, a, b)

    def _deliver(self, kind: int, frame: Any) -> None:
        """The protocol has something for its user; the record is used again."""

    def _reported(self, code: int, a: int, b: int) -> None:
        """The protocol says what happened."""

    def _settled(self) -> None:
        """The outbox is empty: the user may be called."""
