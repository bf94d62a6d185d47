"""Messages of a node's user, until each has its end: handed to the router as it has room."""

from collections import Counter
from collections.abc import Callable
from functools import partial
from typing import Any

from innervate.dialect.arith import MASK16
from innervate.live.receipts import DELIVERED, EXPIRED, FINAL, HOP_ACKED, REFUSED, STOPPED, Receipt
from innervate.networks.mesh.live.chains import Chains
from innervate.networks.mesh.live.long import WAITING_MAX, Long, PieceReceipt, Refusal
from innervate.networks.mesh.live.order import BEFORE_BYTES, NEW_AHEAD
from innervate.networks.mesh.live.pieces import HEAD_BYTES, SIZE_MAX, Name, Piece
from innervate.networks.mesh.live.stack import MeshStack
from innervate.networks.mesh.live.turns import Turns
from innervate.networks.mesh.protocol import constants as const
from innervate.networks.mesh.protocol.messages import payload_limit, resolve

HANDLES = 65_536
IN_VAIN = (const.NO_ROUTE, const.NO_ACK)
REFUSALS = 16  # under way at the same time
FORGOTTEN = "its recipient no longer has its beginning"
REASONS = {1: "no route", 2: "no acknowledgement", 3: "path full", 4: "no room"}


class Outgoing:
    """Messages on their way: `hand_down` gives the router one.

    `hand_up` takes a long one to ourselves: our number, and what it says. `outcomes` counts what
    became of them, by words.
    """

    def __init__(
        self,
        stack: MeshStack,
        hand_down: Callable[[Any], None],
        hand_up: Callable[[int, bytes], None],
        outcomes: Counter[str],
    ) -> None:
        self._stack = stack
        self._hand_down, self._hand_up = hand_down, hand_up
        self.turns = Turns(stack, self._new_item)  # those that wait for a place in the router
        # By the router's name for them; pieces of long ones have their own.
        self.receipts: dict[int, Receipt] = {}
        self._outcomes = outcomes
        self.chains = Chains()  # which messages others come after
        self._handle = 0
        self._long_bytes = 0  # of long messages
        self._refusals: set[Name] = set()  # under way
        self._feeding = False

    def check(self, recipient: int, flags: int, size: int) -> int:
        """Refuse what is too long; how many bytes fit into one frame.

        Raises:
            ValueError: it is too long for pieces, or nobody would acknowledge them.
        """
        params = self._stack.params
        most: int = payload_limit(params) - (BEFORE_BYTES if flags & const.ORDERED else 0)
        if size <= most:
            return most
        if recipient == const.ALL or not (flags & const.END_TO_END and params.reliable):
            who = "to all" if recipient == const.ALL else "that is not reliable"
            raise ValueError(f"payload of {size} bytes; a message {who} holds at most {most}")
        if size > SIZE_MAX:
            raise ValueError(f"payload of {size} bytes; a message holds at most {SIZE_MAX}")
        return most

    def send(self, recipient: int, flags: int, payload: bytes, most: int) -> Receipt:
        """A message goes when it has its turn, in pieces if it has more than `most` bytes."""
        if not self.turns.has_room(recipient):
            return refused("queue full")
        if len(payload) > most:
            return self._send_long(recipient, flags, payload)
        receipt = Receipt()
        handle, item = self._new_item(receipt)
        item.dest, item.flags = recipient, flags
        if flags & const.ORDERED:
            payload = bytes(BEFORE_BYTES) + payload  # which one is before it is known when it goes
        item.length = len(payload)
        item.body[: len(payload)] = payload
        if self.turns.put(handle, item):
            self.feed()
        return receipt

    def _send_long(self, recipient: int, flags: int, payload: bytes) -> Receipt:
        """A message that goes in pieces."""
        node, params = self._stack.node, self._stack.params
        dest = resolve(node, params, recipient)
        if dest == const.ALL:
            return refused(REASONS[const.NO_ROUTE])
        if self._long_bytes + len(payload) > WAITING_MAX:
            return refused("queue full")
        chains = self.chains if flags & const.ORDERED else None
        long = Long(dest, flags | const.ORDERED, payload, payload_limit(params), chains)
        handle = self._take_handle(long.receipt)
        self._long_bytes += len(payload)
        long.on_end = partial(self._end_long, handle, long)
        if dest == node.number:
            self._hand_up(dest, payload)
            long.on_end(DELIVERED, "")
        elif self.turns.put(handle, long):
            self.feed()
        return long.receipt

    def _end_long(self, handle: int, long: Long, state: str, reason: str) -> None:
        self._long_bytes -= len(long.payload)
        self.turns.drop(handle, long)
        self._end(handle, state, reason)

    def refuse(self, sender: int, piece: Piece, then: Callable[[], None]) -> None:
        """Tell the sender of a long message that it cannot be whole here; `then` once it knows.

        By then its last piece can be acknowledged; else it would be tried for 26 s.
        """
        name = sender, piece.message, piece.size
        is_full = len(self._refusals) == REFUSALS or not self.turns.has_room(sender)
        if name in self._refusals or is_full:
            return  # the last piece comes again

        def end(state: str) -> None:
            self._refusals.discard(name)
            if state == DELIVERED:
                then()

        handle, item = self._new_item(PieceReceipt(Refusal(piece.message, piece.size, end)))
        item.dest, item.flags = sender, const.ORDERED | const.END_TO_END
        item.length = HEAD_BYTES + 1  # no piece is without data
        item.body[HEAD_BYTES] = 0
        self._refusals.add(name)
        if self.turns.put(handle, item):
            self.feed()

    def refused(self, recipient: int, piece: Piece) -> None:
        """A recipient says that a long message cannot be whole there: it has its end."""
        for receipt in list(self.receipts.values()):
            long = receipt.long if isinstance(receipt, PieceReceipt) else None
            if isinstance(long, Long) and long.is_named(recipient, piece.message, piece.size):
                if long.receipt.state not in FINAL:
                    long.on_end(EXPIRED, FORGOTTEN)
                return

    def told(self, code: int, handle: int, detail: int) -> None:
        """The router says what becomes of a message."""
        receipt = self.receipts.get(handle)
        if receipt is None:
            return
        if code == const.REPORT_ACCEPTED:
            receipt.seq = detail
        elif code == const.REPORT_HOP:
            receipt.move(HOP_ACKED)
        elif code == const.REPORT_ARRIVED:
            self._end(handle, DELIVERED, is_there=True)
        elif code == const.REPORT_EXPIRED:
            is_there = False if detail in IN_VAIN else None
            self._end(handle, EXPIRED, REASONS.get(detail, ""), is_there)
        else:
            self._end(handle, REFUSED, REASONS.get(detail, ""))

    def feed(self) -> None:
        """Hand messages to the router while it has room; it calls us again when it has more."""
        if self._feeding:
            return
        self._feeding = True
        try:
            self._feed()
        finally:  # a user's own callback may have raised, on a message to this node
            self._feeding = False

    def _feed(self) -> None:
        while (waiting := self.turns.take()) is not None:
            handle, item = waiting
            chained = self._head(handle, item) if item.flags & const.ORDERED else None
            self._hand_down(item)
            if chained is not None and chained[1] == self._stack.node.seq:
                self.chains.sent(handle, *chained, bool(item.flags & const.END_TO_END))
            if resolve(self._stack.node, self._stack.params, item.dest) == self._stack.node.number:
                self._end(handle, DELIVERED)  # to ourselves: it was handed up
            elif not item.flags & const.END_TO_END or item.dest == const.ALL:
                self.receipts.pop(handle, None)  # nobody will tell us more
                self.turns.ended(handle, None)

    def _head(self, handle: int, item: Any) -> tuple[int, int] | None:
        """What stands in front of a message in order: the one before it; of a piece: which it is.

        Recipient and number of what others are to come after; None = none are.
        """
        stack, receipt = self._stack, self.receipts[handle]
        seq = (stack.node.seq + 1) & MASK16  # the number that the router is about to give it
        dest = resolve(stack.node, stack.params, item.dest)
        if isinstance(receipt, PieceReceipt):
            head = receipt.long.head(receipt.at, seq)
            item.body[: len(head)] = head
            return (dest, seq) if receipt.is_last and receipt.long.in_order else None
        before = self.chains.before(dest, seq)
        boot = self.chains.boot(dest)
        if before == seq and boot is not None:
            before = (seq + NEW_AHEAD - boot) & MASK16
        item.body[:BEFORE_BYTES] = before.to_bytes(BEFORE_BYTES, "big")
        return dest, seq

    def stop(self, reason: str = STOPPED) -> None:
        """Nothing of what there is goes any more: whoever waits for its end is told, and why."""
        for handle in list(self.receipts):
            self._end(handle, EXPIRED, reason)
        self.turns, self.chains = Turns(self._stack, self._new_item), Chains()
        self._long_bytes = 0

    def status(self) -> dict[str, Any]:
        """How many wait, for whom, and how many the router has."""
        return {
            "backlog": len(self.turns),
            "waiting": {str(dest): count for dest, count in self.turns.waiting().items()},
            "under_way": len(self.receipts) - len(self.turns),
        }

    def _new_item(self, receipt: Receipt) -> tuple[int, Any]:
        """A handle, and an item that bears it."""
        item = self._stack.item()
        item.handle = self._take_handle(receipt)
        return item.handle, item

    def _take_handle(self, receipt: Receipt) -> int:
        # Alarms bear robots' numbers.
        while self._handle in self.receipts or self._handle < const.IDS:
            self._handle = (self._handle + 1) % HANDLES
        handle = self._handle
        self._handle = (self._handle + 1) % HANDLES
        self.receipts[handle] = receipt
        return handle

    def _end(self, handle: int, state: str, reason: str = "", is_there: bool | None = None) -> None:
        """Nothing changes any more for a message; `is_there`: what that says of its recipient."""
        receipt = self.receipts.pop(handle, None)
        self.turns.ended(handle, is_there)
        self.chains.ended(handle, state == DELIVERED)
        if receipt is not None:
            what = "pieces" if isinstance(receipt, PieceReceipt) else "messages"
            self._outcomes[f"{what} {state}"] += 1
            receipt.move(state, reason)


def refused(reason: str) -> Receipt:
    """The receipt of a message that does not go."""
    receipt = Receipt()
    receipt.move(REFUSED, reason)
    return receipt
