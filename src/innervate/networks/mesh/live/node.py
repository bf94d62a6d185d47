"""send_message and receive_messages [mesh 1]: what becomes of a message is told by its receipt."""

from __future__ import annotations

import asyncio
from collections import Counter
from collections.abc import AsyncGenerator, Callable
from typing import TYPE_CHECKING, Any

from innervate.dialect.arith import MASK16
from innervate.live.links import Link
from innervate.live.machine import machine
from innervate.live.node import LiveNode
from innervate.live.receipts import Receipt, check_bytes
from innervate.live.state import State
from innervate.live.streams import Stream, message_line
from innervate.networks.mesh.live.alarms import Alarm, Alarms, place_of, read_alarm
from innervate.networks.mesh.live.chains import Chains, drawn_number
from innervate.networks.mesh.live.inbox import Inbox
from innervate.networks.mesh.live.order import Callback, Orderly
from innervate.networks.mesh.live.outgoing import Outgoing, refused
from innervate.networks.mesh.live.pieces import Piece
from innervate.networks.mesh.live.stack import TOO_LONG, MeshStack
from innervate.networks.mesh.protocol import constants as const

if TYPE_CHECKING:  # it brings ciphers with it, which only nodes with keys need
    from innervate.live.keys import Sealer

NUMBERS = 4111  # of packets that are kept for a while: a busy node writes its file so much less
FEW = 512  # by who was just switched on: 7 restarts one after the other lead less than half round


class MeshNode(LiveNode):
    """A node of a mesh: sends and receives messages, puts them in order if that is asked for."""

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
        self.in_order = False  # True = send and receive in order if nothing else is said
        self._ahead = -1  # numbers that were kept last; -1 = none in this life
        self._boot: int | None = None  # of the machine, where our numbers were drawn; None = else
        self.inbox = Inbox(orderly or Orderly(), self._acknowledge, self.outcomes)
        self.arrived_by: dict[int, list[int]] = {}  # the way of each sender's newest message
        self.outgoing = Outgoing(stack, self._hand_down, self.inbox.put_own, self.outcomes)
        self.inbox.refuse, self.inbox.refused = self._refuse, self.outgoing.refused
        self.arrivals, stack.is_another = self.inbox.arrivals, self.inbox.is_another
        self._ending = stack.item()
        self._owed: list[tuple[int, int]] = []  # whose packets are to be acknowledged end to end
        self.alarms = Alarms()
        self._place = stack.item()
        self.requests["locate"] = self._located

    def send_request(self, request: dict[str, Any]) -> Receipt:
        """A message to a node, or to all: see send_message()."""
        if type(to := request["to"]) is not int:
            raise ValueError("to is a whole number, the recipient's")
        return self.send_message(
            to,
            bytes.fromhex(request["payload"]),
            reliable=bool(request.get("reliable", True)),
            priority=bool(request.get("priority", False)),
            in_order=request.get("in_order"),
        )

    def streams(self, request: dict[str, Any]) -> list[Stream]:
        """Messages, and alarms for who asks for them."""
        messages = self.receive_messages(in_order=request.get("in_order"))
        found: list[Stream] = [(messages, message_line)]
        if request.get("alarms"):
            alarms = self.receive_alarms()
            found.append((alarms, lambda one: {"from": one.reporter, "alarm": one._asdict()}))
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
            TypeError: the number is none, or the payload is not bytes.
        """
        if not isinstance(recipient, int):
            raise TypeError(f"recipient must be a node's number, not {recipient!r}")
        check_bytes(payload)
        chained = self.in_order if in_order is None else in_order
        chained = chained and recipient not in (const.ALL, self.stack.node.number)
        nodes = self.stack.params.nodes
        if not (0 <= recipient < nodes or recipient in (const.ALL, const.MONITOR)):
            raise ValueError(f"recipient must be 0 to {nodes - 1}, 254 or 255, not {recipient}")
        flags = (const.END_TO_END if reliable else 0) | (const.PRIORITY if priority else 0)
        flags |= const.ORDERED if chained else 0
        most = self.outgoing.check(recipient, flags, len(payload))
        self.outcomes["messages accepted"] += 1
        if self.idle():
            return refused(self.idle())
        self.running().look()
        return self.outgoing.send(recipient, flags, payload, most)

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

    async def _switch_on(self) -> None:
        """Packets' numbers go on behind where they were.

        By how much is drawn: where a disk failed, nobody may have noted those used last.
        """
        self._ahead = -1
        self._boot = None
        if self.state.numbers >= 0:
            self.stack.first = (self.state.numbers + machine().chance.getrandbits(12)) & MASK16
        else:
            self._boot, self.stack.first = drawn_number()
        self.outgoing.chains = Chains(self._boot)
        await super()._switch_on()
        # Others have told the ends of messages that waited so long, or forget that they had them;
        # the router would deliver them once more.
        self.running().late_us = self.stack.late_us

    def _give_up(self, why: str) -> None:
        """What was under way has expired; packets' numbers and the epoch go on."""
        self.outgoing.stop(why)
        self.outgoing.chains = Chains(self._boot)
        self.stack.first, self.stack.epoch = self.stack.node.seq, self.state.epoch

    async def stop(self) -> None:
        """Stop at once; what waits for its turn is handed up, what is under way has expired."""
        self.inbox.stop()
        await super().stop()
        self.outgoing.stop()

    def locate(
        self, at_cm: tuple[float, float], speed_cm_s: tuple[float, float] = (0.0, 0.0)
    ) -> None:
        """A robot says where it is, from the fence's origin; many times a second.

        Raises:
            ValueError: this node is no robot, or does not run.
        """
        if not self.stack.node.robot:
            raise ValueError("only a running robot has a position; its file says robot = true")
        engine = self.running()
        item = self._place
        unit_cm = self.stack.params.unit_cm
        item.x, item.y, item.vx, item.vy = place_of(at_cm, speed_cm_s, unit_cm)
        engine.look()
        engine.input(const.SAMPLE, item)

    def receive_alarms(
        self, callback: Callable[[Alarm], None] | None = None
    ) -> AsyncGenerator[Alarm, None]:
        """Alarms of the fence, at the monitor: to a callback, and as an async iterator."""
        return self.alarms.arrivals.receive(callback)

    async def drain(self, limit_s: float) -> bool:
        """Wait until no message is under way, at most `limit_s` seconds: True if none is."""
        waiting = [receipt.wait() for receipt in self.outgoing.receipts.values()]
        if not waiting:
            return True
        _done, pending = await asyncio.wait(map(asyncio.ensure_future, waiting), timeout=limit_s)
        for task in pending:
            task.cancel()
        return not pending

    def troubles(self) -> dict[str, str]:
        """Besides those of all nodes, whether neighbours have a longer MTU than this one."""
        found = super().troubles()
        if self.engine is None or not self.engine.counters["dropped: " + TOO_LONG]:
            return found
        mtu = self.stack.params.mtu
        found["mtu"] = (
            f"frames come that are longer than protocol.mtu = {mtu}, and are dropped; "
            "write the same mtu into all nodes' files"
        )
        return found

    def counters(self) -> Counter[str]:
        """Handler calls, frames dropped by reason, messages by what became of them."""
        return super().counters() + self.inbox.counters()

    def status(self) -> dict[str, Any]:
        """What is known here, besides how many messages wait and which way they came."""
        return {
            **super().status(),
            **self.outgoing.status(),
            "out_of_turn": self.inbox.orderly.held(),
            "in_pieces": self.inbox.held(),
            "alarms": self.alarms.status(),
            "arrived_by": {str(sender): path for sender, path in self.arrived_by.items()},
        }

    def _deliver(self, kind: int, frame: Any) -> None:
        if kind == const.ALARM:
            body, unit_cm = bytes(frame.body[: frame.length]), self.stack.params.unit_cm
            alarm = read_alarm(frame.origin, body, unit_cm)
            if alarm is not None:
                self.outcomes[f"alarms received: {alarm.kind}"] += 1
                self.alarms.note(alarm)
        if kind in (const.DATA, const.AGAIN):
            self.outgoing.turns.heard(frame.origin)
            self.arrived_by[frame.origin] = [*frame.path[: frame.path_len], frame.dest]
            self.inbox.note(frame, kind == const.AGAIN)

    def _reported(self, code: int, a: int, b: int) -> None:
        if code == const.REPORT_GATEWAY and b != self.state.epoch:
            self.state.epoch = b
            self.save()
        if code == const.REPORT_ALARM:
            self.outcomes["alarms raised"] += 1
        if not const.REPORT_ACCEPTED <= code <= const.REPORT_FULL:
            return
        self.outgoing.told(code, a, b)

    def _settled(self) -> None:
        while self._owed:  # told in the middle of an outbox, which must not be filled anew
            self._acknowledge(*self._owed.pop())
        self.alarms.arrivals.hand_up()
        self.inbox.hand_up()
        if self.outgoing.turns:
            self.outgoing.feed()
        self._reserve()

    def _reserve(self) -> None:
        """Numbers go on after a restart: where those kept run out, more are, before they are used.

        Who has heard us takes a number that comes again for a message that came before.
        """
        state, seq = self.state, self.stack.node.seq
        left = (state.numbers - seq) & MASK16
        if state.numbers < 0 or not self._ahead // 2 <= left <= self._ahead:
            self._ahead = FEW if self._ahead < 0 else NUMBERS
            state.numbers = (seq + self._ahead) & MASK16
            if not state.write():
                state.set_aside()

    def _acknowledge(self, sender: int, seq: int) -> None:
        """A message was handed up in its turn: its sender may know."""
        if self.engine is not None:
            self._ending.dest, self._ending.handle = sender, seq
            self.engine.input(const.HANDED_UP, self._ending)

    def _refuse(self, sender: int, seq: int, piece: Piece) -> None:
        """The last piece of a message that is not whole came: its sender is to know."""
        self.outgoing.refuse(sender, piece, lambda: self._owed.append((sender, seq)))

    def _hand_down(self, item: Any) -> None:
        assert self.engine is not None
        self.engine.input(const.MESSAGE, item)
