import binascii
import random
import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st

from innervate.dialect import plain
from innervate.networks.mesh import frames as wire
from innervate.networks.mesh import payloads as payloads
from innervate.networks.mesh.meanings import MEANINGS
from innervate.networks.mesh.protocol import constants as const
from innervate.networks.mesh.protocol.fields import FRAME
from innervate.wire.bits import put
from innervate.wire.layout import REST, read
from tests.networks.mesh import shown
from tests.wire.flips import flipped, flipped_thrice

Frame = plain.make("Frame", FRAME)
RANGES = {name: (length, low, high) for name, length, low, high, _unit, _meaning in FRAME}
ROOM = const.MTU - const.HEADER_BYTES - const.CRC_BYTES


@pytest.mark.parametrize(("fields", "form"), [(wire.COMMON, wire.PACKET_STRUCT),
                                              (wire.HOP_ACK, wire.ACK_STRUCT)])  # fmt: skip
def test_what_struct_reads_are_the_fields_behind_version_and_kind(fields, form):
    letters = {(8, 0): "B", (16, 0): "H", (8, 1): "b"}
    assert form == ">B" + "".join(letters[bits, signed] for _, _, bits, signed in fields)
    assert not any(many for _, many, _, _ in fields)


def new(kind, path=(), body=b"", **values):
    frame = Frame()
    frame.kind = kind
    for name, items in (("path", path), ("body", body)):
        for k, item in enumerate(items):
            getattr(frame, name)[k] = item
    frame.path_len, frame.length = len(path), len(body)
    for name, value in values.items():
        assert name in RANGES
        setattr(frame, name, value)
    return frame


def carried(frame):
    """What a frame's bytes say: of path and body what is used, an ack's rssi."""
    value = {name: getattr(frame, name) for name in RANGES}
    value["path"] = list(frame.path[: frame.path_len])
    value["body"] = list(frame.body[: frame.length])
    if frame.kind != const.ACK:
        value.pop("rssi")
    return value


def sealed(body):
    return body + struct.pack(">H", binascii.crc_hqx(body, 0xFFFF))


class Writer:
    """Bits drawn for a layout, with its counts kept true."""

    def __init__(self, draw):
        self.draw = draw
        self.bits = []

    def write(self, fields, room):
        """Fields of at most `room` bits; returns the bits used."""
        used = 0
        seen = {}
        counted = {many: each for _n, many, each, _s in fields if isinstance(many, str)}
        for name, many, bits, _signed in fields:
            if isinstance(bits, tuple) or many == REST or isinstance(many, str):
                count = seen[many] if isinstance(many, str) else self.draw(st.integers(0, 12))
                for _ in range(count):
                    if isinstance(bits, tuple):
                        each = sum(b for _n, m, b, _s in bits if m == 0)
                        if many == REST and used + each > room:
                            break
                        used += self.write(bits, room - used)
                    elif many != REST or used + bits <= room:
                        used += self.number(bits, self.draw(st.integers(0, (1 << bits) - 1)))
                continue
            high = (1 << bits) - 1
            if name in counted:
                each = counted[name]
                each = 8 * len(each) if isinstance(each, tuple) else each
                high = min(high, max(0, room - used - bits - 64) // each)
            seen[name] = self.draw(st.integers(0, high))
            used += self.number(bits, seen[name])
        return used

    def number(self, bits, value):
        self.bits.append((bits, value))
        return bits

    def bytes(self):
        total = sum(bits for bits, _value in self.bits)
        buffer = bytearray((total + 7) // 8)
        at = 0
        for bits, value in self.bits:
            put(buffer, at, bits, value)
            at += bits
        return bytes(buffer)


@st.composite
def packets(draw, kinds=tuple(payloads.FIELDS)):
    kind = draw(st.sampled_from(kinds))
    path = draw(st.lists(st.integers(0, 255), max_size=const.PATH_MAX))
    flags = draw(st.integers(0, 255)) & ~(const.SOURCE_ROUTE | const.DETOURED)
    room = ROOM - len(path)
    writer = Writer(draw)
    writer.write(payloads.FIELDS[kind], 8 * room)
    body = writer.bytes()
    route = draw(st.none() | st.binary(max_size=5))
    failed = draw(st.none() | st.binary(min_size=1, max_size=5))
    if route is not None and len(body) + len(route) < room:
        body, flags = bytes([len(route)]) + route + body, flags | const.SOURCE_ROUTE
    if failed is not None and len(body) + len(failed) < room:
        body, flags = body + failed + bytes([len(failed)]), flags | const.DETOURED
    frame = new(kind, path, body, flags=flags)
    for name in ("link_src", "link_dst", "origin", "dest", "seq", "table_ver", "ttl"):
        _length, low, high = RANGES[name]
        setattr(frame, name, draw(st.integers(low, high)))
    return frame


acks = st.builds(
    lambda more, **values: new(const.ACK, (), b"".join(more), dest=values["link_dst"], **values),
    more=st.lists(st.binary(min_size=3, max_size=3), max_size=4),
    **{
        name: st.integers(*RANGES[name][1:])
        for name in ("link_src", "link_dst", "origin", "seq", "rssi")
    },
)
frames = packets() | acks


def test_request_by_hand():
    request = new(
        const.REQUEST, path=[7], body=bytes.fromhex("07 01 0203 0405 0a"), link_src=7,
        link_dst=255, origin=7, dest=255, seq=0xBEEF, table_ver=5, ttl=24,
    )  # fmt: skip
    # version 1 in two bits and type 1 in six; no flags; 7 to all; seq, version, ttl, a path of one
    expected = sealed(bytes.fromhex("41 00 07 ff 07 ff beef 05 18 01 07 07 01 0203 0405 0a"))
    assert wire.encode(request) == expected
    assert len(expected) == const.HEADER_BYTES + 1 + 7 + const.CRC_BYTES


def test_ack_by_hand():
    ack = new(const.ACK, link_src=3, link_dst=4, origin=9, seq=0x0102, rssi=-95)
    assert wire.encode(ack) == sealed(bytes.fromhex("50 03 04 09 0102 a1"))
    assert len(wire.encode(ack)) == const.ACK_BYTES


ALARM = bytes.fromhex("05 01 2a 01 fffe 0102 ce 32 00010203 ffed")


def test_alarm_by_hand():
    alarm = new(const.ALARM, path=[5, 6], body=ALARM, origin=5, dest=2, seq=1, ttl=22,
                flags=const.ACK_WANTED | const.END_TO_END | const.PRIORITY)  # fmt: skip
    data = wire.encode(alarm)
    assert data == sealed(bytes.fromhex("4a 23 00 00 05 02 0001 00 16 02 05 06") + ALARM)
    pairs = dict(shown.fields(alarm))
    assert pairs["path"] == [5, 6]
    expected = {"robot": 5, "fence": 1, "number": 42, "alarm": 1, "x": -2, "y": 258, "vx": -50,
                "vy": 50, "time": 0x10203, "margin": -19}  # fmt: skip
    assert {name: pairs[name] for name in expected} == expected


def test_response_and_table_by_hand():
    response = new(const.RESPONSE, body=bytes.fromhex("01 0002 32 08 b0 09 80"))
    assert shown.fields(response)[-1] == (
        "neighbours",
        [[("id", 8), ("rssi", -80)], [("id", 9), ("rssi", -128)]],
    )
    table = new(const.TABLE, body=bytes.fromhex("02 0304 01 0002 12  05 ff 02 0607  08 09 00"))
    pairs = dict(shown.fields(table))
    assert pairs["route"] == [3, 4]
    assert (pairs["fragment"], pairs["fragments"], pairs["table_version"]) == (1, 2, 2)
    assert pairs["groups"] == [
        [("next", 5), ("alt", 255), ("count", 2), ("dests", [6, 7])],
        [("next", 8), ("alt", 9), ("count", 0), ("dests", [])],
    ]


def test_route_and_failed_nodes_lie_around_the_payload():
    flags = const.SOURCE_ROUTE | const.DETOURED
    data = new(const.DATA, body=b"\x02\x08\x09hello\x07\x01", flags=flags)
    assert shown.fields(data)[-3:] == [
        ("source_route", [8, 9]),
        ("data", list(b"hello")),
        ("failed", [7]),
    ]


def test_detoured_may_be_a_mark_and_nothing_else():
    for body, told in ((b"abc", [("acked", [0x6162])]), (b"\1\2", [("acked", [0x0102])])):
        frame = new(const.E2E_ACK, body=body[:2], flags=const.DETOURED)
        assert wire.decode(wire.encode(frame), Frame()) == wire.OK
        assert shown.fields(frame)[-1:] == told
    both = new(const.E2E_ACK, body=b"\1\2\x09\1", flags=const.DETOURED)
    assert shown.fields(both)[-2:] == [("acked", [0x0102]), ("failed", [9])]


def test_whole_graph_by_hand():
    found = []  # three nodes; 0-1 and 1-2 are links
    assert read(payloads.WHOLE_GRAPH, b"\x03\x00\x01\x02\xa0", 0, 40, found) == 35
    assert found == [("nodes", 3), ("ids", [0, 1, 2]), ("links", [1, 0, 1])]


# The sizes of the packets' table [mesh 2].
@pytest.mark.parametrize(
    ("kind", "size"),
    [(const.TABLE_ACK, 5), (const.ACTIVATE, 3), (const.ALARM, 16), (const.POSITION, 8)],
)
def test_sizes_of_the_contract(kind, size):
    assert payloads.SIZES[kind] == size
    for length in (size - 1, size, size + 1):
        data = sealed(bytes([0x40 | kind, *[0] * 10, *[0] * length]))
        expected = wire.OK if length == size else wire.BAD_PAYLOAD
        assert wire.decode(data, Frame()) == expected


def test_acks_name_as_many_packets_as_they_say():
    ack = new(const.ACK, body=b"\x05\x01\x02\x06\x03\x04", link_src=3, link_dst=4, origin=9,
              seq=258, rssi=-95, path=[])  # fmt: skip
    data = wire.encode(ack)
    assert data[:-2] == bytes.fromhex("50 03 04 09 0102 a1 05 0102 06 0304")
    back = Frame()
    assert wire.decode(data, back) == wire.OK
    assert wire.acked(back) == [(9, 258), (5, 258), (6, 772)]
    more = [[("origin", 5), ("seq", 258)], [("origin", 6), ("seq", 772)]]
    assert shown.fields(back)[-1] == ("more", more)
    ends = new(const.E2E_ACK, body=b"\1\2\3\4")
    assert shown.fields(ends)[-1] == ("acked", [0x0102, 0x0304])


def test_layouts_hold_exactly_the_declared_ranges():
    for fields in (wire.COMMON, wire.HOP_ACK):
        for name, _many, bits, is_signed in fields:
            low = -(1 << (bits - 1)) if is_signed else 0
            high = const.PATH_MAX if name == "path_len" else low + (1 << bits) - 1
            assert RANGES[name] == (0, low, high), name
    in_frames = {name for name, *_ in wire.HEAD + wire.COMMON + wire.HOP_ACK} - {"version"}
    assert in_frames | {"path", "length", "body"} == set(RANGES)


def names_in(fields):
    for name, _many, bits, _signed in fields:
        yield name
        if isinstance(bits, tuple):
            yield from names_in(bits)


def test_every_field_of_a_payload_has_a_meaning_and_no_other():
    layouts = [*payloads.FIELDS.values(), payloads.PIECE, payloads.WHOLE_GRAPH]
    assert {name for fields in layouts for name in names_in(fields)} == set(MEANINGS)


@given(frames)
def test_round_trip(frame):
    back = new(const.DATA, path=[9], body=b"old", flags=3, rssi=-7)
    data = wire.encode(frame)
    assert len(data) == wire.size_of(frame) <= const.MTU
    assert wire.decode(memoryview(data), back) == wire.OK
    assert carried(back) == carried(frame)
    assert back.rssi == (frame.rssi if frame.kind == const.ACK else -7)


@given(frames)
def test_fields_name_every_byte(frame):
    pairs = shown.fields(frame)
    names = [name for name, _value in pairs]
    assert len(set(names)) == len(names)
    assert "payload" not in names
    assert all(dict(pairs)[name] == getattr(frame, name) for name in names if name in RANGES
               and name not in ("path",))  # fmt: skip


@given(frames)
def test_every_truncation_and_extension_is_refused(frame):
    data = wire.encode(frame)
    for cut in range(len(data)):
        by_chance = cut > 2 and sealed(data[: cut - 2]) == data[:cut]
        reason = wire.decode(data[:cut], Frame())
        assert by_chance or reason in (wire.BAD_LENGTH, wire.BAD_CRC)
    # The CRC of a frame and a zero is right again: what has a length of its own sees it.
    reason = wire.decode(data + b"\0", Frame())
    endless = frame.kind in (const.REQUEST, const.DATA, const.GRAPH)
    endless = endless or frame.flags & const.DETOURED
    assert endless or reason != wire.OK
    assert wire.decode(data + b"\1", Frame()) in (wire.BAD_CRC, wire.BAD_LENGTH)


@given(frames)
def test_every_single_flip_is_refused(frame):
    sent = wire.encode(frame)
    for bit in range(8 * len(sent)):
        assert wire.decode(flipped(sent, bit), Frame()) == wire.BAD_CRC


@given(frames, st.data())
def test_up_to_three_flips_are_refused(frame, data):
    hit = flipped_thrice(wire.encode(frame), data)
    assert wire.decode(hit, Frame()) == wire.BAD_CRC


def feed(data):
    """Decode any bytes: a frame that is refused stays as it was, one that is not can be told."""
    frame = new(const.DATA, path=[9], body=b"old", flags=3)
    before = carried(frame)
    reason = wire.decode(data, frame)
    assert 0 <= reason < len(wire.REASONS)
    if reason != wire.OK:
        assert carried(frame) == before
    else:
        shown.fields(frame)
        assert wire.encode(frame) == bytes(data)
    return reason


def noise(seed, count):
    """Bytes of all lengths; of most the CRC is right, and the head nearly."""
    source = random.Random(seed)
    for k in range(count):
        data = bytearray(source.randbytes(source.randrange(140)))
        if k % 4 and len(data) >= 11:
            data[0] = 0x40 | source.choice([*payloads.FIELDS, const.ACK, 63])
            data[1] &= source.choice([0, 8, 16, 255])
            data[10] = source.choice([0, 1, 24, 25, data[10]])
        yield sealed(bytes(data)) if k % 4 else bytes(data)


@pytest.mark.parametrize("count", [4000, pytest.param(100_000, marks=pytest.mark.slow)])
def test_noise_never_raises_nor_touches_the_frame(count):
    assert {feed(data) for data in noise(count, count)} == set(range(len(wire.REASONS)))


@given(st.binary(max_size=140))
def test_any_bytes_in_a_good_crc(body):
    feed(sealed(body))


@pytest.mark.parametrize(
    ("body", "reason"),
    [
        ("88 00 00 00 00 00 0000 00 00 00", wire.BAD_VERSION),
        ("46 00 00 00 00 00 0000 00 00 00", wire.BAD_KIND),
        ("48 00 00 00 00 00 0000 00 00 19" + 25 * " 00", wire.BAD_PATH),
        ("48 00 00 00 00 00 0000 00 00 01", wire.BAD_LENGTH),
        ("48 00 00 00 00 00 0000 00 00", wire.BAD_LENGTH),
        ("48 08 00 00 00 00 0000 00 00 00 01", wire.BAD_PAYLOAD),
        ("49 00 00 00 00 00 0000 00 00 00 aa bb cc", wire.BAD_PAYLOAD),
        ("50 03 04 09 0102 a1 05 0607 08", wire.BAD_LENGTH),
        ("42 00 00 00 00 00 0000 00 00 00 01 0002 12 08 b0 09", wire.BAD_PAYLOAD),
        ("50 03 04 09 0102 a1 00", wire.BAD_LENGTH),
    ],
)
def test_reasons(body, reason):
    assert wire.decode(sealed(bytes.fromhex(body)), Frame()) == reason


def test_the_mtu_holds_both_ways():
    frame = new(const.DATA, body=bytes(51))
    assert len(wire.encode(frame, 64)) == 64
    frame.length = 52
    with pytest.raises(ValueError, match="MTU"):
        wire.encode(frame, 64)
    assert wire.decode(wire.encode(frame), Frame(), 64) == wire.BAD_LENGTH
    long = sealed(bytes([0x48, *[0] * 10, *[0] * (const.BODY + 1)]))
    assert wire.decode(long, Frame(), 1200) == wire.BAD_LENGTH


@pytest.mark.parametrize(
    ("name", "value"),
    [("seq", 65536), ("ttl", -1), ("kind", 6), ("path_len", 25), ("length", 115),
     ("length", -1), ("path", [256] * 24), ("body", [-1] * 114)],
)  # fmt: skip
def test_encoding_what_does_not_fit_is_the_callers_mistake(name, value):
    frame = new(const.DATA, path=[1], body=b"x")
    setattr(frame, name, value)
    with pytest.raises(ValueError, match=name):
        wire.encode(frame)
