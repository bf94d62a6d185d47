"""What is in front of a sealed frame byte by byte, and which counters are taken."""

import pytest

from innervate.wire import seal
from innervate.wire.seal import CONTROL, COUNTER_MAX, FRAME, GROUP, OVERHEAD_BYTES, WINDOW, Window


def test_the_header_byte_by_byte():
    made = seal.header(FRAME, 0x12345678, 0x010203FF)
    assert made.hex() == "c312345678010203ff"
    assert seal.header(CONTROL, 0, COUNTER_MAX).hex() == "c500000000ffffffff"
    assert OVERHEAD_BYTES == len(made) + 16 == 25


@pytest.mark.parametrize("kind", [FRAME, GROUP, CONTROL])
def test_what_was_written_is_read(kind):
    data = seal.header(kind, 0xFE010203, 77) + bytes(16)
    assert seal.fields(data) == (kind, 0xFE010203, 77)


def test_what_is_too_short_or_no_sealed_frame_is_nothing():
    data = seal.header(FRAME, 2, 3) + bytes(16)
    assert seal.fields(data[:-1]) is None  # less than a tag
    assert seal.fields(b"") is None
    for first, sealed, read in ((0xBF, False, False), (0xC0, True, False), (0xC2, True, False),
                                (0xC3, True, True), (0xC5, True, True), (0xC6, True, False),
                                (0xD0, True, False), (0xFF, True, False)):  # fmt: skip
        other = bytes((first,)) + data[1:]
        assert seal.is_sealed(other) is sealed
        assert (seal.fields(other) is not None) is read
    assert not seal.is_sealed(b"")


def test_a_window_takes_each_counter_once():
    window = Window()
    assert window.is_new(0)
    for counter in (0, 5, 3):
        assert window.is_new(counter)
        window.take(counter)
        assert not window.is_new(counter)
    assert [counter for counter in range(7) if window.is_new(counter)] == [1, 2, 4, 6]
    assert window.highest == 5


def test_a_window_forgets_at_its_edge_and_not_before():
    window = Window()
    window.take(0)
    window.take(WINDOW - 1)
    assert not window.is_new(0)  # still known
    assert window.is_new(1)
    window.take(WINDOW)
    assert not window.is_new(0)  # not known any more, so refused
    assert window.is_new(1)
    window.take(WINDOW + 1)
    assert not window.is_new(1)
    assert window.bits < 1 << WINDOW


@pytest.mark.parametrize("ahead", [1, WINDOW - 1, WINDOW, WINDOW + 1, 10 * WINDOW])
def test_a_jump_keeps_what_is_still_in_the_window(ahead):
    window = Window()
    window.take(10)
    window.take(10 + ahead)
    assert window.bits == (1 << ahead | 1 if ahead < WINDOW else 1)
    assert not window.is_new(10)
    assert window.is_new(11 + ahead)


def test_after_a_restart_only_what_is_ahead_is_new():
    window = Window(100)
    assert [window.is_new(counter) for counter in (0, 1, 99, 100, 101)] == [False] * 4 + [True]
    window.take(102)
    assert window.is_new(101)
    assert not window.is_new(100)
    assert not Window(0).is_new(0)
