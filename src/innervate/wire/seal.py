"""Sealed frames: what their first bytes say, and which of them were taken already.

A frame in a session begins with its kind (0xC3, or 0xC5 for what nodes say to each other below
the protocol), the receiver's index (4 bytes) and a counter (4); then as many bytes as the frame
has, encrypted, and a tag of 16. To a group it begins with 0xC4, the sender (2), the epoch of its
key (2) and the counter. The messages of a handshake are 0xD0 + key, 0xC1 and 0xC2. Integers are
big-endian; no frame in the clear begins with 0xC0 or above.
"""

MARK = 0xC0
SECOND = 0xC1
THIRD = 0xC2
FRAME = 0xC3
GROUP = 0xC4
CONTROL = 0xC5
FIRST = 0xD0
KEYS = 16
HEADER_BYTES = 9
TAG_BYTES = 16
OVERHEAD_BYTES = HEADER_BYTES + TAG_BYTES
COUNTER_MAX = (1 << 32) - 1
WINDOW = 1024  # frames of a sender may overtake each other by so many
STEP = 256  # of what is said of counters that are too old


def header(kind: int, index: int, counter: int) -> bytes:
    """The 9 bytes in front of a sealed frame; `index` of a group is sender and epoch."""
    return bytes((kind,)) + (index << 32 | counter).to_bytes(8, "big")


def is_sealed(data: bytes) -> bool:
    """True if these bytes claim to be sealed, or to belong to a handshake."""
    return len(data) > 0 and data[0] >= MARK


def fields(data: bytes) -> tuple[int, int, int] | None:
    """(kind, index, counter) of a sealed frame; None if it is too short or no such frame."""
    if len(data) < OVERHEAD_BYTES or not FRAME <= data[0] <= CONTROL:
        return None
    return data[0], int.from_bytes(data[1:5], "big"), int.from_bytes(data[5:9], "big")


class Window:
    """Which counters of a sender were seen: nothing is taken twice, nor what is far behind."""

    __slots__ = ("bits", "highest")

    def __init__(self, highest: int = -1) -> None:
        self.highest = highest
        self.bits = (1 << WINDOW) - 1 if highest >= 0 else 0

    def is_new(self, counter: int) -> bool:
        """True if this counter was not taken, and is not too far behind to know."""
        behind = self.highest - counter
        if behind < 0:
            return True
        return behind < WINDOW and not self.bits >> behind & 1

    @property
    def least(self) -> int:
        """A counter below which nothing is new; it changes once in 256 frames."""
        return max(self.highest - WINDOW, 0) // STEP * STEP

    def take(self, counter: int) -> None:
        """Note a counter; only after the frame has proved genuine."""
        ahead = counter - self.highest
        if ahead > 0:
            self.bits = (self.bits << ahead | 1) & ((1 << WINDOW) - 1) if ahead < WINDOW else 1
            self.highest = counter
        else:
            self.bits |= 1 << -ahead
