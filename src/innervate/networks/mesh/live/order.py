"""Messages in the order in which they were sent: held back until those before them are here.

A message of a sender that wants order names the one before it to the same recipient that has no end
yet. Numbers are the router's, of 16 bits; those between them went to others. It is acknowledged
when it was handed up: what waits here dies with its recipient, and its sender tries again.
"""

import asyncio
from collections import Counter, deque
from collections.abc import Callable
from typing import NamedTuple

from innervate.dialect.arith import MASK16, later
from innervate.live.engine import clock_us
from innervate.live.streams import Arrivals
from innervate.networks.mesh.protocol.duplicates import ANEW

WAIT_US = 10_000_000  # a message is rarely tried longer; at most 26 s
BUFFER = 256
REMEMBERED = 256  # numbers of messages that came too late: a router keeps no more apart
NEW_AHEAD = 32_768  # in place of the message before, so far ahead less the boot: drawn numbers
BOOTS = 128  # boots of a machine that are told apart
QUIET_US = 30_000_000  # a packet is under way for 26 s at most: behind that none is an old one
BEFORE_BYTES = 2  # in front of the payload: the number of the message before

# Takes the sender's number and the payload.
Callback = Callable[[int, bytes], None]


class Message(NamedTuple):
    """A message that was received."""

    sender: int
    seq: int
    # The number of the one before it, `seq` = there is none; None = order is no matter.
    before: int | None
    payload: bytes
    # Of its sender's machine, 0 to 127, where that drew its numbers and does not know that we had
    # one of them; None = else. In one boot those drawn later are higher.
    boot: int | None = None


class Held(NamedTuple):
    """A message that waits for one before it."""

    seq: int
    before: int  # the number of the one that it waits for
    due: int  # when it waits no longer, us
    payload: bytes


class Order:
    """Puts the messages of one sender in order; up to `buffer` wait `wait_us` for one before."""

    def __init__(
        self, last: int | None, wait_us: int = WAIT_US, buffer: int = BUFFER, now: int = 0
    ) -> None:
        self.last = last  # newest one that was handed up; None = nothing was heard of this sender
        self.last_at = now  # when it was handed up, us
        self.wait_us = wait_us
        self.buffer = buffer
        # Messages that came when those behind them had been handed up: they are dropped.
        self.late = 0
        self.held: list[Held] = []
        # Numbers of those that were handed up, until somebody takes note.
        self.ended: list[int] = []
        # Numbers of the newest ones that were not, and never will be.
        self.dropped: deque[int] = deque(maxlen=REMEMBERED)
        self._boot: int | None = None  # in which the sender last drew its numbers

    def take(
        self, seq: int, before: int, payload: bytes, now: int, boot: int | None = None
    ) -> list[bytes]:
        """A message came; what may be handed up now. `before == seq`: there is none to wait for."""
        if self._is_late(seq, before, boot, now - self.last_at >= QUIET_US):
            self.late += 1
            self.dropped.append(seq)
            return []
        self._boot = self._boot if boot is None else boot
        ready = self._put(seq, before, payload, now)
        self.last_at = now if ready else self.last_at
        return ready

    def _put(self, seq: int, before: int, payload: bytes, now: int) -> list[bytes]:
        ready: list[bytes] = []
        if before == seq:
            old = [one for one in self.held if self._is_before(one.seq, seq)]
            self.held = [one for one in self.held if one not in old]
            for one in _in_turn(old, old[0].seq) if old else ():
                ready += self._up(one.seq, one.payload)
        elif not self._had(before):
            self.held.append(Held(seq, before, now + self.wait_us, payload))
            return self._skip() if len(self.held) > self.buffer else ready
        return ready + self._up(seq, payload) + self._follow()

    def again(self, seq: int, before: int, now: int, boot: int | None = None) -> list[bytes]:
        """A message that waits came again, and may be after another one now; what may go up."""
        found = [one for one in self.held if one.seq == seq]
        if not found:
            return []
        self.held.remove(found[0])
        return self.take(seq, before, found[0].payload, now, boot)

    def is_up(self, seq: int) -> bool:
        """True if a message that came was handed up: it neither waits nor came too late."""
        return seq not in self.dropped and all(one.seq != seq for one in self.held)

    def release(self, now: int) -> list[bytes]:
        """What has waited long enough, with all that can follow it."""
        ready: list[bytes] = []
        while self.held and self.due() <= now:
            ready += self._skip()
        self.last_at = now if ready else self.last_at
        return ready

    def due(self) -> int:
        """When somebody has waited long enough, us; only while messages are held."""
        return min(one.due for one in self.held)

    def _is_late(self, seq: int, before: int, boot: int | None, is_quiet: bool) -> bool:
        """True if a message is too late; one without another before it may be of a new start.

        Its sender drew its numbers in another boot, and then an old one is not far behind; or
        nothing old is left, and the numbers went on over so many starts that they have come round.
        """
        if self.last is None or later(seq, self.last):
            return False
        is_drawn = boot is not None and boot != self._boot
        is_far = (self.last - seq) & MASK16 >= ANEW
        return before != seq or not (is_quiet or (is_drawn and is_far))

    def _had(self, before: int) -> bool:
        """True if there is nothing more to wait for before a message that comes after that one."""
        return self.last is not None and not later(before, self.last)

    def _up(self, seq: int, payload: bytes) -> list[bytes]:
        self.last = seq
        self.ended.append(seq)
        return [payload]

    def _is_before(self, seq: int, anew: int) -> bool:
        """True if a message is of the time before its sender began anew with number `anew`."""
        if self.last is None:
            return bool(later(seq, anew) == 0)
        ahead, ahead_anew = ((seq - number) & MASK16 for number in (self.last, anew))
        return bool(ahead < ahead_anew)

    def _skip(self) -> list[bytes]:
        """Whatever is missing is not waited for any longer: the oldest one that waits goes up."""
        first = _in_turn(self.held, self.held[0].seq)[0]
        self.held.remove(first)
        return [*self._up(first.seq, first.payload), *self._follow()]

    def _follow(self) -> list[bytes]:
        """What has waited for the one that was handed up last."""
        ready: list[bytes] = []
        while found := [one for one in self.held if self._had(one.before)]:
            first = _in_turn(found, found[0].seq)[0]
            self.held.remove(first)
            ready += self._up(first.seq, first.payload)
        return ready


class Orderly:
    """Hands messages up in order, sender by sender; each waits as in an Order."""

    def __init__(self, wait_us: int = WAIT_US, buffer: int = BUFFER) -> None:
        # Is told sender and number of each that was handed up.
        self.on_up: Callable[[int, int], None] = lambda _sender, _seq: None
        self.wait_us = wait_us
        self.buffer = buffer
        self.arrivals: Arrivals[tuple[int, bytes]] = Arrivals(is_spread=True)
        self._orders: dict[int, Order] = {}
        self._newest: dict[int, tuple[int, int]] = {}  # its number, and when it came, us
        self._again: asyncio.TimerHandle | None = None

    def take(self, message: Message) -> None:
        """A message came; callbacks are called for whatever it sets free."""
        sender, seq, before, payload, boot = message
        now = clock_us()
        if before is None:
            self._hand_up(sender, [payload])
            return
        if not self.arrivals.callbacks:  # nobody wants order yet
            self._orders.pop(sender, None)
            self._newest[sender] = seq, now
            self.on_up(sender, seq)
            return
        order = self._orders.get(sender)
        if order is None:
            last, last_at = self._newest.get(sender, (None, now))
            order = self._orders[sender] = Order(last, self.wait_us, self.buffer, last_at)
        self._hand_up(sender, order.take(seq, before, payload, now, boot), order)
        self._arm()

    def again(self, message: Message) -> None:
        """A message that came before came again: its sender was not told that it was handed up."""
        sender, seq, before, _, boot = message
        order = self._orders.get(sender)
        if order is not None and before is not None:
            self._hand_up(sender, order.again(seq, before, clock_us(), boot), order)
        if order is None or order.is_up(seq):
            self.on_up(sender, seq)

    def stop(self) -> None:
        """Nothing is waited for any more."""
        if self._again is not None:
            self._again.cancel()
            self._again = None
        for sender, order in self._orders.items():
            self._hand_up(sender, order.release(clock_us() + self.wait_us), order)

    def held(self) -> int:
        """Messages that wait for one before them."""
        return sum(len(order.held) for order in self._orders.values())

    def counters(self) -> Counter[str]:
        """Messages that came after their turn."""
        late = sum(order.late for order in self._orders.values())
        return Counter({"dropped: after its turn": late} if late else {})

    def _arm(self) -> None:
        if self._again is not None:
            return
        due = [order.due() for order in self._orders.values() if order.held]
        if due:
            wait_s = max(0, min(due) - clock_us()) / 1e6
            self._again = asyncio.get_running_loop().call_later(wait_s, self._release)

    def _release(self) -> None:
        self._again = None
        for sender, order in list(self._orders.items()):
            self._hand_up(sender, order.release(clock_us()), order)
        self._arm()

    def _hand_up(self, sender: int, payloads: list[bytes], order: Order | None = None) -> None:
        for payload in payloads:
            self.arrivals.put((sender, payload))
        self.arrivals.hand_up()
        if order is not None:
            ended, order.ended = order.ended, []
            for seq in ended:
                self.on_up(sender, seq)


def _in_turn(held: list[Held], near: int) -> list[Held]:
    """Held messages by number, which may run over 65535; `near` is one that is not far off."""
    return sorted(held, key=lambda one: (one.seq - near + 32_768) & MASK16)
