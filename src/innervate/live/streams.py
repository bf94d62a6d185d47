"""What comes in at a node, for callbacks, async iterators and listeners at its socket."""

import asyncio
from collections.abc import AsyncGenerator, Callable
from typing import Any, Generic, TypeVar

# Makes the line that a listener gets of what came.
Form = Callable[[Any], dict[str, Any]]
Stream = tuple[AsyncGenerator[Any, None], Form]

Item = TypeVar("Item")


class Arrivals(Generic[Item]):
    """What has come in for a node's user: to callbacks, and as async iterators.

    It waits until it is handed up: only then may a callback hand something down.

    Args:
        is_spread: items are tuples, and callbacks take their parts.

    Attributes:
        callbacks: who is told of each item.
    """

    def __init__(self, is_spread: bool = False) -> None:
        self.callbacks: list[Callable[..., None]] = []
        self._is_spread = is_spread
        self._waiting: list[Item] = []

    def put(self, item: Item) -> None:
        """Add an item behind those that wait."""
        self._waiting.append(item)

    def hand_up(self) -> None:
        """Call everybody with everything that waits; an error of one is told to the loop."""
        waiting, self._waiting = self._waiting, []
        for item in waiting:
            for callback in tuple(self.callbacks):
                try:
                    callback(*item) if self._is_spread else callback(item)  # type: ignore[misc]
                except Exception as error:
                    asyncio.get_running_loop().call_exception_handler(
                        {"message": f"Exception in callback {callback!r}", "exception": error}
                    )

    def receive(self, callback: Callable[..., None] | None = None) -> AsyncGenerator[Item, None]:
        """What comes from now on: to a callback, and as an async iterator.

        At the iterator's end the callback is taken away.
        """
        queue: asyncio.Queue[Any] = asyncio.Queue()
        put: Callable[..., None] = queue.put_nowait
        own = callback or (put if not self._is_spread else lambda *parts: put(parts))
        self.callbacks.append(own)
        return self._iterate(queue, own)

    async def _iterate(
        self, queue: asyncio.Queue[Item], own: Callable[..., None]
    ) -> AsyncGenerator[Item, None]:
        try:
            while True:
                yield await queue.get()
        finally:
            self.callbacks.remove(own)


def message_line(message: tuple[int, bytes]) -> dict[str, Any]:
    """The line of a message."""
    return {"from": message[0], "payload": message[1].hex()}
