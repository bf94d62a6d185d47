"""Async iterators over what callbacks are told."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncGenerator, Callable
from typing import Any, TypeVar

# Makes the line that a listener gets of what came.
Form = Callable[[Any], dict[str, Any]]
Stream = tuple[AsyncGenerator[Any, None], Form]

Item = TypeVar("Item")
Told = TypeVar("Told", bound=Callable[..., None])


async def iterate(
    queue: asyncio.Queue[Item], callbacks: list[Told], own: Told
) -> AsyncGenerator[Item, None]:
    """What comes into a queue by a callback; at its end the callback is taken away."""
    try:
        while True:
            yield await queue.get()
    finally:
        callbacks.remove(own)


def message_line(message: tuple[int, bytes]) -> dict[str, Any]:
    """The line of a message."""
    return {"from": message[0], "payload": message[1].hex()}
