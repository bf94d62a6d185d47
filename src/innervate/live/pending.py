"""What waits for somebody who reads at a node's socket: so much, and what is more is counted."""

import asyncio
from collections.abc import Callable
from typing import Generic, TypeVar

Item = TypeVar("Item")


class Pending(Generic[Item]):
    """Items for one reader; a slow one, or one that was stopped, takes no more room than this.

    Args:
        most: items that may wait.
        weigh: for how many an item counts.
    """

    def __init__(self, most: int, weigh: Callable[[Item], int] = lambda _: 1) -> None:
        self._most = most
        self._weigh = weigh
        self._weight = 0
        self._items: list[Item] = []
        self._missed = 0
        self._some = asyncio.Event()

    def put(self, item: Item) -> None:
        """Add an item behind those that wait; if they are too many it is only counted."""
        weight = self._weigh(item)
        if self._weight + weight > self._most:
            self._missed += 1
        else:
            self._items.append(item)
            self._weight += weight
        self._some.set()

    async def take(self) -> tuple[list[Item], int]:
        """Wait for items: all there are, and how many were left out behind them."""
        await self._some.wait()
        self._some.clear()
        items, self._items = self._items, []
        self._weight = 0
        missed, self._missed = self._missed, 0
        return items, missed
