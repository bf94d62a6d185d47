"""Other keys while frames come: nobody is shut out while the nodes take them over one by one."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING

from innervate.live.errors import LiveError

if TYPE_CHECKING:  # it brings ciphers with it, which only nodes with keys need
    from innervate.live.keys import Sealer


class Rotation:
    """Changes the keys of a running node, which its sealer has.

    New keys are accepted at once. For a grace time handshakes still begin with the old one, so
    that the other nodes may be told; for a second one it is still accepted, until they have done
    the same. Each key has its own times: another change in between does not make them longer.
    """

    def __init__(self, sealer: Sealer) -> None:
        self.sealer, self.ring = sealer, sealer.ring
        self._target = sealer.ring.use
        self._switches: list[asyncio.TimerHandle] = []
        self._leaving: dict[int, asyncio.TimerHandle] = {}

    def begin(self, keys: dict[int, bytes], use: int, grace_s: float) -> None:
        """Take over other keys, from now on.

        Raises:
            LiveError: a number stands for another key than before.
        """
        old = self.ring.keys
        for number in keys.keys() & old.keys():
            if keys[number] != old[number]:
                raise LiveError(f"keys.secret.{number} is another key now; give it a new number")
        loop = asyncio.get_running_loop()
        self.sealer.load_keys({**old, **keys}, self.ring.use)
        if use != self._target:
            self._target = use
            self._switches.append(loop.call_later(grace_s, self._switch, use))
        for number in self._leaving.keys() & keys.keys():
            self._leaving.pop(number).cancel()
        for number in old.keys() - keys.keys() - self._leaving.keys():
            self._leaving[number] = loop.call_later(2 * grace_s, self._leave, number)

    def _switch(self, use: int) -> None:
        """Begin with another key; those that were to be used before it are so no more."""
        if use == self._target:
            self.stop_switches()
        if use in self.ring.keys:
            self.sealer.load_keys(self.ring.keys, use)

    def _leave(self, number: int) -> None:
        del self._leaving[number]
        if number == self.ring.use:
            self._switch(self._target)
        left = {key: value for key, value in self.ring.keys.items() if key != number}
        self.sealer.load_keys(left, self.ring.use)

    def stop_switches(self) -> None:
        """No other key is used than now."""
        for switch in self._switches:
            switch.cancel()
        self._switches = []

    def stop(self) -> None:
        """Keys stay as they are now."""
        self.stop_switches()
        for leave in self._leaving.values():
            leave.cancel()
        self._leaving = {}
