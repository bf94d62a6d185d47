"""send_message and receive_messages [mesh 1]: what becomes of a message is told by its receipt."""

from __future__ import annotations

import asyncio
from collections import Counter
from collections.abc import AsyncGenerator, Callable
from functools import partial
from typing import TYPE_CHECKING, Any

from innervate.dialect.arith import MASK16
from innervate.live.links import Link
from innervate.live.machine import machine
from innervate.live.node import LiveNode
from innervate.live.receipts import DELIVERED, EXPIRED, HOP_ACKED, REFUSED, Receipt
from innervate.live.state import State
from innervate.live.streams import Stream, message_line
from innervate.networks.mesh.live.alarms import Alarm, Alarms, place_of, read_alarm
from innervate.networks.mesh.live.chains import Chains
from innervate.networks.mesh.live.inbox import Inbox
from innervate.networks.mesh.live.long import WAITING_MAX, Long, PieceReceipt
from innervate.networks.mesh.live.order import BEFORE_BYTES, Callback, Orderly
from innervate.networks.mesh.live.pieces import SIZE_MAX
from innervate.networks.mesh.live.stack import TOO_LONG, MeshStack
from innervate.networks.mesh.live.turns import Turns
from innervate.networks.mesh.protocol.constants import (
    AGAIN,
    ALARM,
    ALL,
    DATA,
    END_TO_END,
    HANDED_UP,
    IDS,
    MESSAGE,
    MONITOR,
    NO_ACK,
    NO_ROUTE,
    ORDERED,
    PRIORITY,
    REPORT_ACCEPTED,
    REPORT_ALARM,
    REPORT_ARRIVED,
    REPORT_EXPIRED,
    REPORT_FULL,
    REPORT_GATEWAY,
    REPORT_HOP,
    SAMPLE,
)
from innervate.networks.mesh.protocol.messages import payload_limit, resolve

if TYPE_CHECKING:  # it brings ciphers with it, which only nodes with keys need
    from innervate.live.keys import Sealer

HANDLES = 65_536
NUMBERS = 4111  # of packets that are kept for a while; 16 restarts unheard lead round to no old one


class MeshNode(LiveNode):
    """A node of a mesh: sends and receives messages.

    Args:
        name: as shown to people.
        stack: the router.
        links: what carries its frames.
        sealer: seals and opens frames.
        state: what is kept over a restart: a gateway's epoch.
        orderly: how messages are put in order.
        in_order: True = send and receive in order if nothing else is said.
    """

    stack: MeshStack

    def __init__(
        self,
        name: str,
        stack: MeshStack,
        links: list[Link],
        sealer: Sealer | None = None,
        state: State | None = None,
        orderly: Orderly | None = None,
    ) -> None:
        super().__init__(name, stack, links, sealer, state)
        stack.epoch = self.state.epoch
        self.in_order = False
        self.inbox = Inbox(orderly or Orderly(), self._acknowledge)
        self._chains = Chains()
        self.arrived_by: dict[int, list[int]] = {}  # the way of each sender's newest message
        self._turns = Turns(stack, self._new_item)
        self._long_bytes = 0  # of long messages that have no end yet
        self._receipts: dict[int, Receipt] = {}
        self._handle = 0
        self.arrivals = self.inbox.arrivals
        self._ending = stack.item()
        self.alarms = Alarms()
        self._place = stack.item()
        self._feeding = False
        self.requests["locate"] = self._located

    def send_request(self, request: dict[str, Any]) -> Receipt:
        """A message to a node, or to all: see send_message()."""
        return self.send_message(
            int(request["to"]),
            bytes.fromhex(request["payload"]),
            reliable=bool(request.get("reliable", True)),
            priority=bool(request.get("priority", False)),
            in_order=request.get("in_order"),
        )

    def streams(self, request: dict[str, Any]) -> list[Stream]:
        """Messages, and alarms for who asks for them."""
        found: list[Stream] = [
            (self.receive_messages(in_order=request.get("in_order")), message_line)
        ]
        if request.get("alarms"):
            found.append((self.receive_alarms(), _alarm_line))
        return found

    def _located(self, request: dict[str, Any]) -> dict[str, Any]:
        x, y = (float(value) for value in request["at_cm"])
        vx, vy = (float(value) for value in request.get("speed_cm_s", (0, 0)))
        self.locate((x, y), (vx, vy))
        return {"ok": True}

    def send_message(
        self,
        recipient: int,
        payload: bytes,
        *,
        reliable: bool = True,
        priority: bool = False,
        in_order: bool | None = None,
    ) -> Receipt:
        """Send a message; never waits.

        Args:
            recipient: a node's number; 255 = all, 254 = the monitor (else the gateway).
            payload: what fits into a frame, 90 bytes at an MTU of 127 and two less in order;
                longer ones, up to 65,536 bytes, go in pieces, and are always reliable.
            reliable: kept here until its recipient acknowledges it, or 5 retries fail.
            priority: before all other messages that wait here, also to the same recipient in order.
            in_order: recipients may put it in order; None = as the node's file says.

        Raises:
            ValueError: no node can have that number, or the payload is too long.
        """
        chained = self.in_order if in_order is None else in_order
        chained = chained and recipient not in (ALL, self.stack.node.number)
        room = payload_limit(self.stack.params)
        most = room - (BEFORE_BYTES if chained else 0)
        nodes = self.stack.params.nodes
        if not (0 <= recipient < nodes or recipient in (ALL, MONITOR)):
            raise ValueError(f"recipient must be 0 to {nodes - 1}, 254 or 255, not {recipient}")
        if len(payload) > most:
            self._check_long(recipient, len(payload), most, reliable)
        self.outcomes["messages accepted"] += 1
        if self.engine is None or not self._turns.has_room(recipient):
            return _refused("queue full" if self.engine else "node not started")
        flags = (END_TO_END if reliable else 0) | (PRIORITY if priority else 0)
        if len(payload) > most:
            return self._send_long(recipient, flags, payload, chained)
        receipt = Receipt()
        handle, item = self._new_item(receipt)
        item.dest, item.flags = recipient, flags
        if chained:
            item.flags |= ORDERED
            payload = bytes(BEFORE_BYTES) + payload  # which one is before it is known when it goes
        item.length = len(payload)
        item.body = list(payload)
        self._turns.put(handle, item)
        self._feed()
        return receipt

    def _check_long(self, recipient: int, size: int, most: int, reliable: bool) -> None:
        """Refuse what cannot go in pieces.

        Raises:
            ValueError: it is too long for that, too, or nobody would acknowledge its pieces.
        """
        if recipient == ALL or not (reliable and self.stack.params.reliable):
            who = "to all" if recipient == ALL else "that is not reliable"
            raise ValueError(f"payload of {size} bytes; a message {who} holds at most {most}")
        if size > SIZE_MAX:
            raise ValueError(f"payload of {size} bytes; a message holds at most {SIZE_MAX}")

    def _send_long(self, recipient: int, flags: int, payload: bytes, chained: bool) -> Receipt:
        """A message that goes in pieces."""
        node, params = self.stack.node, self.stack.params
        dest = resolve(node, params, recipient)
        if dest == ALL:
            return _refused(REASONS[NO_ROUTE])
        if self._long_bytes + len(payload) > WAITING_MAX:
            return _refused("queue full")
        chains = self._chains if chained else None
        long = Long(dest, flags | ORDERED, payload, payload_limit(params), chains)
        handle = self._take_handle(long.receipt)
        self._long_bytes += len(payload)
        long.on_end = partial(self._end_long, handle, long)
        if dest == node.number:
            self.inbox.put_own(dest, payload)
            long.on_end(DELIVERED, "")
        else:
            self._turns.put(handle, long)
            self._feed()
        return long.receipt

    def _end_long(self, handle: int, long: Long, state: str, reason: str) -> None:
        self._long_bytes -= len(long.payload)
        self._turns.drop(handle, long)
        self._end(handle, state, reason)

    def receive_messages(
        self, callback: Callback | None = None, *, in_order: bool | None = None
    ) -> AsyncGenerator[tuple[int, bytes], None]:
        """Messages for this node, each at most once: to a callback, and as an async iterator.

        Args:
            callback: called with sender and payload for each from now on.
            in_order: each sender's messages as it sent them, if it sent them so; None = as the
                node's file says.

        Returns:
            An iterator over (sender, payload) of messages that come from now on.
        """
        ordered = self.in_order if in_order is None else in_order
        return (self.inbox.orderly.arrivals if ordered else self.arrivals).receive(callback)

    async def start(self) -> None:
        """Switch on; packets' numbers go on behind where they were.

        By how much is drawn: where a disk was full, nobody noted those that were used last.
        """
        if self.state.numbers >= 0:
            self.stack.first = (self.state.numbers + machine().chance.getrandbits(12)) & MASK16
        await super().start()

    async def stop(self) -> None:
        """Stop at once; what waits for its turn is handed up."""
        self.inbox.stop()
        await super().stop()

    def locate(
        self, at_cm: tuple[float, float], speed_cm_s: tuple[float, float] = (0.0, 0.0)
    ) -> None:
        """A robot says where it is, from the fence's origin; many times a second.

        Raises:
            ValueError: this node is no robot, or not started.
        """
        if not self.stack.node.robot or self.engine is None:
            raise ValueError("only a running robot has a position; its file says robot = true")
        item = self._place
        unit_cm = self.stack.params.unit_cm
        item.x, item.y, item.vx, item.vy = place_of(at_cm, speed_cm_s, unit_cm)
        self.engine.input(SAMPLE, item)

    def receive_alarms(
        self, callback: Callable[[Alarm], None] | None = None
    ) -> AsyncGenerator[Alarm, None]:
        """Alarms of the fence, at the monitor: to a callback, and as an async iterator."""
        return self.alarms.arrivals.receive(callback)

    async def drain(self, limit_s: float) -> bool:
        """Wait until no message is under way, at most `limit_s` seconds: True if none is."""
        waiting = [receipt.wait() for receipt in self._receipts.values()]
        if not waiting:
            return True
        _done, pending = await asyncio.wait(map(asyncio.ensure_future, waiting), timeout=limit_s)
        for task in pending:
            task.cancel()
        return not pending

    def troubles(self) -> dict[str, str]:
        """Neighbours have another MTU."""
        if not self.counters()["dropped: " + TOO_LONG]:
            return {}
        mtu = self.stack.params.mtu
        return {"mtu": f"frames come that are longer than protocol.mtu = {mtu}, and are dropped; "
                "write the same mtu into all nodes' files"}  # fmt: skip

    def counters(self) -> Counter[str]:
        """Handler calls, frames dropped by reason, messages by what became of them."""
        return super().counters() + self.inbox.counters()

    def status(self) -> dict[str, Any]:
        """What is known here, besides how many messages wait and which way they came."""
        return {
            **super().status(),
            "backlog": len(self._turns),
            "waiting": {str(dest): count for dest, count in self._turns.waiting().items()},
            "under_way": len(self._receipts) - len(self._turns),
            "out_of_turn": self.inbox.orderly.held(),
            "in_pieces": self.inbox.held(),
            "alarms": self.alarms.status(),
            "arrived_by": {str(sender): path for sender, path in self.arrived_by.items()},
        }

    def _new_item(self, receipt: Receipt) -> tuple[int, Any]:
        """A handle, and an item that bears it."""
        item = self.stack.item()
        item.handle = self._take_handle(receipt)
        return item.handle, item

    def _take_handle(self, receipt: Receipt) -> int:
        while self._handle in self._receipts or self._handle < IDS:  # alarms bear robots' numbers
            self._handle = (self._handle + 1) % HANDLES
        handle = self._handle
        self._handle = (self._handle + 1) % HANDLES
        self._receipts[handle] = receipt
        return handle

    def _deliver(self, kind: int, frame: Any) -> None:
        if kind == ALARM:
            body, unit_cm = bytes(frame.body[: frame.length]), self.stack.params.unit_cm
            alarm = read_alarm(frame.origin, body, unit_cm)
            if alarm is not None:
                self.outcomes[f"alarms received: {alarm.kind}"] += 1
                self.alarms.note(alarm)
        if kind in (DATA, AGAIN):
            self._turns.heard(frame.origin)
            self.arrived_by[frame.origin] = [*frame.path[: frame.path_len], frame.dest]
            self.inbox.note(frame, kind == AGAIN)

    def _reported(self, code: int, a: int, b: int) -> None:
        if code == REPORT_GATEWAY and b != self.state.epoch:
            self.state.epoch = b
            self.save()
        if code == REPORT_ALARM:
            self.outcomes["alarms raised"] += 1
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
            self._end(a, DELIVERED, is_there=True)
        elif code == REPORT_EXPIRED:
            self._end(a, EXPIRED, REASONS.get(b, ""), False if b in IN_VAIN else None)
        else:
            self._end(a, REFUSED, REASONS.get(b, ""))

    def _end(self, handle: int, state: str, reason: str = "", is_there: bool | None = None) -> None:
        """Nothing changes any more for a message; `is_there`: what that says of its recipient."""
        receipt = self._receipts.pop(handle, None)
        self._turns.ended(handle, is_there)
        self._chains.ended(handle, state == DELIVERED)
        if receipt is not None:
            what = "pieces" if isinstance(receipt, PieceReceipt) else "messages"
            self.outcomes[f"{what} {state}"] += 1
            receipt.move(state, reason)

    def _settled(self) -> None:
        self.alarms.arrivals.hand_up()
        self.inbox.hand_up()
        if self._turns:
            self._feed()
        self._reserve()

    def _reserve(self) -> None:
        """Numbers go on after a restart: where those kept run out, more are, before they are used.

        Who has heard us takes a number that comes again for a message that came before.
        """
        state, seq = self.state, self.stack.node.seq
        left = (state.numbers - seq) & MASK16
        if state.numbers < 0 or not NUMBERS // 2 <= left <= NUMBERS:
            state.numbers = (seq + NUMBERS) & MASK16
            state.write()

    def _acknowledge(self, sender: int, seq: int) -> None:
        """A message was handed up in its turn: its sender may know."""
        if self.engine is not None:
            self._ending.dest, self._ending.handle = sender, seq
            self.engine.input(HANDED_UP, self._ending)

    def _feed(self) -> None:
        """Hand messages to the router while it has room; it calls us again when it has more."""
        if self._feeding:
            return
        assert self.engine is not None
        self._feeding = True
        while (waiting := self._turns.take()) is not None:
            handle, item = waiting
            chained = self._head(handle, item) if item.flags & ORDERED else None
            self.engine.input(MESSAGE, item)
            if chained is not None and chained[1] == self.stack.node.seq:
                self._chains.sent(handle, *chained, bool(item.flags & END_TO_END))
            if resolve(self.stack.node, self.stack.params, item.dest) == self.stack.node.number:
                self._end(handle, DELIVERED)  # to ourselves: it was handed up
            elif not item.flags & END_TO_END or item.dest == ALL:
                self._receipts.pop(handle, None)  # nobody will tell us more
                self._turns.ended(handle, None)
        self._feeding = False

    def _head(self, handle: int, item: Any) -> tuple[int, int] | None:
        """What stands in front of a message in order: the one before it; of a piece: which it is.

        Recipient and number of what others are to come after; None = none are.
        """
        stack, receipt = self.stack, self._receipts[handle]
        seq = (stack.node.seq + 1) & MASK16  # the number that the router is about to give it
        dest = resolve(stack.node, stack.params, item.dest)
        if isinstance(receipt, PieceReceipt):
            head = receipt.long.head(receipt.at, seq)
            item.body[: len(head)] = head
            return (dest, seq) if receipt.is_last and receipt.long.in_order else None
        before = self._chains.before(dest, seq)
        item.body[:BEFORE_BYTES] = before.to_bytes(BEFORE_BYTES, "big")
        return dest, seq


IN_VAIN = (NO_ROUTE, NO_ACK)
REASONS = {1: "no route", 2: "no acknowledgement", 3: "path full", 4: "no room"}


def _refused(reason: str) -> Receipt:
    receipt = Receipt()
    receipt.move(REFUSED, reason)
    return receipt


def _alarm_line(alarm: Alarm) -> dict[str, Any]:
    return {"from": alarm.reporter, "alarm": alarm._asdict()}
