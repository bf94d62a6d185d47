"""How much of strangers' messages a node stands before it shuts its door for a moment."""

import asyncio
from collections.abc import Callable

from innervate.live.engine import clock_us

SHUT_S = 0.05
ASK_US = 1_000_000
ANSWERED = 8  # a message with proof of the key costs as much as so many without, or more


class Knocks:
    """Lets in so much in 50 ms; then nothing for as long.

    Whom a node asks itself still answers: what it waits for bears an index that it drew.

    Args:
        most: how much; one with proof of the key counts for eight.
        turned: is called when the door was shut or opened.

    Attributes:
        is_open: False = what comes from strangers is dropped.
    """

    def __init__(self, most: int, turned: Callable[[], None]) -> None:
        self.is_open = True
        self._most, self._turned = most, turned
        self._left = float(most)
        self._at = 0
        self._timer: asyncio.TimerHandle | None = None
        self._asked_at = -ASK_US

    def note(self, weight: int = 1) -> None:
        """Somebody knocked: shut the door if that was too much."""
        now = clock_us()
        again = (now - self._at) * self._most / (1e6 * SHUT_S)
        self._left = min(self._left + again, self._most) - weight
        self._at = now
        if self._left < 0 and self.is_open:
            self.is_open = False
            self._timer = asyncio.get_running_loop().call_later(SHUT_S, self._open)
            self._turned()

    def may_ask(self) -> bool:
        """True once a second: a question of ours for each of theirs would put out those under way.

        Two who never take an answer of each other would ask for ever, besides.
        """
        now = clock_us()
        if now - self._asked_at < ASK_US:
            return False
        self._asked_at = now
        return True

    def _open(self) -> None:
        self.is_open, self._left, self._timer = True, float(self._most), None
        self._turned()

    def stop(self) -> None:
        """Leave the door as it is from now on."""
        if self._timer is not None:
            self._timer.cancel()
