"""Named streams of random numbers: one root seed, one stream a purpose.

A stream depends on the root seed and its name only, so adding a draw to one purpose changes no
other. Pure integer arithmetic (splitmix64 seeded by BLAKE2b): the same on any machine.
"""

import hashlib

_MASK64 = (1 << 64) - 1
_GOLDEN = 0x9E3779B97F4A7C15


class Stream:
    """A splitmix64 generator; `state` is any integer, taken modulo 2^64."""

    __slots__ = ("_state",)

    def __init__(self, state: int) -> None:
        self._state = state & _MASK64

    def next64(self) -> int:
        """The next number, 0 .. 2^64-1."""
        self._state = (self._state + _GOLDEN) & _MASK64
        z = self._state
        z = ((z ^ (z >> 30)) * 0xBF58476D1CE4E5B9) & _MASK64
        z = ((z ^ (z >> 27)) * 0x94D049BB133111EB) & _MASK64
        return z ^ (z >> 31)

    def draw(self, n: int) -> int:
        """A number 0 <= result < n.

        Args:
            n: 1 .. 2^32 (the bias is then below 2^-32).
        """
        if n < 1:
            raise ValueError(f"draw needs n >= 1, not {n}")
        return (self.next64() * n) >> 64

    def uniform(self, low: int, high: int) -> int:
        """A whole number from `low` to `high`, both included (low <= high)."""
        return low + self.draw(high - low + 1)


def stream(seed: int, name: str) -> Stream:
    """The stream of a purpose ("event/3", "clock/17", ...) under a root seed."""
    digest = hashlib.blake2b(f"{seed}/{name}".encode(), digest_size=8).digest()
    return Stream(int.from_bytes(digest, "big"))
