import binascii
import random
import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st

from innervate.dialect import plain
from innervate.networks.radio import frames as wire
from innervate.networks.radio.protocol.constants import CRR, DATA, OPEN, REPORT
from innervate.networks.radio.protocol.fields import FRAME
from tests.wire.flips import flipped

Frame = plain.make("Frame", FRAME)
RANGES = {name: (length, low, high) for name, length, low, high, _unit, _meaning in FRAME}


def new(kind, **values):
    frame = Frame()
    frame.kind = kind
    frame.slots = 1
    for name, value in values.items():
        assert name in RANGES
        setattr(frame, name, value)
    return frame


def everything(frame):
    return {
        name: list(getattr(frame, name)) if RANGES[name][0] else getattr(frame, name)
        for name in RANGES
    }


def sealed(body):
    return body + struct.pack(">H", binascii.crc_hqx(body, 0xFFFF))


@st.composite
def frames(draw):
    """A frame, and the bytes of the packets in it."""
    kind = draw(st.sampled_from([CRR, DATA, OPEN, REPORT]))
    frame = new(kind)
    for name, _many, _bits, _signed in wire.FIELDS.get(kind, ()):
        if name != wire.SPARE:
            length, low, high = RANGES[name]
            value = st.integers(low, high)
            several = st.lists(value, min_size=length, max_size=length)
            setattr(frame, name, draw(several if length else value))
    return frame, draw(st.binary(max_size=60)) if kind in (DATA, OPEN) else b""


def test_crr_is_a_bare_byte():
    assert wire.encode(new(CRR)) == b"\xc5"
    back = new(DATA, slots=25, pos=3, good=[1, 2])
    assert wire.decode(b"\xc5", back) == wire.OK
    assert everything(back) == everything(new(CRR))
    assert wire.decode(b"\xc4", back) == wire.BAD_KIND


def test_data_by_hand():
    frame = new(DATA, pos=3, next=127, more=1, ok=0, slots=25, source=0x155, count=2, handle=0xBEEF)
    # version 1, type 2; 0000011 1111111 1 0; 0000 and 12 bits; 00, 10 bits and 4 bits
    body = bytes.fromhex("12 07fe 0019 1552 beef") + b"packet"
    assert wire.encode(frame, b"packet") == sealed(body)
    assert wire.payload_of(sealed(body)) == b"packet"


def test_report_by_hand():
    frame = new(REPORT, pos=1, base=2, window=3, span=4, split=1, kept=5, slots=7,
                good=[0x0102, 0x0304], bad=[0x0506, 0x0708])  # fmt: skip
    # 0000001 0000010 000011 0000000100 1 00 00101 and six spare bits in front of twelve
    body = bytes.fromhex("14 02083012 140007 0102 0304 0506 0708")
    assert wire.encode(frame) == sealed(body)


def test_the_headers_of_the_contract_are_two_bytes():
    names = [name for name, *_ in wire.TURN[:4]]
    assert names == ["pos", "next", "more", "ok"]
    assert sum(bits for _n, _m, bits, _s in wire.TURN[:4]) == 16


def test_layouts_hold_exactly_the_declared_ranges():
    seen = set()
    for _kind, _name, fields in wire.LAYOUTS:
        for name, many, bits, is_signed in fields:
            if name != wire.SPARE:
                seen.add(name)
                assert RANGES[name] == (many, 0, (1 << bits) - 1), name
                assert not is_signed
    assert seen | {"kind"} == set(RANGES)


@given(frames())
def test_round_trip(case):
    frame, payload = case
    data = wire.encode(frame, payload)
    back = Frame()
    for name in RANGES:
        setattr(back, name, [5, 6] if RANGES[name][0] else 1)
    assert wire.decode(memoryview(data), back) == wire.OK
    assert everything(back) == everything(frame)
    assert wire.payload_of(memoryview(data)) == payload
    pairs = shown(frame)
    assert all(value == everything(frame)[name] for name, value in pairs if name != "version")
    declared = [name for name, *_ in wire.FIELDS.get(frame.kind, ()) if name != wire.SPARE]
    assert [name for name, _ in pairs] == ["version", "kind", *declared]


@given(frames())
def test_truncations_and_single_flips_are_refused(case):
    sent = wire.encode(*case)
    for cut in range(len(sent)):
        by_chance = cut > 2 and sealed(sent[: cut - 2]) == sent[:cut]
        assert by_chance or wire.decode(sent[:cut], Frame()) != wire.OK
    for bit in range(8 * len(sent)):
        assert wire.decode(flipped(sent, bit), Frame()) in (wire.BAD_CRC, wire.BAD_KIND)


def shown(frame):
    """The frame as pairs of names and values, read by the layouts."""
    pairs = [("version", wire.VERSION), ("kind", frame.kind)]
    for name, many, _bits, _signed in wire.FIELDS.get(frame.kind, ()):
        if name != wire.SPARE:
            value = getattr(frame, name)
            pairs.append((name, list(value) if many else value))
    return pairs


def feed(data):
    frame = new(DATA, pos=77)
    before = everything(frame)
    reason = wire.decode(data, frame)
    if reason != wire.OK:
        assert everything(frame) == before
    else:
        shown(frame)
        wire.encode(frame, wire.payload_of(data))
    return reason


def noise(seed, count):
    """Bytes of all lengths; of most the CRC is right, and the head nearly."""
    source = random.Random(seed)
    for k in range(count):
        data = bytearray(source.randbytes(source.randrange(40)))
        if k % 4 and data:
            data[0] = source.choice([0x12, 0x13, 0x14, 0x1F, 0x24])
        yield sealed(bytes(data)) if k % 4 else bytes(data)


@pytest.mark.parametrize("count", [4000, pytest.param(100_000, marks=pytest.mark.slow)])
def test_noise_never_raises_nor_touches_the_frame(count):
    assert {feed(data) for data in noise(count, count)} == set(range(len(wire.REASONS)))


def test_what_is_too_long():
    frame = new(DATA)
    full = wire.encode(frame, bytes(wire.PAYLOAD_MAX))
    assert wire.decode(full, Frame()) == wire.OK
    assert wire.decode(full + b"\0", Frame()) == wire.BAD_LENGTH
    assert wire.decode(sealed(wire.encode(new(REPORT))[:-2] + b"\0"), Frame()) == wire.BAD_LENGTH
    with pytest.raises(ValueError, match="payload"):
        wire.encode(frame, bytes(wire.PAYLOAD_MAX + 1))


@pytest.mark.parametrize(
    ("frame", "payload", "word"),
    [
        (new(CRR, slots=2), b"", "slots"),
        (new(CRR), b"x", "payload"),
        (new(REPORT), b"x", "payload"),
        (new(5), b"", "kind"),
        (new(DATA, pos=128), b"", "pos"),
    ],
)
def test_encoding_what_does_not_fit_is_the_callers_mistake(frame, payload, word):
    with pytest.raises(ValueError, match=word):
        wire.encode(frame, payload)
