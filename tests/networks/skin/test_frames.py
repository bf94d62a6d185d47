import binascii
import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st

from innervate.dialect import plain
from innervate.networks.skin import frames as wire
from innervate.networks.skin.protocol.constants import BEACON, COMMAND, DATA, RESTART
from innervate.networks.skin.protocol.fields import FRAME
from tests.wire.flips import flipped_thrice

Frame = plain.make("Frame", FRAME)
RANGES = {name: (length, low, high) for name, length, low, high, _unit, _meaning in FRAME}
KINDS = (BEACON, DATA, RESTART, COMMAND)


def new(kind, **values):
    frame = Frame()
    frame.kind = kind
    for name, value in values.items():
        assert name in RANGES
        setattr(frame, name, value)
    return frame


def carried(frame):
    names = [name for name, *_ in wire.FIELDS[frame.kind] if name != wire.SPARE]
    return {name: getattr(frame, name) for name in ("kind", *names)}


@st.composite
def frames(draw, kinds=KINDS):
    frame = new(draw(st.sampled_from(kinds)))
    for name in carried(frame):
        length, low, high = RANGES[name]
        if name == "kind":
            continue
        value = st.integers(low, high)
        setattr(
            frame,
            name,
            draw(st.lists(value, min_size=length, max_size=length)) if length else draw(value),
        )
    return frame


def sealed(body):
    return body + struct.pack(">H", binascii.crc_hqx(body, 0xFFFF))


def test_beacon_by_hand():
    beacon = new(BEACON, dist=3, sq=0x1234, load=0x056, size=0x789, parent=1)
    # type 1, dist 03, sq 1234, load 056, size 789, and the flag as the first bit of the last 8
    assert wire.encode(beacon) == sealed(bytes.fromhex("10312340567898"))
    assert len(wire.encode(beacon)) == 9


def test_data_by_hand():
    data = new(DATA, cell=0x0102, seq=3, hops=4, proximity=0x0506, temperature=-2)
    data.force = [0x0708, 0x090A, 0x0B0C]
    data.accel = [-1, 0, 511]
    # -1, 0, 511 in ten bits each and two spare: 1111111111 0000000000 0111111111 00
    body = bytes.fromhex("20 0102 03 04 0506 0708 090a 0b0c fe ffc007fc")
    assert wire.encode(data) == sealed(body)
    assert len(wire.encode(data)) == 20


def test_command_by_hand():
    command = new(COMMAND, cell=0x0102, sq=0x0304, hops=5, dist=6, proximity=0x0708)
    assert wire.encode(command) == sealed(bytes.fromhex("40 0102 0304 05 06 0708"))
    assert len(wire.encode(command)) == 11


def test_types_and_sizes_of_the_contract():
    assert wire.SIZES == {1: 9, 2: 20, 3: 9, 4: 11}
    bits = wire.KIND_BITS + sum(width for _name, _count, width, _signed in wire.ROUTE)
    assert bits + 8 * wire.CRC_BYTES == 69


def test_layouts_hold_exactly_the_declared_ranges():
    seen = set()
    for _kind, _name, fields in wire.LAYOUTS:
        for name, count, bits, is_signed in fields:
            if name == wire.SPARE:
                continue
            seen.add(name)
            low = -(1 << (bits - 1)) if is_signed else 0
            assert RANGES[name] == (count, low, low + (1 << bits) - 1), name
    assert seen | {"kind", "made_at"} == set(RANGES)  # made_at: a run's own


@given(frames())
def test_round_trip(frame):
    back = Frame()
    assert wire.decode(wire.encode(frame), back) == wire.OK
    assert carried(back) == carried(frame)


@given(frames(), st.booleans())
def test_any_buffer_will_do(frame, writable):
    data = wire.encode(frame)
    back = Frame()
    assert wire.decode(memoryview(bytearray(data) if writable else data), back) == wire.OK
    assert carried(back) == carried(frame)


@given(frames())
def test_every_truncation_and_extension_is_refused(frame):
    data = wire.encode(frame)
    for cut in range(len(data)):
        assert wire.decode(data[:cut], Frame()) in (wire.BAD_LENGTH, wire.BAD_CRC)
    assert wire.decode(data + b"\0", Frame()) != wire.OK


@given(frames(), st.data())
def test_up_to_three_flipped_bits_are_noticed(frame, data):
    hit = flipped_thrice(wire.encode(frame), data)
    assert wire.decode(hit, Frame()) == wire.BAD_CRC


def test_every_single_flip_and_every_short_burst_is_noticed():
    sent = wire.encode(new(DATA, cell=77, proximity=1234))
    for bit in range(8 * len(sent) - 16):
        for burst in (0x8000, 0x8001, 0xFFFF, 0xA5A5):
            hit = int.from_bytes(sent, "big") ^ (burst << (8 * len(sent) - 16 - bit))
            assert wire.decode(hit.to_bytes(len(sent), "big"), Frame()) == wire.BAD_CRC


@given(st.binary(max_size=40))
def test_noise_never_raises_nor_touches_the_frame(data):
    frame = new(BEACON, dist=200)
    before = {name: getattr(frame, name) for name in RANGES}
    reason = wire.decode(data, frame)
    assert 0 <= reason < len(wire.REASONS)
    if reason != wire.OK:
        assert {name: getattr(frame, name) for name in RANGES} == before


@given(st.binary(min_size=1, max_size=18))
def test_good_crc_of_a_stranger(body):
    frame = Frame()
    reason = wire.decode(sealed(body), frame)
    kind = body[0] >> 4
    size = len(body) + wire.CRC_BYTES
    if not wire.SIZE_MIN <= size <= wire.SIZE_MAX:
        assert reason == wire.BAD_LENGTH
    elif kind not in KINDS:
        assert reason == wire.BAD_KIND
    elif size != wire.SIZES[kind]:
        assert reason == wire.BAD_LENGTH
    else:
        assert reason == wire.OK


def test_spare_bits_are_not_looked_at():
    sent = bytearray(wire.encode(new(DATA, cell=5)))
    sent[0] |= 0x0F
    sent[-3] |= 0x03
    back = Frame()
    assert wire.decode(sealed(bytes(sent[:-2])), back) == wire.OK
    assert carried(back) == carried(new(DATA, cell=5))


@pytest.mark.parametrize(("name", "value"), [("dist", 256), ("load", 4096), ("sq", -1)])
def test_encoding_too_large_a_value_is_the_callers_mistake(name, value):
    with pytest.raises(ValueError, match=name):
        wire.encode(new(BEACON, **{name: value}))


@pytest.mark.parametrize("kind", [0, 5, 15])
def test_encoding_an_unknown_kind_is_the_callers_mistake(kind):
    with pytest.raises(ValueError, match="kind"):
        wire.encode(new(kind))
