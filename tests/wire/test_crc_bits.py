import binascii

from hypothesis import given
from hypothesis import strategies as st

from innervate.wire.bits import get, put, signed
from innervate.wire.crc import START, by_table, crc16, is_sealed, seal


def test_crc_check_value():
    assert crc16(b"123456789", 9) == 0x29B1
    assert crc16(b"", 0) == START


@given(st.binary(max_size=40))
def test_crc_agrees_with_the_standard_library(data):
    assert crc16(data, len(data)) == binascii.crc_hqx(data, START)
    assert by_table(data, len(data)) == binascii.crc_hqx(data, START)


def test_boards_have_the_same_of_every_byte():
    for byte in range(256):
        data = bytes([byte, 255 - byte, 7])
        assert by_table(data, 2) == binascii.crc_hqx(data[:2], START)


def test_a_frame_is_sealed_by_its_last_two_bytes():
    frame = seal(bytearray(b"123456789??"))
    assert frame == b"123456789\x29\xb1"
    assert is_sealed(frame)
    for at in range(len(frame)):
        changed = bytearray(frame)
        changed[at] ^= 1
        assert not is_sealed(changed)


def test_crc_leaves_the_rest_alone():
    assert crc16(b"123456789 and more", 9) == 0x29B1


def test_bits_are_most_significant_first():
    buffer = bytearray(3)
    put(buffer, 0, 4, 0xA)
    put(buffer, 4, 12, 0xBCD)
    put(buffer, 17, 2, 0b11)
    assert buffer.hex() == "abcd60"


@given(
    st.lists(
        st.integers(1, 30).flatmap(
            lambda bits: st.tuples(st.just(bits), st.integers(-(1 << (bits - 1)), (1 << bits) - 1))
        ),
        max_size=12,
    )
)
def test_neighbouring_numbers_do_not_touch_each_other(numbers):
    buffer = bytearray(60)
    at = 0
    for bits, value in numbers:
        put(buffer, at, bits, value)
        at += bits
    at = 0
    for bits, value in numbers:
        read = get(buffer, at, bits)
        assert (signed(read, bits) if value < 0 else read) == value
        at += bits
