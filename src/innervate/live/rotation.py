"""Other keys while frames come: nobody is shut out while the nodes take them over one by one."""

from __future__ import annotations

import asyncio

from innervate.live.errors import LiveError
from innervate.live.keys import Sealer


class Rotation:
    """Changes the keys of a running node.

    New keys are accepted at once. For a grace time frames are still sealed with the old one, so
    that the other nodes may be told; for a second one it is still accepted, until they have done
    the same.

    Args:
        sealer: the node's.
    """

    def __init__(self, sealer: Sealer) -> None:
        self.sealer = sealer
        self._steps: list[asyncio.TimerHandle] = []

    def begin(self, keys: dict[int, bytes], use: int, grace_s: float) -> None:
        """Take over other keys, from now on.

        Raises:
            LiveError: a number stands for another key than before.
        """
        old = self.sealer.keys
        for number in keys.keys() & old.keys():
            if keys[number] != old[number]:
                raise LiveError(f"keys.secret.{number} is another key now; give it a new number")
        self.stop()
        both = {**old, **keys}
        self.sealer.load_keys(both, self.sealer.use)
        loop = asyncio.get_running_loop()
        self._steps = [
            loop.call_later(grace_s, self.sealer.load_keys, both, use),
            loop.call_later(2 * grace_s, self.sealer.load_keys, keys, use),
        ]

    def stop(self) -> None:
        """Keys stay as they are now."""
        for step in self._steps:
            step.cancel()
        self._steps = []
