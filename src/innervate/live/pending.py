"""What waits for somebody who reads at a node's socket: so much, and what is more is counted."""

from __future__ import annotations

import asyncio
from typing import Generic, TypeVar

Item = TypeVar("Item")


class Pending(Generic[Item]):
    """Items for one reader; a slow one, or one that was stopped, takes no more room than this.

    Args:
        most: items that may wait.
    """

    def __init__(self, most: int) -> None:
        self._most = most
        self._items: list[Item] = []
        self._missed = 0
        self._some = asyncio.Event()

    def put(self, item: Item) -> None:
        """Add an item behind those that wait; if they are too many it is only counted."""
        if len(self._items) >= self._most:
            self._missed += 1
        else:
            self._items.append(item)
        self._some.set()

    async def take(self) -> tuple[list[Item], int]:
        """Wait for items: all there are, and how many were left out behind them."""
        await self._some.wait()
        self._some.clear()
        items, self._items = self._items, []
        missed, self._missed = self._missed, 0
        return items, missed
