"""Messages that are longer than a frame, at their sender: cut into pieces as those go.

A piece is a packet as any other: it has its turn, is tried again, and is acknowledged. The last one
goes when all others are acknowledged, and when those before the message that are in order have
their end; what becomes of it becomes of the message. A recipient that has not all others by then
was started anew, or had to forget them; it says so, and what is tried in vain has its end.
"""

from __future__ import annotations

import struct
from collections.abc import Callable
from typing import Any

from innervate.dialect.arith import MASK16
from innervate.live.receipts import ACCEPTED, DELIVERED, EXPIRED, FINAL, HOP_ACKED, Receipt
from innervate.networks.mesh.live.chains import Chains
from innervate.networks.mesh.live.pieces import HEAD_BYTES, NEW, NO_TURN, REFUSAL, SIZE_MAX, TURN
from innervate.networks.mesh.payloads import PIECE_AHEAD, PIECE_STRUCT

WAITING_MAX = 64 * SIZE_MAX  # bytes of all long messages of a node that have no end yet


# Takes the receipt of a piece; the handle and the item that it goes by.
Maker = Callable[["PieceReceipt"], tuple[int, Any]]


class Long:
    """A message that goes in pieces; to those who give out turns it is an item as any other.

    A packet has `room` bytes for a payload; `chains` are those in order that have no end yet,
    where it has its turn among them, else None.
    """

    def __init__(
        self, dest: int, flags: int, payload: bytes, room: int, chains: Chains | None
    ) -> None:
        self.dest, self.flags, self.payload = dest, flags, payload
        self.in_order = chains is not None
        self.receipt = Receipt()  # the user's
        # Is told its state and why, once.
        self.on_end: Callable[[str, str], None] = lambda _state, _reason: None
        self._chains = chains
        self._room = room - HEAD_BYTES
        self._at = 0  # where the next piece begins
        self._message = -1  # the number of the first packet
        self._under_way = 0

    @property
    def is_cut(self) -> bool:
        """True if no piece is left to be sent."""
        return self._at == len(self.payload)

    @property
    def is_ending(self) -> bool:
        """True if the next piece is the last."""
        return self._at + self._room >= len(self.payload)

    def may_go(self) -> bool:
        """True if the next piece may be sent."""
        if not self.is_ending:
            return True
        return not self._under_way and not (self._chains and self._chains.is_open(self.dest))

    def is_named(self, dest: int, message: int, size: int) -> bool:
        """True if this is the message of that name, as its recipient speaks of it."""
        named = self.dest, self._message, len(self.payload)
        return self.is_cut and named == (dest, message, size)

    def cut(self, make: Maker) -> tuple[int, Any]:
        """The next piece, its head still to be written: its handle, and the item that goes."""
        receipt = PieceReceipt(self, self._at, self.is_ending)
        data = self.payload[self._at : self._at + self._room]
        self._at += len(data)
        self._under_way += 1
        handle, item = make(receipt)
        item.dest, item.flags = self.dest, self.flags
        item.length = HEAD_BYTES + len(data)
        item.body[HEAD_BYTES : item.length] = data
        return handle, item

    def head(self, at: int, seq: int) -> bytes:
        """What stands in front of the piece that begins at `at` and goes out as packet `seq`."""
        if self._message < 0:
            self._message = seq
        mark, size = (seq + PIECE_AHEAD) & MASK16, len(self.payload) - 1
        turn = NO_TURN
        if self._chains is not None:
            boot = self._chains.boot(self.dest)
            turn = TURN if boot is None else NEW + boot
        return struct.pack(PIECE_STRUCT, mark, self._message, turn, at, size)

    def told(self, piece: PieceReceipt, state: str, reason: str) -> None:
        """What became of a piece."""
        self.receipt.seq = piece.seq
        if state == HOP_ACKED and self.receipt.state == ACCEPTED:
            self.receipt.move(HOP_ACKED)
        if state not in FINAL or self.receipt.state in FINAL:
            return
        self._under_way -= 1
        if state != DELIVERED:
            self.on_end(EXPIRED, reason)
        elif piece.is_last:
            self.on_end(DELIVERED, "")


class Refusal:
    """Tells the sender of a long message, by its name as in its pieces, that it cannot be whole.

    `on_end` is told the state of that, once.
    """

    in_order = False

    def __init__(self, message: int, size: int, on_end: Callable[[str], None]) -> None:
        self._message, self._size = message, size
        self._on_end = on_end

    def head(self, at: int, seq: int) -> bytes:
        """What stands in the packet, which goes out as `seq`."""
        mark = (seq + PIECE_AHEAD) & MASK16
        return struct.pack(PIECE_STRUCT, mark, self._message, REFUSAL, at, self._size - 1)

    def told(self, piece: PieceReceipt, state: str, reason: str) -> None:
        """What became of the packet."""
        if state in FINAL:
            self._on_end(state)


class PieceReceipt(Receipt):
    """What becomes of a piece: its message, or what takes the place of one, hears of it."""

    def __init__(self, long: Long | Refusal, at: int = 0, is_last: bool = False) -> None:
        super().__init__()
        self.long = long
        self.at = at  # where the piece begins
        self.is_last = is_last  # it is sent when all others are acknowledged

    def move(self, state: str, reason: str = "") -> None:
        """Its state changes, and its message hears of that."""
        super().move(state, reason)
        self.long.told(self, state, reason)
