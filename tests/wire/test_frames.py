"""Frames by their layouts alone, of a network whose kinds end inside a byte, by hand."""

from types import SimpleNamespace

import pytest

from innervate.wire.crc import seal
from innervate.wire.frames import BAD_CRC, BAD_KIND, BAD_LENGTH, OK, Codec
from innervate.wire.layout import (
    BROKEN,
    PAIRS,
    REST,
    SPARE,
    is_fixed,
    pack,
    put_number,
    read,
    unpack,
    width,
)

PING, BULK = 1, 2
LAYOUTS = (
    (PING, "ping", (("hops", 0, 5, 0), ("cold", 0, 1, 0))),  # 3 + 6 bits: 9, one beyond a byte
    (BULK, "bulk", ((SPARE, 0, 3, 0), ("heat", 2, 5, 1))),  # 3 + 13 bits: two bytes
)
CODEC = Codec(LAYOUTS, 3)


def ping(hops=0b10110, cold=1):
    return SimpleNamespace(kind=PING, hops=hops, cold=cold)


def test_a_kind_takes_whole_bytes_and_two_of_crc():
    assert CODEC.sizes == {PING: 4, BULK: 4}
    assert Codec(((PING, "ping", (("hops", 0, 5, 0),)),), 3).SIZE_MAX == 3


def test_bits_lie_where_the_layout_says():
    assert CODEC.encode(ping())[:2] == bytes((0b001_10110, 0b1000_0000))
    bulk = SimpleNamespace(kind=BULK, heat=[-1, 15])
    assert CODEC.encode(bulk)[:2] == bytes((0b010_000_11, 0b111_01111))


def test_what_was_encoded_is_read_back_and_nothing_else():
    found = SimpleNamespace(kind=9, heat=[0, 0], hops=7)
    assert CODEC.decode(CODEC.encode(SimpleNamespace(kind=BULK, heat=[-16, 3])), found) == OK
    assert (found.kind, found.heat, found.hops) == (BULK, [-16, 3], 0)
    assert not hasattr(found, SPARE)
    assert CODEC.decode(CODEC.encode(ping()), found) == OK
    assert (found.kind, found.heat) == (PING, [0, 0])


def test_a_frame_is_refused_by_the_first_that_is_wrong():
    sound, found = CODEC.encode(ping()), ping(0, 0)
    for data in (b"", sound[:-1], sound + b"\0"):
        assert CODEC.decode(data, found) == BAD_LENGTH
    assert CODEC.decode(sound[:-1] + bytes((sound[-1] ^ 1,)), found) == BAD_CRC
    assert CODEC.decode(seal(bytearray((0b011_00000, 0, 0, 0))), found) == BAD_KIND
    assert (found.hops, found.cold) == (0, 0)
    mixed = Codec((LAYOUTS[0], (BULK, "bulk", (("x", 0, 30, 0),))), 3)
    assert mixed.sizes == {PING: 4, BULK: 7}
    assert mixed.decode(seal(bytearray((0b001_00000, 0, 0, 0, 0, 0, 0))), found) == BAD_LENGTH
    assert mixed.decode(seal(bytearray((0b001_00000, 0, 0, 0, 0))), found) == BAD_LENGTH


def test_a_kind_that_is_not_there_is_the_callers_mistake():
    with pytest.raises(ValueError, match="no frame has this kind"):
        CODEC.encode(SimpleNamespace(kind=3))


@pytest.mark.parametrize(
    ("signed", "low", "high"), [(0, 0, 31), (1, -16, 15)], ids=["unsigned", "signed"]
)
def test_a_number_fits_into_its_bits_to_the_last(signed, low, high):
    for value in (low, high):
        buffer = bytearray(1)
        put_number(buffer, 0, 5, signed, value, "x")
        assert buffer[0] >> 3 == value & 31
    for value in (low - 1, high + 1):
        with pytest.raises(ValueError, match="x does not fit into its bits"):
            put_number(bytearray(1), 0, 5, signed, value, "x")


def test_widths_count_what_has_a_number():
    fields = (("a", 0, 3, 0), ("b", 4, 5, 0), (SPARE, 0, 1, 0))
    assert width(fields) == 24
    assert is_fixed(fields)
    for variable in (("c", "a", 7, 0), ("c", REST, 7, 0), ("c", PAIRS, 7, 0)):
        assert width((*fields, variable)) == 24
        assert not is_fixed((*fields, variable))


def test_packing_and_unpacking_say_where_they_end():
    fields = LAYOUTS[1][2]
    buffer = bytearray(3)
    assert pack(fields, buffer, 2, SimpleNamespace(heat=[1, 2])) == 15
    assert unpack(fields, buffer, 2, SimpleNamespace(heat=[0, 0])) == 15


# How many of something, and a group of it: what dissectors read.
GROUP = ("pairs", "count", (("x", 0, 4, 0), ("y", 0, 4, 1)), 0)


@pytest.mark.parametrize(
    ("fields", "data", "end", "expected"),
    [
        ((("n", 0, 8, 0), ("a", 2, 4, 1)), "05f1", 16, [("n", 5), ("a", [-1, 1])]),
        ((("n", 0, 8, 0), ("a", "n", 4, 0)), "03abc0", 20, [("n", 3), ("a", [10, 11, 12])]),
        ((("n", 0, 8, 0), ("a", "n", 4, 0)), "00", 8, [("n", 0), ("a", [])]),
        ((("a", REST, 8, 0),), "010203", 24, [("a", [1, 2, 3])]),
        ((("a", REST, 8, 0),), "010203", 0, [("a", [])]),
        ((("n", 0, 8, 0), ("a", PAIRS, 4, 0)), "03abc0", 20, [("n", 3), ("a", [10, 11, 12])]),
        ((("n", 0, 8, 0), ("a", PAIRS, 4, 0)), "01", 8, [("n", 1), ("a", [])]),
        ((("count", 0, 8, 0), GROUP), "021f2e", 24,
         [("count", 2), ("pairs", [[("x", 1), ("y", -1)], [("x", 2), ("y", -2)]])]),
        (((SPARE, 0, 4, 0), ("a", 0, 4, 0)), "f7", 8, [("a", 7)]),
    ],
)  # fmt: skip
def test_any_fields_are_read(fields, data, end, expected):
    found = []
    assert read(fields, bytes.fromhex(data), 0, end, found) == end
    assert found == expected
    if end and fields[0][1] != REST:  # a bit less than it needs
        assert read(fields, bytes.fromhex(data), 0, end - 1, []) == BROKEN


def test_a_rest_that_ends_inside_an_item_is_broken():
    assert read((("a", REST, 8, 0),), b"\1\2", 0, 15, []) == BROKEN
    group = (("a", REST, (("x", 0, 8, 0), ("y", 0, 8, 0)), 0),)
    assert read(group, b"\1\2\3", 0, 24, []) == BROKEN
    found = []
    assert read(group, b"\1\2\3\4", 0, 32, found) == 32
    assert found == [("a", [[("x", 1), ("y", 2)], [("x", 3), ("y", 4)]])]


def test_a_layout_that_counts_by_nothing_is_the_programmers_mistake():
    with pytest.raises(ValueError, match="counts by a field that is not there"):
        read((("a", "n", 8, 0),), b"\1", 0, 8, [])
