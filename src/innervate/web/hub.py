"""The pages that look on: each is told the newest state, as fast as it can take it."""

from __future__ import annotations

import asyncio
import time
from collections import deque
from collections.abc import Awaitable, Callable
from typing import Any

import msgspec

from innervate.web.errors import Refused
from innervate.web.messages import parse
from innervate.web.snapshot import DeltaEncoder, Snapshot
from innervate.web.source import Source
from innervate.web.stage import Stage, next_due

PAGES_MAX = 32
ANSWERS_MAX = 100

Send = Callable[[str], Awaitable[None]]


class Page:
    """One page that looks on; to send it a message takes as long as it takes to read."""

    def __init__(self, hub: Hub, send: Send) -> None:
        self._hub = hub
        self._send = send
        self._answers: deque[dict[str, Any]] = deque(maxlen=ANSWERS_MAX)
        self._deltas = DeltaEncoder(hub.source.history)
        self._told: Snapshot | None = None
        self.wake = asyncio.Event()

    def answer(self, message: dict[str, Any]) -> None:
        """Tell it something that concerns it alone."""
        self._answers.append(message)
        self.wake.set()

    def take(self, text: str | bytes) -> None:
        """It sent something, whatever that is."""
        loop = asyncio.get_running_loop()

        def reply(answer: dict[str, Any]) -> None:
            loop.call_soon_threadsafe(self.answer, answer)

        try:
            self._hub.stage.submit(parse(text), reply)
        except Refused as error:
            self.answer({"type": "error", "text": str(error)})

    async def tell(self) -> None:
        """Send it what is new, for ever: always the newest state, whatever there was between."""
        behind, due = False, time.monotonic()
        while True:
            if not behind:
                await self.wake.wait()
            self.wake.clear()
            newest = self._hub.newest
            if newest is not None and (behind or newest is not self._told):
                self._told = newest
                for message in self._deltas.messages(newest):
                    await self._send(message.decode())
                behind = self._deltas.is_behind(newest)
            while self._answers:
                await self._send(msgspec.json.encode(self._answers.popleft()).decode())
            due = next_due(due, time.monotonic())
            await asyncio.sleep(max(0.0, due - time.monotonic()))


class Hub:
    """A source on its stage, and the pages that look on.

    Attributes:
        newest: the newest snapshot.
        over: why the source can go on no more; None = it can.
    """

    def __init__(self, source: Source) -> None:
        self.source = source
        self.newest: Snapshot | None = None
        self.over: str | None = None
        self.stage = Stage(source, self._published, self._ended)
        self.pages: set[Page] = set()
        self._loop: asyncio.AbstractEventLoop | None = None

    def start(self) -> None:
        """Begin, in the loop that pages are served by."""
        self._loop = asyncio.get_running_loop()
        self.stage.start()

    def stop(self) -> None:
        """End the source, and wait for that."""
        self.stage.stop()

    def enter(self, send: Send) -> Page | None:
        """A page has come; None = there are too many."""
        if len(self.pages) >= PAGES_MAX:
            return None
        page = Page(self, send)
        self.pages.add(page)
        if self.over is not None:
            page.answer({"type": "end", "text": self.over})
        page.wake.set()
        return page

    def leave(self, page: Page) -> None:
        """A page is gone: it is told nothing more."""
        self.pages.discard(page)

    def say_end(self, text: str) -> None:
        """Tell all pages that nothing more comes, and why."""
        self.over = text
        for page in self.pages:
            page.answer({"type": "end", "text": text})

    def _published(self, snapshot: Snapshot) -> None:
        """In the stage's thread: there is a new state."""
        self.newest = snapshot
        self._soon(self._wake_all)

    def _ended(self, text: str) -> None:
        """In the stage's thread: the source cannot go on."""
        self._soon(lambda: self.say_end(text))

    def _soon(self, what: Callable[[], None]) -> None:
        assert self._loop is not None
        if not self._loop.is_closed():
            self._loop.call_soon_threadsafe(what)

    def _wake_all(self) -> None:
        for page in self.pages:
            page.wake.set()
