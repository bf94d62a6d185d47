"""Asking nodes while something is played on them."""

from __future__ import annotations

import asyncio
from contextlib import suppress
from pathlib import Path
from typing import Any

from innervate.live import status
from innervate.live.errors import LiveError


async def ask(where: Path, request: dict[str, Any]) -> None:
    """Ask a node for something; one that does not run has nothing to do."""
    with suppress(LiveError):
        await asyncio.to_thread(status.ask_one, where, request)


async def sleep_until(when: float) -> None:
    """Wait for a moment of the loop's clock."""
    await asyncio.sleep(max(0.0, when - asyncio.get_running_loop().time()))
