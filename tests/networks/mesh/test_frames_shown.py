"""Frames of a mesh at the ends of what they hold, and as they are shown."""

from innervate.networks.mesh import frames as wire
from innervate.networks.mesh import payloads as payloads
from innervate.networks.mesh.protocol import constants as const
from innervate.wire.layout import BROKEN, read
from tests.networks.mesh import shown
from tests.networks.mesh.test_frames import Frame, new, sealed


def test_a_path_may_be_as_long_as_a_packet_holds_and_no_longer():
    data = wire.encode(new(const.DATA, path=range(const.PATH_MAX), body=b"x"))
    back = Frame()
    assert wire.decode(data, back) == wire.OK
    assert list(back.path[: back.path_len]) == list(range(const.PATH_MAX))
    longer = bytearray(data[:-2] + bytes(2))
    longer[wire.PATH_LEN_AT] += 1
    assert wire.decode(sealed(bytes(longer[:-2])), back) == wire.BAD_PATH


def test_a_record_may_have_just_as_much_room_as_a_packet_needs():
    data = wire.encode(new(const.DATA, path=[1], body=b"four"))
    small = new(const.DATA)
    for room, reason in ((4, wire.OK), (3, wire.BAD_LENGTH)):
        small.body = [0] * room
        assert wire.decode(data, small) == reason


def test_a_frame_is_shown_with_the_fields_that_it_has():
    ack = new(const.ACK, link_src=1, link_dst=2, origin=3, seq=4, rssi=-5)
    own = [("link_src", 1), ("link_dst", 2), ("origin", 3), ("seq", 4), ("rssi", -5)]
    assert shown.fields(ack) == [("version", wire.VERSION), ("kind", const.ACK), *own]
    ack.length, ack.body[:3] = 3, [7, 1, 2]
    assert shown.fields(ack)[7:] == [("more", [[("origin", 7), ("seq", 258)]])]
    data = new(const.DATA, path=[9], body=b"a", flags=0, link_src=1, link_dst=2, origin=3, dest=4,
               seq=5, table_ver=6, ttl=7)  # fmt: skip
    assert shown.fields(data) == [
        ("version", wire.VERSION), ("kind", const.DATA), ("flags", 0), ("link_src", 1),
        ("link_dst", 2), ("origin", 3), ("dest", 4), ("seq", 5), ("table_ver", 6), ("ttl", 7),
        ("path_len", 1), ("path", [9]), ("data", [97])]  # fmt: skip


def test_a_payload_that_is_too_short_is_shown_as_it_is():
    assert shown.fields(new(const.ALARM, body=b"\1\2"))[-1] == ("payload", [1, 2])
    assert shown.fields(new(6, body=b"\1"))[-1] == ("payload", [1])
    assert read(payloads.NEIGHBOUR, b"\1", 0, 8, []) == BROKEN
