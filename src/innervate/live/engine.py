"""A protocol on an asyncio loop: its timers, its outbox. Knows no protocol by name."""

import asyncio
from collections import Counter
from collections.abc import Callable, Collection
from contextlib import suppress
from typing import Any, Protocol

from innervate.dialect.arith import HALF30, MASK30
from innervate.dialect.outbox import DELIVER, REPORT, SEND, SET_TIMER
from innervate.live.machine import machine

OUTBOX = 32
NEVER = 1 << 62  # us


class Stack(Protocol):
    """What an engine has to know of a protocol: its five functions bound to a node's state.

    Attributes:
        out: the outbox that all of them fill.
        inbox: the frame record that received bytes are read into.
        timers: how many timers it has.
        reasons: words for what `decode` returns; 0 is "read".
        silent_us: a path on which nothing was heard for so long is broken; NEVER: none is.
    """

    out: Any
    inbox: Any
    timers: int
    reasons: tuple[str, ...]
    silent_us: int

    def on_start(self, now: int, cause: int) -> None:
        """Switch the node on at `now`, us; `cause` 0 is the first time."""

    def on_frame(self, now: int, port: int) -> None:
        """The frame in `inbox` was received."""

    def on_timer(self, now: int, timer: int) -> None:
        """A timer of the node's protocol fires at `now`, us."""

    def on_input(self, now: int, kind: int, item: Any) -> None:
        """The node's own user hands something down."""

    def encode(self, frame: Any) -> bytes:
        """The bytes of a frame."""

    def decode(self, data: bytes) -> int:
        """Read bytes into `inbox`; 0, or why not."""

    def objection(self, sender: int | None) -> str:
        """Why the frame in `inbox` cannot be what it says; "" if it can. Changes nothing.

        `sender` is whose seal it came under; None = it came in the clear.
        """

    def ports_of(self, port: int, frame: Any, attempt: int) -> list[int] | None:
        """The paths on which a frame leaves; None = all of them."""

    def behind(self, count: int) -> Collection[int]:
        """Which of the `count` actions in the outbox send what may leave behind the others."""

    def status(self, now: int) -> dict[str, Any]:
        """What the protocol knows, for people; `now` is the whole clock, us."""


def clock_us() -> int:
    """The driver's clock, us, 64 bits; monotonic."""
    return machine().monotonic_ns() // 1000


class Engine:
    """Runs one stack: calls its functions, drains what they put out; they see `clock_us` mod 2^30.

    Args:
        stack: the protocol and its state.
        transmit: is given the port, the frame record and the action's b and c of every SEND.
        deliver: is given the kind and the frame record of every DELIVER; copies what it keeps.
        report: is given code, a and b of every REPORT.
        settled: is called when an outbox was drained; only it may hand something down again.

    Attributes:
        counters: what happened how often: handler calls, and frames dropped by reason.
        now: when what is drained now was decided, us.
        ended: is told why, if what runs the handlers ends by itself.
        late_us: a timer that is so late shows that the process did not run meanwhile; NEVER: none.
        late: is told then, in place of the handler, by how much it was, us.
    """

    def __init__(
        self,
        stack: Stack,
        transmit: Callable[[int, Any, int, int], None],
        deliver: Callable[[int, Any], None],
        report: Callable[[int, int, int], None],
        settled: Callable[[], None],
    ) -> None:
        self.stack = stack
        self.counters: Counter[str] = Counter()
        self._transmit = transmit
        self._deliver = deliver
        self._report = report
        self._settled = settled
        self._due = [NEVER] * stack.timers
        self._wake: asyncio.TimerHandle | None = None
        self._wake_at = NEVER
        self._at_once: asyncio.Handle | None = None
        self._taken = b""  # the last frame that was taken
        self._rehearsed = 0  # how many had come at the last rehearsal
        self._loop = asyncio.get_running_loop()
        self._stopped = False
        self.now = 0
        self.ended: Callable[[str], None] = lambda _why: None
        self.late_us = NEVER
        self.late: Callable[[int], None] = lambda _late_us: None

    def start(self, cause: int = 0) -> None:
        """Switch the node on: 0 first, 1 again with its memory lost."""
        now = clock_us()
        self._due = [NEVER] * self.stack.timers
        self.stack.on_start(now & MASK30, cause)
        self._drain(now)

    def stop(self) -> None:
        """No timer fires any more, nothing is received."""
        self._stopped = True
        for handle in (self._wake, self._at_once):
            if handle is not None:
                handle.cancel()
        self._wake = self._at_once = None

    def read(self, data: bytes, sender: int | None = None) -> str:
        """Read received bytes into the inbox: "", or why they are not taken (counted).

        Nothing else changes: what is kept may only change by `receive`, after this said "".
        `sender` is whose seal they came under; None = they came in the clear.
        """
        if self._stopped:
            return "stopped"
        reason = self.stack.decode(data)
        why = self.stack.reasons[reason] if reason else self.stack.objection(sender)
        if why:
            self.counters["dropped: " + why] += 1
        else:
            self._taken = data
        return why

    def rehearse(self) -> None:
        """Go once more through what the last frame took; nothing comes of it.

        Not where frames came since: they did as much.
        """
        frames, self._rehearsed = self._rehearsed, self.counters["frames"]
        if self._stopped or frames != self._rehearsed:
            return
        if self._taken and not self.stack.decode(self._taken):
            self.stack.objection(None)
            with suppress(ValueError):  # no coder has to say again what it reads
                self.stack.encode(self.stack.inbox)
        self._drain(clock_us())

    def receive(self, port: int, at: int | None = None) -> None:
        """The frame in the inbox came in on a port.

        `at` is when, if that is known better than by looking at the clock now.
        """
        now = clock_us() if at is None else at
        if self._is_late(now):
            return
        self.counters["frames"] += 1
        self.stack.on_frame(now & MASK30, port)
        self._drain(now)

    def call(self, handler: Callable[[int], None], at: int) -> None:
        """Call a handler with the protocol's clock of a moment, and drain what it puts out."""
        if not self._stopped:
            handler(at & MASK30)
            self._drain(at)

    def later(self, wait_us: int, do: Callable[[], None]) -> None:
        """Have something done in so long, unless the node is off by then."""
        self._loop.call_later(wait_us / 1e6, lambda: None if self._stopped else do())

    def input(self, kind: int, item: Any) -> None:
        """Hand something down for the node's own user."""
        now = clock_us()
        self.stack.on_input(now & MASK30, kind, item)
        self._drain(now)

    def look(self) -> None:
        """Tell of a time in which the process did not run, before something is handed down."""
        self._is_late(clock_us())

    def _is_late(self, now: int) -> bool:
        """True if the process did not run for long, and somebody was told."""
        late_us = now - min(self._due, default=NEVER)
        if late_us > self.late_us:
            self.late(late_us)
            return True
        return False

    def _drain(self, now: int) -> None:
        out = self.stack.out
        assert not out.overflow[0], "a handler put out more than its outbox holds"
        self.now = now
        count = out.count[0]
        out.count[0] = 0
        armed, behind = False, self.stack.behind(count) if count > 1 else ()
        for i in range(count):
            act = out.action[i]
            kind = act.kind
            if kind == SEND:
                if i not in behind:
                    self._transmit(act.a, out.frame[i], act.b, act.c)
            elif kind == SET_TIMER:
                wait = (act.b - now) & MASK30
                self._due[act.a] = now + (wait if wait < HALF30 else 0)
                armed = True
            elif kind == REPORT:
                self._report(act.a, act.b, act.c)
            elif kind == DELIVER:
                self._deliver(act.a, out.frame[i])
        for i in behind:
            act = out.action[i]
            self._transmit(act.a, out.frame[i], act.b, act.c)
        if armed and not self._stopped:
            self._arm(now)
        self._settled()

    def _arm(self, now: int) -> None:
        """One timer of the loop serves all: it is moved only if something is due before it.

        What is due at once has its turn when all sockets that are ready now were read. The loop's
        clock stands still while the machine is suspended: what should have come by now is moved.
        """
        soonest = min(self._due, default=NEVER)
        if soonest <= now:
            if self._at_once is None:
                self._at_once = self._loop.call_soon(self._fire_at_once)
        elif soonest < self._wake_at or self._wake_at <= now:
            if self._wake is not None:
                self._wake.cancel()
            self._wake_at = soonest
            wait = (soonest - now) / 1e6
            self._wake = self._loop.call_at(self._loop.time() + wait, self._fire_in_time)

    def _fire_at_once(self) -> None:
        self._at_once = None
        self._fire()

    def _fire_in_time(self) -> None:
        self._wake, self._wake_at = None, NEVER
        self._fire()

    def _fire(self) -> None:
        now = clock_us()
        if self._is_late(now):
            return
        for timer, at in enumerate(self._due):
            if at <= now:
                self._due[timer] = NEVER
                self.counters["timers"] += 1
                self.stack.on_timer(now & MASK30, timer)
                self._drain(now)
        if not self._stopped:
            self._arm(now)
