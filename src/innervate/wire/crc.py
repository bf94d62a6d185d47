"""CRC-16/CCITT-FALSE: polynomial 0x1021, start 0xFFFF, nothing reflected; the CRC of all frames.

Half a byte at a time: the table of 16 entries is kind to boards with 16 KiB of memory.
"""

import binascii

START = 0xFFFF
HAS_HQX = hasattr(binascii, "crc_hqx")  # boards have no such thing

# The remainders of 0x0000, 0x1000 ... 0xF000.
TABLE = (
    0x0000, 0x1021, 0x2042, 0x3063, 0x4084, 0x50A5, 0x60C6, 0x70E7,
    0x8108, 0x9129, 0xA14A, 0xB16B, 0xC18C, 0xD1AD, 0xE1CE, 0xF1EF,
)  # fmt: skip


def crc16(data: bytes | bytearray | memoryview, count: int) -> int:
    """CRC of the first `count` bytes of `data`, 0..65535."""
    if HAS_HQX:
        return binascii.crc_hqx(data if count == len(data) else data[:count], START)
    return by_table(data, count)


def by_table(data: bytes | bytearray | memoryview, count: int) -> int:
    """The same without help of the system."""
    crc = START
    for i in range(count):
        byte = data[i]
        crc = ((crc << 4) & 0xFFFF) ^ TABLE[(crc >> 12) ^ (byte >> 4)]
        crc = ((crc << 4) & 0xFFFF) ^ TABLE[(crc >> 12) ^ (byte & 15)]
    return crc


def seal(buffer: bytearray) -> bytes:
    """A whole frame: its last two bytes become the CRC of what is in front of them."""
    end = len(buffer) - 2
    crc = crc16(buffer, end)
    buffer[end] = crc >> 8
    buffer[end + 1] = crc & 255
    return bytes(buffer)


def is_sealed(data: bytes | bytearray | memoryview) -> bool:
    """True if the last two of at least two bytes are the CRC of the others."""
    end = len(data) - 2
    return crc16(data, end) == data[end] << 8 | data[end + 1]
