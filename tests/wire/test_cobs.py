import random

import pytest
from hypothesis import given
from hypothesis import strategies as st

from innervate.wire.cobs import Decoder, encode

some = st.binary(max_size=40) | st.integers(250, 520).map(lambda n: bytes([7]) * n)


# The examples of Cheshire and Baker's paper, as they are commonly tabled.
@pytest.mark.parametrize(
    ("data", "sent"),
    [
        ("", "01 00"),
        ("00", "01 01 00"),
        ("00 00", "01 01 01 00"),
        ("00 11 00", "01 02 11 01 00"),
        ("11 22 00 33", "03 11 22 02 33 00"),
        ("11 22 33 44", "05 11 22 33 44 00"),
        ("11 00 00 00", "02 11 01 01 01 00"),
    ],
)
def test_by_hand(data, sent):
    assert encode(bytes.fromhex(data)) == bytes.fromhex(sent)


def test_blocks_of_254():
    run = bytes(range(1, 256))
    assert encode(run[:254]) == b"\xff" + run[:254] + b"\0"
    assert encode(b"\0" + run[:254]) == b"\x01\xff" + run[:254] + b"\0"
    assert encode(run) == b"\xff" + run[:254] + b"\x02\xff\0"
    assert encode(run[1:] + b"\0") == b"\xff" + run[1:] + b"\x01\x01\0"
    assert encode(run[2:] + b"\0\1") == b"\xfe" + run[2:] + b"\x02\x01\0"


@given(st.lists(some, max_size=4), st.integers(1, 9))
def test_frames_arrive_however_the_line_cuts_them(frames, step):
    line = b"".join(encode(frame) for frame in frames)
    assert line.count(0) == len(frames)
    decoder = Decoder(600)
    found = [f for k in range(0, len(line), step) for f in decoder.feed(line[k : k + step])]
    assert found == frames
    assert decoder.dropped == 0


@given(some)
def test_the_cost_is_a_byte_for_every_254(data):
    assert len(encode(data)) <= len(data) + max(1, -(-len(data) // 254)) + 1


@given(st.binary(max_size=60), st.lists(st.binary(max_size=9), min_size=1, max_size=3))
def test_a_receiver_finds_the_next_frame_again(noise, frames):
    decoder = Decoder(600)
    decoder.feed(noise)
    decoder.feed(b"\0")
    assert [f for frame in frames for f in decoder.feed(encode(frame))] == frames


def test_too_long_is_dropped_and_counted():
    decoder = Decoder(5)
    assert decoder.feed(encode(b"12345")) == [b"12345"]
    assert decoder.feed(encode(b"123456")) == []
    assert decoder.dropped == 1
    assert decoder.feed(encode(b"\0" * 6) + encode(b"ok")) == [b"ok"]
    assert decoder.dropped == 2


def test_zeros_of_an_idle_line_are_nothing():
    decoder = Decoder(9)
    assert decoder.feed(b"\0\0\0" + encode(b"a") + b"\0\0") == [b"a"]
    assert decoder.dropped == 0


def test_a_block_cut_short_is_dropped_and_counted():
    decoder = Decoder(9)
    assert decoder.feed(b"\x05ab\0" + encode(b"a")) == [b"a"]
    assert decoder.dropped == 1


def soak(count):
    source = random.Random(3)
    decoder = Decoder(64)
    frames = 0
    for _ in range(count):
        data = bytes(source.choice((0, 1, 2, 200, 255)) for _ in range(source.randrange(12)))
        for frame in decoder.feed(data):
            assert len(frame) <= 64
            frames += 1
        assert len(decoder._buffer) <= 64
    return frames, decoder.dropped


def test_noise_never_raises():
    frames, dropped = soak(3000)
    assert frames > 200
    assert dropped > 200


@pytest.mark.slow
def test_a_hundred_thousand_pieces_of_noise():
    soak(100_000)
