"""What comes in for a node's user: messages, pieces put together, in order where asked for."""

import asyncio
from collections import Counter
from collections.abc import Callable
from typing import Any

from innervate.dialect.arith import MASK16, later
from innervate.live.engine import clock_us
from innervate.live.streams import Arrivals
from innervate.networks.mesh.live.order import BEFORE_BYTES, BOOTS, NEW_AHEAD, Message, Orderly
from innervate.networks.mesh.live.pieces import NEW, NO_TURN, REFUSAL, Piece, Pieces, read_piece
from innervate.networks.mesh.protocol.constants import ALL, ORDERED
from innervate.networks.mesh.protocol.duplicates import ANEW

HAD_US = 30_000_000  # a packet is tried for 26 s at most


class Inbox:
    """Messages that came, until they are handed up.

    `acknowledge` is told sender and number of each that may be; `outcomes` counts them, by words.
    """

    def __init__(
        self, orderly: Orderly, acknowledge: Callable[[int, int], None], outcomes: Counter[str]
    ) -> None:
        self.arrivals: Arrivals[tuple[int, bytes]] = Arrivals(is_spread=True)
        self.orderly = orderly
        self.orderly.on_up = acknowledge
        self.outcomes = outcomes
        self.pieces = Pieces()
        # Is told sender, number and content of a last piece whose message is not whole.
        self.refuse: Callable[[int, int, Piece], None] = lambda *_: None
        # Is told who cannot have one of ours whole, and the refusal.
        self.refused: Callable[[int, Piece], None] = lambda *_: None
        self._acknowledge = acknowledge
        self._came: list[tuple[Message, Piece | None, bool]] = []  # True = it came before
        self._sweep: asyncio.TimerHandle | None = None
        self._had: dict[int, dict[int, tuple[int, int]]] = {}  # by sender and number: what, when

    def note(self, frame: Any, is_again: bool) -> None:
        """A message, or a piece of one, came; the record is used again."""
        body = bytes(frame.body[: frame.length])
        before = boot = piece = None
        if _is_headed(frame, body):
            piece = read_piece(frame.seq, body)
            before = int.from_bytes(body[:BEFORE_BYTES], "big")
            behind = (frame.seq + NEW_AHEAD - before) & MASK16
            boot = behind if behind < BOOTS else None
            if boot is not None or later(before, frame.seq):  # or of a last piece, which expired
                before = frame.seq
            body = body[BEFORE_BYTES:]
        is_copy = self._is_copy(frame.origin, frame.seq, body)
        if piece is None:
            is_again = is_copy or is_again
        if not is_again:
            self.outcomes["messages received" if piece is None else "pieces received"] += 1
        message = Message(frame.origin, frame.seq, before, body, boot)
        self._came.append((message, piece, is_again))

    def is_another(self, frame: Any, body: bytes) -> bool:
        """True if not this packet came under its number: its sender has begun anew near there."""
        known = self._had.get(frame.origin, {}).get(frame.seq)
        begins = BEFORE_BYTES if _is_headed(frame, body) else 0
        return known is not None and known[0] != hash(body[begins:])

    def _is_copy(self, sender: int, seq: int, body: bytes) -> bool:
        """True if this packet came before, and the router does not know.

        Its window begins anew with the first packet of a sender that was switched on. If that was
        under way while its sender was switched off and on again, what came of the new life since
        then is forgotten there.
        """
        now, what = clock_us(), hash(body)
        had = self._had.setdefault(sender, {})
        known, at = had.get(seq, (0, now - HAD_US))
        if known == what and now - at < HAD_US:
            return True
        had.pop(seq, None)
        had[seq] = what, now
        if len(had) > ANEW:
            del had[next(iter(had))]
        return False

    def put_own(self, number: int, payload: bytes) -> None:
        """A long message of this node to itself."""
        self._came.append((Message(number, 0, None, payload), None, False))
        self.outcomes["messages received"] += 1
        self.hand_up()

    def counters(self) -> Counter[str]:
        """What came after its turn, and messages that never became whole."""
        never = self.pieces.forgotten
        lost = Counter({"messages never whole": never} if never else {})
        return lost + self.orderly.counters()

    def hand_up(self) -> None:
        """Call the user with all that came, and with what is whole now."""
        came, self._came = self._came, []
        for message, piece, is_again in came:
            if piece is not None:
                self._put(message, piece)
            elif is_again:
                self.orderly.again(message)
            else:
                self._up(message)

    def held(self) -> dict[str, int]:
        """Messages of which pieces are here, and their bytes."""
        return {"messages": len(self.pieces), "bytes": self.pieces.held}

    def stop(self) -> None:
        """Nothing is waited for any more."""
        if self._sweep is not None:
            self._sweep.cancel()
            self._sweep = None
        self.orderly.stop()

    def _put(self, message: Message, piece: Piece) -> None:
        sender, seq = message.sender, message.seq
        if piece.turn == REFUSAL:
            self._acknowledge(sender, seq)
            self.refused(sender, piece)
            return
        is_kept, whole = self.pieces.take(sender, piece, clock_us())
        self._arm()
        ordered = seq if piece.turn != NO_TURN and piece.is_last else None
        boot = piece.turn - NEW if piece.turn >= NEW else None
        if whole is not None:
            self.outcomes["messages received"] += 1
            self._up(Message(sender, seq, ordered, whole, boot))
            if ordered is None:
                self._acknowledge(sender, seq)
        elif is_kept and ordered is None:
            self._acknowledge(sender, seq)
        elif is_kept:  # it came before, and may have been too late for its turn
            self.orderly.again(Message(sender, seq, ordered, b"", boot))
        elif piece.is_last:
            self.refuse(sender, seq, piece)

    def _up(self, message: Message) -> None:
        self.arrivals.put((message.sender, message.payload))
        self.arrivals.hand_up()
        self.orderly.take(message)

    def _arm(self) -> None:
        if self._sweep is None and len(self.pieces):
            wait_s = (self.pieces.due() - clock_us()) / 1e6
            self._sweep = asyncio.get_running_loop().call_later(wait_s, self._forget)

    def _forget(self) -> None:
        self._sweep = None
        self.pieces.forget(clock_us())
        self._arm()


def _is_headed(frame: Any, body: bytes) -> bool:
    """True if in front of what a packet says is the number of the one before it, or of a piece."""
    return bool(frame.flags & ORDERED and frame.dest != ALL and len(body) >= BEFORE_BYTES)
