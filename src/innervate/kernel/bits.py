"""Two small things that plain Python and compiled code must spell differently.

Each has a plain body here and a compiled one in lowering.py with the same result; `tests/kernel`
holds them together.
"""

MASK64 = (1 << 64) - 1
FACTOR = 0x9E3779B97F4A7C15


def lowest_bit(word: int) -> int:
    """Index of the lowest set bit of a word != 0."""
    return (word & -word).bit_length() - 1


def mix(state: int, word: int) -> int:
    """Fold a word into a 64-bit fingerprint; both are taken modulo 2^64, the result is signed."""
    mixed = ((state ^ word) * FACTOR) & MASK64
    mixed ^= mixed >> 32
    return mixed - (1 << 64) if mixed >> 63 else mixed
