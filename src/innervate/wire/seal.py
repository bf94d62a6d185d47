"""Sealed frames: who sent it and a number that never comes twice, then the frame encrypted.

Byte 0 is 0xC0 + key, bytes 1-2 the sender, 3-8 its counter, big-endian; then as many bytes as the
frame has, encrypted, and a tag of 16. No frame in the clear begins with 0xC0. The cipher is the
caller's: ChaCha20-Poly1305 (RFC 8439) with these 9 bytes as associated data.
"""

MARK = 0xC0
KEYS = 16
HEADER_BYTES = 9
TAG_BYTES = 16
OVERHEAD_BYTES = HEADER_BYTES + TAG_BYTES
COUNTER_MAX = (1 << 48) - 1
WINDOW = 1024  # frames of a sender may overtake each other by so many


def header(key: int, sender: int, counter: int) -> bytes:
    """The 9 bytes in front of a sealed frame."""
    return bytes((MARK | key, sender >> 8, sender & 255)) + counter.to_bytes(6, "big")


def is_sealed(data: bytes) -> bool:
    """True if these bytes claim to be a sealed frame."""
    return len(data) > 0 and data[0] >= MARK


def fields(data: bytes) -> tuple[int, int, int] | None:
    """(key, sender, counter) of a sealed frame; None if it is too short or no such frame."""
    if len(data) <= OVERHEAD_BYTES or not MARK <= data[0] < MARK + KEYS:
        return None
    return data[0] - MARK, data[1] << 8 | data[2], int.from_bytes(data[3:9], "big")


def nonce(kind: int, sender: int, counter: int) -> bytes:
    """The cipher's 12 bytes: never the same twice under a key that one network uses."""
    return bytes((kind, 0, 0, 0, sender >> 8, sender & 255)) + counter.to_bytes(6, "big")


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

    def take(self, counter: int) -> None:
        """Note a counter; only after the frame has proved genuine."""
        ahead = counter - self.highest
        if ahead > 0:
            self.bits = (self.bits << ahead | 1) & ((1 << WINDOW) - 1) if ahead < WINDOW else 1
            self.highest = counter
        else:
            self.bits |= 1 << -ahead
