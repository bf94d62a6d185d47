"""Messages in pieces at their recipient: put together, within bounds; acknowledged as they come.

A piece that is kept is acknowledged at once, the last one of a message when the whole was handed
up. Its sender sends that one when all others are acknowledged: if something is missing then, this
node was started anew meanwhile, or had to forget. It says so, by a piece of a kind of its own, and
the sender tells its user that the message has expired.
"""

import struct
from collections import deque
from typing import NamedTuple

from innervate.networks.mesh.payloads import PIECE_STRUCT, is_piece

HEAD_BYTES = struct.calcsize(PIECE_STRUCT)
SIZE_MAX = 65_536  # bytes of a message
EACH = 2  # messages of a sender that may be open: an urgent one, and one that it overtakes
HELD_MAX = 16 * SIZE_MAX  # bytes of all that are open, those still to come included
IDLE_US = 30_000_000  # a piece is tried for 26 s at most: then its sender is gone
PRESSED_US = 5_000_000  # where there is no room for another message
HAD = 8  # messages of a sender that were handed up: copies of their pieces may still come

# The whole among its sender's messages in order; from NEW on: and the boot, see order.py.
NO_TURN, TURN, NEW = range(3)
REFUSAL = 255  # in its place: the message of the same name that we sent cannot be whole there

Name = tuple[int, int, int]  # of a message: its sender, the number of its first packet, its bytes


class Piece(NamedTuple):
    """A piece of a message."""

    message: int  # the number of the packet that its first piece was in
    turn: int  # NO_TURN, TURN, NEW and a boot, or REFUSAL
    at: int  # its place in the message, in bytes
    size: int  # bytes of the whole
    data: bytes

    @property
    def is_last(self) -> bool:
        """True for what is sent when all others are acknowledged."""
        return self.at + len(self.data) == self.size


def read_piece(seq: int, body: bytes) -> Piece | None:
    """The piece in the payload of an ORDERED packet; None = it is a whole message."""
    if not is_piece(0, seq, body):
        return None
    _, message, turn, at, size = struct.unpack_from(PIECE_STRUCT, body)
    return Piece(message, turn, at, size + 1, body[HEAD_BYTES:])


class Open:
    """A message of which pieces are here."""

    def __init__(self, size: int, now: int) -> None:
        self.data = bytearray(size)
        self.places: set[int] = set()  # where the pieces begin that are here
        self.missing = size  # bytes that are not
        self.heard_at = now  # when the newest came, us

    def put(self, piece: Piece, now: int) -> None:
        """Enter a piece; what is here already changes nothing."""
        self.heard_at = now
        if piece.at not in self.places:
            self.places.add(piece.at)
            self.data[piece.at : piece.at + len(piece.data)] = piece.data
            self.missing -= len(piece.data)


class Pieces:
    """All messages of which pieces are here."""

    def __init__(self) -> None:
        self.held = 0  # bytes of them, those still to come included
        self.forgotten = 0  # how many were never whole
        self._open: dict[Name, Open] = {}  # the oldest first
        self._had: dict[int, deque[tuple[Name, int]]] = {}  # by sender: which, and when, us

    def __len__(self) -> int:
        return len(self._open)

    def take(self, sender: int, piece: Piece, now: int) -> tuple[bool, bytes | None]:
        """A piece came: True = it is kept, or not needed any more; the whole, when it is there."""
        name = sender, piece.message, piece.size
        if any(had == name and now - at < IDLE_US for had, at in self._had.get(sender, ())):
            return True, None
        if piece.at + len(piece.data) > piece.size:
            return False, None
        one = self._open.get(name) or self._begin(name, now)
        if one is None:
            return False, None
        one.put(piece, now)
        if not piece.is_last:
            return True, None
        if one.missing:
            return False, None
        self._close(name)
        self._had.setdefault(sender, deque(maxlen=HAD)).append((name, now))
        return True, bytes(one.data)

    def forget(self, now: int, idle_us: int = IDLE_US) -> None:
        """Those whose sender has not been heard for so long will not be whole any more."""
        for name, one in list(self._open.items()):
            if now - one.heard_at >= idle_us:
                self._close(name)
                self.forgotten += 1

    def due(self) -> int:
        """When the first of them is to be forgotten, us; only while there is one."""
        return min(one.heard_at for one in self._open.values()) + IDLE_US

    def _begin(self, name: Name, now: int) -> Open | None:
        """A place for a new message; None = there is none now."""
        sender, _, size = name
        own = [key for key in self._open if key[0] == sender]
        if len(own) >= EACH:  # its sender has given that one up
            self._close(own[0])
            self.forgotten += 1
        if self.held + size > HELD_MAX:
            self.forget(now, PRESSED_US)
        if self.held + size > HELD_MAX:
            return None
        self.held += size
        one = self._open[name] = Open(size, now)
        return one

    def _close(self, name: Name) -> None:
        self.held -= len(self._open.pop(name).data)
