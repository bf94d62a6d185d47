"""Captures as we write them are read the same by us and by others; damage is told in one line."""

import random

import pcapng as others
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pcapng.blocks import EnhancedPacket, InterfaceDescription

from innervate.export import links, pcapng
from innervate.export.errors import ExportError
from innervate.export.files import whole
from innervate.export.reading import Capture

MOMENT = 1_700_000_000_123_456_789


def sample():
    """Blocks of a capture, and what is in them."""
    interfaces = [links.Interface(147, "c0 E", "cell 0 port 1; c0 E to c1 W"),
                  links.Interface(148, "n3 \u00fc", "node 3")]  # fmt: skip
    packets = [(i % 2, MOMENT + i, bytes(range(i)), 1 + i % 2, "dropped: noise" * (i % 3))
               for i in range(9)]  # fmt: skip
    blocks = [pcapng.section("what it is", "innervate")]
    blocks += [pcapng.interface(*one) for one in interfaces]
    blocks += [pcapng.packet(a, b, c, d, e.encode()) for a, b, c, d, e in packets]
    return blocks, interfaces, packets


def written(tmp_path, data):
    path = tmp_path / "some.pcapng"
    path.write_bytes(data)
    return path


def test_we_read_what_we_write(tmp_path):
    blocks, interfaces, packets = sample()
    capture = Capture(written(tmp_path, b"".join(blocks)))
    assert [tuple(packet) for packet in capture.packets()] == packets
    assert capture.interfaces == interfaces
    assert not capture.cut_short


def test_others_read_what_we_write(tmp_path):
    blocks, interfaces, packets = sample()
    with written(tmp_path, b"".join(blocks)).open("rb") as file:
        found = list(others.FileScanner(file))
    told = [block for block in found if isinstance(block, InterfaceDescription)]
    assert [(one.link_type, one.options["if_name"], one.options["if_description"])
            for one in told] == [tuple(one) for one in interfaces]  # fmt: skip
    read = [block for block in found if isinstance(block, EnhancedPacket)]
    for block, (number, time_ns, data, flags, comment) in zip(read, packets, strict=True):
        assert block.interface_id == number
        assert block.packet_data == data
        assert (block.timestamp_high << 32) + block.timestamp_low == time_ns
        assert block.interface.timestamp_resolution == pytest.approx(1e-9)
        assert block.options["epb_flags"].inout == ("inbound", "outbound")[flags - 1]
        assert block.options.get("opt_comment", "") == comment


def test_a_capture_that_still_grows_is_read_up_to_its_last_whole_block(tmp_path):
    blocks, _interfaces, packets = sample()
    capture = Capture(written(tmp_path, b"".join(blocks)[:-7]))
    assert [tuple(packet) for packet in capture.packets()] == packets[:-1]
    assert capture.cut_short


def test_another_version_is_not_read_as_if_it_were_known(tmp_path):
    blocks, _interfaces, _packets = sample()
    data = bytearray(b"".join(blocks))
    data[12:14] = b"\2\0"
    said = read_all(written(tmp_path, data))
    assert "is pcapng of version 2; only version 1 is known" in said


def read_all(path):
    """Packets read, or the error's one line."""
    said = ""
    try:
        return len(list(Capture(path).packets()))
    except ExportError as error:
        said = str(error)
    assert str(path) in said
    assert "\n" not in said
    return said


@settings(deadline=None, max_examples=80)
@given(st.data())
def test_any_bytes_give_packets_or_one_line(tmp_path_factory, data):
    blocks, _interfaces, _packets = sample()
    mixed = bytearray(b"".join(data.draw(st.permutations(blocks))))
    if data.draw(st.booleans()):
        mixed = bytearray(blocks[0] + mixed)
    for _ in range(data.draw(st.integers(0, 4))):
        mixed[data.draw(st.integers(0, len(mixed) - 1))] = data.draw(st.integers(0, 255))
    cut = data.draw(st.integers(0, len(mixed)))
    path = tmp_path_factory.getbasetemp() / "any.pcapng"
    for content in (mixed, mixed[:cut], random.Random(cut).randbytes(cut)):
        path.write_bytes(content)
        read_all(path)


@pytest.mark.parametrize("content", [b"", b"x", b"\xd4\xc3\xb2\xa1" + bytes(40), bytes(4000)])
def test_what_is_no_capture_is_told(content, tmp_path):
    path = written(tmp_path, content)
    assert "is no pcapng capture" in str(read_all(path))


def test_a_file_that_is_not_there_is_told(tmp_path):
    assert "No such file" in read_all(tmp_path / "away.pcapng")


def test_big_endian_captures_with_microseconds_are_read(tmp_path):
    import struct

    def block(kind, body):
        total = struct.pack(">I", 12 + len(body))
        return struct.pack(">I", kind) + total + body + total

    head = block(pcapng.SECTION, struct.pack(">IHHq", pcapng.MAGIC, 1, 0, -1))
    about = block(pcapng.INTERFACE, struct.pack(">HHI", 148, 0, 0))
    body = struct.pack(">IIIII", 0, 0, 5_000_001, 3, 3) + b"abc\0"
    path = written(tmp_path, head + about + block(pcapng.PACKET, body))
    [packet] = Capture(path).packets()
    assert (packet.time_ns, packet.data, packet.flags) == (5_000_001_000, b"abc", 0)


@pytest.mark.parametrize(("code", "ticks", "time_ns"), [
    (6, 3_000_005, 3_000_005_000), (9, 7, 7), (3, 7, 7_000_000), (0x80, 7, 7_000_000_000),
    (0x81, 7, 3_500_000_000), (0x8A, 1536, 1_500_000_000),
])  # fmt: skip
def test_ticks_are_powers_of_ten_or_of_two(tmp_path, code, ticks, time_ns):
    import struct

    def block(kind, body):
        total = struct.pack("<I", 12 + len(body))
        return struct.pack("<I", kind) + total + body + total

    resolution = struct.pack("<HHBxxxHH", pcapng.RESOLUTION, 1, code, 0, 0)
    path = written(
        tmp_path,
        block(pcapng.SECTION, struct.pack("<IHHq", pcapng.MAGIC, 1, 0, -1))
        + block(pcapng.INTERFACE, struct.pack("<HHI", 148, 0, 0) + resolution)
        + block(pcapng.PACKET, struct.pack("<IIIII", 0, 0, ticks, 0, 0)),
    )
    assert [packet.time_ns for packet in Capture(path).packets()] == [time_ns]


def fail_in_the_middle(file):
    file.write(b"half")
    raise KeyError


def test_a_file_is_there_whole_or_not_at_all(tmp_path):
    path = tmp_path / "some.txt"
    path.write_text("before")
    with pytest.raises(KeyError), whole(path) as file:
        fail_in_the_middle(file)
    assert path.read_text() == "before"
    with whole(path) as file:
        file.write(b"after")
    assert path.read_text() == "after"
    assert list(tmp_path.iterdir()) == [path]
    with pytest.raises(ExportError, match="choose another place"), whole(tmp_path / "no/such"):
        pass


def test_descriptions_say_what_they_said():
    text = links.describe("cell", 7, 1, ("p0 r1 c2 E", "p0 r1 c3 W"))
    assert links.place_of(text) == ("cell", 7, 1, "p0 r1 c2 E", "p0 r1 c3 W")
    assert links.place_of(links.describe("node", 3)) == ("node", 3, -1, "", "")
    assert links.place_of("eth0") == ("", -1, -1, "", "")


@pytest.mark.parametrize(("table", "padding"), [("udp.port", 0), ("ip.proto", 0), ("a", 3),
                                                ("abcde", 3), ("ab", 2), ("abc", 1)])  # fmt: skip
def test_who_reads_a_packet_stands_in_front_of_it_by_wiresharks_tags(table, padding):
    """epan/exported_pdu.h: 14 the name of a table, 32 a number in it, 0 the end; big-endian."""
    name = table.encode() + bytes(padding)
    assert len(name) % 4 == 0
    assert pcapng.for_dissector(table, 6696) == (
        bytes([0, 14, 0, len(name)]) + name + bytes([0, 32, 0, 4, 0, 0, 0x1A, 0x28]) + bytes(4)
    )
