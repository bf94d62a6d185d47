"""Whole numbers in a buffer of bytes at any bit, most significant bit first."""


def put(buffer: bytearray, at: int, bits: int, value: int) -> None:
    """Write the lowest `bits` of `value` at bit `at`; the place must hold zeros before.

    A negative value goes in as its two's complement.
    """
    while bits > 0:
        room = 8 - (at & 7)
        taken = min(room, bits)
        bits -= taken
        part = (value >> bits) & ((1 << taken) - 1)
        buffer[at >> 3] |= part << (room - taken)
        at += taken


def get(buffer: bytes | bytearray | memoryview, at: int, bits: int) -> int:
    """The number in `bits` bits from bit `at` on, unsigned."""
    value = 0
    while bits > 0:
        room = 8 - (at & 7)
        taken = min(room, bits)
        part = (buffer[at >> 3] >> (room - taken)) & ((1 << taken) - 1)
        value = (value << taken) | part
        bits -= taken
        at += taken
    return value


def signed(value: int, bits: int) -> int:
    """The two's complement number that `get` read as unsigned."""
    half = 1 << (bits - 1)
    return (value ^ half) - half
