"""Which message a new one is to come after: the newest to the same recipient that has no end yet.

What was delivered was handed up, and needs not be waited for; what has expired will not come.
"""

import zlib
from collections import defaultdict

from innervate.dialect.arith import MASK16, later
from innervate.live.machine import machine
from innervate.networks.mesh.live.order import BOOTS


class Chains:
    """Our messages that are to come in order and have no end yet, by recipient."""

    def __init__(self, boot: int | None = None) -> None:
        # Of this machine, 0 to 127, where our numbers were drawn; None = they go on behind others.
        self._boot = boot
        self._reached: set[int] = set()  # recipients that had one from us
        self._open: defaultdict[int, list[int]] = defaultdict(list)  # numbers, the newest last
        self._by_handle: dict[int, tuple[int, int]] = {}

    def before(self, dest: int, seq: int) -> int:
        """The number of the message before a new one; its own = there is none to wait for."""
        return self._open[dest][-1] if self._open.get(dest) else seq

    def boot(self, dest: int) -> int | None:
        """The boot, where our numbers may be far behind those that a recipient had; else None."""
        return None if dest in self._reached else self._boot

    def is_open(self, dest: int) -> bool:
        """True if the end of one to this recipient will be told."""
        return any(to == dest for to, _ in self._by_handle.values())

    def sent(self, handle: int, dest: int, seq: int, is_reliable: bool) -> None:
        """A message went to the router; nobody tells the end of one that is not reliable."""
        if not is_reliable:
            self._open[dest] = [seq]  # the newest stands for all before it
            return
        self._open[dest].append(seq)
        self._by_handle[handle] = dest, seq

    def ended(self, handle: int, is_delivered: bool) -> None:
        """A message has its end; one that was delivered came after all before it."""
        dest, seq = self._by_handle.pop(handle, (-1, -1))
        if dest < 0:
            return
        left = [one for one in self._open[dest] if one != seq]
        if is_delivered:
            self._reached.add(dest)
            left = [one for one in left if later(one, seq)]
        self._open[dest] = left
        if not left:
            del self._open[dest]


def drawn_number() -> tuple[int, int]:
    """The boot, and a number for a life that knows of none; lives of one boot go up, by 1 a ms.

    An old packet of the life before is behind those of this one then, whichever comes first.
    """
    boot = machine().boot()
    drawn = zlib.crc32(boot.encode()) if boot else machine().chance.getrandbits(32)
    since_boot_ms = machine().monotonic_ns() // 1_000_000
    return drawn % BOOTS, ((drawn >> 7) + since_boot_ms) & MASK16
