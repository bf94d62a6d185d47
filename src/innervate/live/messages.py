"""send_message and receive_messages [mesh 1]: what becomes of a message is told by its receipt."""

from __future__ import annotations

import asyncio
from collections import Counter, deque
from collections.abc import AsyncGenerator, Callable
from typing import Any

from innervate.live.keys import Sealer
from innervate.live.links import Link
from innervate.live.mesh import Item, MeshStack
from innervate.live.node import LiveNode
from innervate.live.state import State
from innervate.protocol.mesh_messages import payload_limit
from innervate.protocol.mesh_words import (
    ALL,
    DATA,
    END_TO_END,
    MESSAGE,
    MONITOR,
    PRIORITY,
    REPORT_ACCEPTED,
    REPORT_ARRIVED,
    REPORT_EXPIRED,
    REPORT_FULL,
    REPORT_GATEWAY,
    REPORT_HOP,
)

ACCEPTED = "accepted"
HOP_ACKED = "next hop acked"
DELIVERED = "delivered"
EXPIRED = "expired"
REFUSED = "refused"
FINAL = (DELIVERED, EXPIRED, REFUSED)

BACKLOG = 4096  # messages that wait for a place in the router
HANDLES = 65_536

# Takes the sender's number and the payload.
Callback = Callable[[int, bytes], None]


class Receipt:
    """What becomes of a message.

    Attributes:
        state: "accepted", "next hop acked", then "delivered" or "expired"; "refused" at once.
        reason: why it was refused or has expired, "" else.
        seq: the packet's number once the router has it, -1 before.
    """

    __slots__ = ("_changes", "_waiters", "reason", "seq", "state")

    def __init__(self) -> None:
        self.state = ACCEPTED
        self.reason = ""
        self.seq = -1
        self._waiters: list[asyncio.Future[str]] = []
        self._changes: list[asyncio.Future[str]] = []

    async def wait(self) -> str:
        """Wait until nothing changes any more; the state then.

        Messages to all, or without end-to-end acknowledgement, stay "accepted": do not wait.
        """
        if self.state in FINAL:
            return self.state
        future = asyncio.get_running_loop().create_future()
        self._waiters.append(future)
        return str(await future)

    async def change(self) -> str:
        """Wait for the next change; the state then."""
        if self.state in FINAL:
            return self.state
        future = asyncio.get_running_loop().create_future()
        self._changes.append(future)
        return str(await future)

    def move(self, state: str, reason: str = "") -> None:
        """The state changes."""
        self.state, self.reason = state, reason
        told = self._changes
        self._changes = []
        if state in FINAL:
            told += self._waiters
            self._waiters = []
        for future in told:
            if not future.done():
                future.set_result(state)

    def __repr__(self) -> str:
        return f"<Receipt {self.state}{': ' if self.reason else ''}{self.reason}>"


class MeshNode(LiveNode):
    """A node of a mesh: sends and receives messages.

    Args:
        name: as shown to people.
        stack: the router.
        links: what carries its frames.
        sealer: seals and opens frames.
        state: what is kept over a restart: a gateway's epoch.
    """

    stack: MeshStack

    def __init__(
        self,
        name: str,
        stack: MeshStack,
        links: list[Link],
        sealer: Sealer | None = None,
        state: State | None = None,
    ) -> None:
        super().__init__(name, stack, links, sealer, state)
        stack.epoch = self.state.epoch
        self.outcomes: Counter[str] = Counter()
        self.arrived_by: dict[int, list[int]] = {}  # the way of each sender's newest message
        self._backlog: deque[tuple[int, Any]] = deque()
        self._receipts: dict[int, Receipt] = {}
        self._handle = 0
        self._inbox: list[tuple[int, bytes]] = []
        self._callbacks: list[Callback] = []
        self._feeding = False

    def send_message(
        self, recipient: int, payload: bytes, *, reliable: bool = True, priority: bool = False
    ) -> Receipt:
        """Send a message; never waits.

        Args:
            recipient: a node's number; 255 = all, 254 = the monitor (else the gateway).
            payload: at most 90 bytes at an MTU of 127, 27 at 64.
            reliable: kept here until its recipient acknowledges it, or 5 retries fail.
            priority: before other messages.

        Raises:
            ValueError: no node can have that number, or the payload is too long.
        """
        most = payload_limit(self.stack.params)
        nodes = self.stack.params.nodes
        if not (0 <= recipient < nodes or recipient in (ALL, MONITOR)):
            raise ValueError(f"recipient must be 0 to {nodes - 1}, 254 or 255, not {recipient}")
        if len(payload) > most:
            raise ValueError(f"payload of {len(payload)} bytes; at most {most} fit into a frame")
        receipt = Receipt()
        self.outcomes["messages accepted"] += 1
        if len(self._backlog) >= BACKLOG or self.engine is None:
            receipt.move(REFUSED, "queue full" if self.engine else "node not started")
            return receipt
        item = Item()
        item.handle = self._take_handle(receipt)
        item.dest = recipient
        item.flags = (END_TO_END if reliable else 0) | (PRIORITY if priority else 0)
        item.length = len(payload)
        item.body[: len(payload)] = payload
        self._backlog.append((item.handle, item))
        self._feed()
        return receipt

    def receive_messages(
        self, callback: Callback | None = None
    ) -> AsyncGenerator[tuple[int, bytes], None]:
        """Messages for this node, each at most once: to a callback, and as an async iterator.

        Args:
            callback: called with sender and payload for each from now on.

        Returns:
            An iterator over (sender, payload) of messages that come from now on.
        """
        queue: asyncio.Queue[tuple[int, bytes]] = asyncio.Queue()
        if callback is None:
            callback = _putter(queue)
        self._callbacks.append(callback)
        return self._iterate(queue, callback)

    async def _iterate(
        self, queue: asyncio.Queue[tuple[int, bytes]], callback: Callback
    ) -> AsyncGenerator[tuple[int, bytes], None]:
        try:
            while True:
                yield await queue.get()
        finally:
            self._callbacks.remove(callback)

    async def drain(self, limit_s: float) -> bool:
        """Wait until no message is under way, at most `limit_s` seconds: True if none is."""
        waiting = [receipt.wait() for receipt in self._receipts.values()]
        if not waiting:
            return True
        _done, pending = await asyncio.wait(map(asyncio.ensure_future, waiting), timeout=limit_s)
        for task in pending:
            task.cancel()
        return not pending

    def counters(self) -> Counter[str]:
        """Handler calls, frames dropped by reason, messages by what became of them."""
        return super().counters() + self.outcomes

    def status(self) -> dict[str, Any]:
        """What is known here, besides how many messages wait and which way they came."""
        return {
            **super().status(),
            "backlog": len(self._backlog),
            "under_way": len(self._receipts) - len(self._backlog),
            "arrived_by": {str(sender): path for sender, path in self.arrived_by.items()},
        }

    def _take_handle(self, receipt: Receipt) -> int:
        while self._handle in self._receipts:
            self._handle = (self._handle + 1) % HANDLES
        handle = self._handle
        self._handle = (self._handle + 1) % HANDLES
        self._receipts[handle] = receipt
        return handle

    def _deliver(self, kind: int, frame: Any) -> None:
        if kind == DATA:
            self.arrived_by[frame.origin] = [*frame.path[: frame.path_len], frame.dest]
            self.outcomes["messages received"] += 1
            self._inbox.append((frame.origin, bytes(frame.body[: frame.length])))

    def _reported(self, code: int, a: int, b: int) -> None:
        if code == REPORT_GATEWAY and b != self.state.epoch:
            self.state.epoch = b
            self.save(False)
        if not REPORT_ACCEPTED <= code <= REPORT_FULL:
            return
        receipt = self._receipts.get(a)
        if receipt is None:
            return
        if code == REPORT_ACCEPTED:
            receipt.seq = b
        elif code == REPORT_HOP:
            receipt.move(HOP_ACKED)
        elif code == REPORT_ARRIVED:
            receipt.move(DELIVERED)
        elif code == REPORT_EXPIRED:
            receipt.move(EXPIRED, REASONS.get(b, ""))
        else:
            receipt.move(REFUSED, REASONS.get(b, ""))
        if receipt.state in FINAL:
            del self._receipts[a]
            self.outcomes[f"messages {receipt.state}"] += 1

    def _settled(self) -> None:
        inbox = self._inbox
        if inbox:
            self._inbox = []
            for sender, payload in inbox:
                for callback in self._callbacks:
                    callback(sender, payload)
        if self._backlog:
            self._feed()

    def _feed(self) -> None:
        """Hand messages to the router while it has room; it calls us again when it has more."""
        if self._feeding:
            return
        assert self.engine is not None
        self._feeding = True
        while self._backlog and self.stack.may_send(self._backlog[0][1].dest):
            handle, item = self._backlog.popleft()
            self.engine.input(MESSAGE, item)
            if not item.flags & END_TO_END or item.dest == ALL:
                self._receipts.pop(handle, None)  # nobody will tell us more
        self._feeding = False


REASONS = {1: "no route", 2: "no acknowledgement", 3: "path full", 4: "no room"}


def _putter(queue: asyncio.Queue[tuple[int, bytes]]) -> Callback:
    return lambda sender, payload: queue.put_nowait((sender, payload))
