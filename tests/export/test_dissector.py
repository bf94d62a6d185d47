"""Every field of every type of frame comes out of tshark as it went into the record."""

import random

import pytest

from innervate.dialect import plain
from innervate.export import dissector, pcapng
from innervate.network import networks
from innervate.networks.mesh import frames as mesh
from innervate.networks.mesh import payloads as mesh_payloads
from innervate.networks.mesh.protocol import constants as mesh_const
from innervate.networks.mesh.protocol import fields as mesh_fields
from innervate.networks.radio import frames as radio
from innervate.networks.radio.protocol import constants as radio_const
from innervate.networks.radio.protocol import fields as radio_fields
from innervate.networks.skin import frames as skin
from innervate.networks.skin.protocol import fields as skin_fields
from innervate.wire import crc, seal
from innervate.wire.bits import put
from innervate.wire.frames import Codec
from innervate.wire.layout import REST, SPARE
from tests.export.tshark_runs import fields_of, runner, tshark

__all__ = ["tshark"]
EACH = 6  # frames of every type
DRAW = random.Random(7)


def capture_of(path, kind, frames):
    blocks = [pcapng.section(), pcapng.interface(networks()[kind].link_type, kind)]
    blocks += [pcapng.packet(0, 1000 * i, frame, 0) for i, frame in enumerate(frames)]
    path.write_bytes(b"".join(blocks))
    return path


def number(bits, signed):
    """Any number, often the least or the greatest."""
    low = -(1 << (bits - 1)) if signed else 0
    high = low + (1 << bits) - 1
    return DRAW.choice([low, high, DRAW.randint(low, high)])


def set_all(record, fields, prefix):
    """Give a record values; what tshark should say of them."""
    expected = {}
    for name, many, bits, signed in fields:
        if name != SPARE:
            values = [number(bits, signed) for _ in range(max(1, many))]
            setattr(record, name, values if many else values[0])
            expected[f"{prefix}.{name}"] = [str(value) for value in values]
    return expected


class Payload:
    """Random bits of a layout, and what tshark should say of them."""

    def __init__(self, fields, prefix):
        self.bits, self.expected = [], {}
        self.add(fields, prefix)
        self.data = bytearray((sum(b for b, _ in self.bits) + 7) // 8)
        at = 0
        for bits, value in self.bits:
            put(self.data, at, bits, value)
            at += bits

    def add(self, fields, prefix):
        counts = {many: DRAW.randint(0, 3) for _n, many, _b, _s in fields if isinstance(many, str)}
        for name, many, bits, signed in fields:
            times = counts[many] if isinstance(many, str) else max(1, many)
            if many == REST:
                times = DRAW.randint(1, 3)
            for _ in range(times):
                if isinstance(bits, tuple):
                    self.add(bits, f"{prefix}.{name}")
                    continue
                value = counts.get(name, number(bits, signed))
                self.bits.append((bits, value))
                self.expected.setdefault(f"{prefix}.{name}", []).append(str(value))


def names_in(fields, prefix):
    for name, _many, bits, _signed in fields:
        if isinstance(bits, tuple):
            yield from names_in(bits, f"{prefix}.{name}")
        elif name != SPARE:
            yield f"{prefix}.{name}"


def all_names(kind):
    layouts = {"skin": skin, "mesh": mesh_payloads, "radio": radio}[kind].LAYOUTS
    found = [f"innervate.{kind}.{name}" for name in ("kind", "bad_crc", "malformed")]
    if kind == "mesh":
        found += names_in(mesh.COMMON, "innervate.mesh")
        found += names_in(mesh.HOP_ACK, "innervate.mesh.ack")
        found += names_in(mesh_payloads.PIECE, "innervate.mesh.piece")
        found += [f"innervate.mesh.{name}" for name in ("path", "source_route", "failed")]
    for _kind, name, fields in layouts:
        found += names_in(fields, f"innervate.{kind}.{dissector.abbreviation(name)}")
    return found


def skin_frames():
    for kind, name, fields in skin.LAYOUTS * EACH:
        record = plain.make("Frame", skin_fields.FRAME)()
        expected = set_all(record, fields, f"innervate.skin.{name}")
        record.kind = kind
        yield skin.encode(record), expected | {"innervate.skin.kind": [str(kind)]}


def radio_frames():
    for kind, name, fields in radio.LAYOUTS * EACH:
        record = plain.make("Frame", radio_fields.FRAME)()
        expected = set_all(record, fields, f"innervate.radio.{name}")
        record.kind = kind
        data = b"packets" if kind == radio_const.DATA else b""
        yield radio.encode(record, data), expected | {"innervate.radio.kind": [str(kind)]}
    yield bytes((radio.CRR_BYTE,)), {}


def mesh_record(kind, flags, path, body):
    record = plain.make("Frame", mesh_fields.FRAME)()
    expected = set_all(record, mesh.COMMON, "innervate.mesh")
    record.kind, record.flags, record.path_len, record.length = kind, flags, len(path), len(body)
    record.path[: len(path)], record.body[: len(body)] = path, list(body)
    expected |= {"innervate.mesh.flags": [str(flags)], "innervate.mesh.kind": [str(kind)]}
    expected["innervate.mesh.path_len"] = [str(len(path))]
    if path:
        expected["innervate.mesh.path"] = [str(node) for node in path]
    return record, expected


def mesh_piece():
    """Data that is a piece of a longer message: its first number is 16384 ahead of its own."""
    payload = Payload(mesh_payloads.PIECE, "innervate.mesh.piece")
    body, expected = payload.data, payload.expected
    record, more = mesh_record(mesh_const.DATA, mesh_const.ORDERED, [7], body)
    record.dest, record.seq = 3, 65_000
    body[:2] = record.body[:2] = (65_000 + 16_384 - 65_536).to_bytes(2, "big")
    more |= {"innervate.mesh.dest": ["3"], "innervate.mesh.seq": ["65000"]}
    return mesh.encode(record), more | expected | {"innervate.mesh.piece.mark": ["15848"]}


def mesh_frames():
    around = (0, mesh_const.SOURCE_ROUTE, mesh_const.DETOURED)
    for i, (kind, name, fields) in enumerate(mesh_payloads.LAYOUTS * EACH):
        payload = Payload(fields, f"innervate.mesh.{dissector.abbreviation(name)}")
        flags, body, more = around[i // len(mesh_payloads.LAYOUTS) % 3], bytes(payload.data), {}
        if flags == mesh_const.SOURCE_ROUTE:
            body, more = b"\x02\x07\xc9" + body, {"innervate.mesh.source_route": ["7", "201"]}
        elif flags and kind in mesh_payloads.SIZES:
            body, more = body + b"\x05\x06\x02", {"innervate.mesh.failed": ["5", "6"]}
        else:
            flags = 0
        path = [DRAW.randrange(254) for _ in range(DRAW.randint(0, 9))]
        record, expected = mesh_record(kind, flags, path, body)
        yield mesh.encode(record), expected | payload.expected | more
    yield mesh_piece()
    record = plain.make("Frame", mesh_fields.FRAME)()
    expected = set_all(record, mesh.HOP_ACK, "innervate.mesh.ack")
    record.kind = mesh_const.ACK
    yield mesh.encode(record), expected | {"innervate.mesh.kind": [str(mesh_const.ACK)]}


FRAMES = {"skin": skin_frames, "mesh": mesh_frames, "radio": radio_frames}


@pytest.mark.parametrize("kind", FRAMES)
def test_every_field_of_every_type_is_decoded(kind, tmp_path, tshark):
    made = list(FRAMES[kind]())
    capture = capture_of(tmp_path / "all.pcapng", kind, [data for data, _ in made])
    names = all_names(kind)
    found = fields_of(tshark, capture, names)
    assert len(found) == len(made)
    for (data, expected), fields in zip(made, found, strict=True):
        assert fields == expected, data.hex()
    decoded = {name for _, expected in made for name in expected}
    assert set(names) - decoded == {f"innervate.{kind}.{what}" for what in ("bad_crc", "malformed")}


@pytest.mark.parametrize("kind", FRAMES)
def test_every_type_is_found_by_its_name(kind, tmp_path, tshark):
    """The filters that the documents name: innervate.mesh.alarm and its like."""
    made = list(FRAMES[kind]())
    capture = capture_of(tmp_path / "all.pcapng", kind, [data for data, _ in made])
    layouts = {"skin": skin, "mesh": mesh_payloads, "radio": radio}[kind].LAYOUTS
    known = {str(number): dissector.abbreviation(name) for number, name, _fields in layouts}
    known |= {str(mesh_const.ACK): "ack"} if kind == "mesh" else {}
    known = {number: f"innervate.{kind}.{name}" for number, name in known.items()}
    of = f"innervate.{kind}.kind"
    found = fields_of(tshark, capture, [of, *known.values()], "-Y", " or ".join(known.values()))
    numbers = [fields[of][0] for _, fields in made if of in fields]
    assert found == [{of: [number], known[number]: ["1"]} for number in numbers if number in known]
    assert set(numbers) == set(known)


def columns(tshark, capture):
    """Source, destination and info of every packet, as the list of packets has them."""
    names = ("%s", "%d", "%i")
    chosen = ",".join(f'"{name}","{name}"' for name in names)
    lines = tshark(capture, "-o", f"gui.column.format:{chosen}", "-T", "tabs")
    # tshark draws an arrow between source and destination.
    return [tuple(one for part in line.split("\t") if (one := part.strip()) != "\u2192")
            for line in lines]  # fmt: skip


@pytest.mark.parametrize(("kind", "said", "all_"), [
    ("rpl", {"kind": 3, "src": 2, "to": 5}, {"kind": 1, "src": 2, "to": 65535}),
    ("flooding", {"kind": 1, "origin": 2, "dest": 5}, {"kind": 2, "origin": 2, "dest": 255}),
])  # fmt: skip
def test_who_receives_a_frame_sees_from_and_for_whom_it_is(kind, said, all_, tmp_path, tshark):
    network, frames = networks()[kind], []
    for values in (said, all_):
        frame = plain.make("Frame", network.fields.FRAME)()
        for name, value in values.items():
            setattr(frame, name, value)
        frames.append(Codec(network.frames.LAYOUTS, network.frames.KIND_BITS).encode(frame))
    blocks = [pcapng.section(), pcapng.interface(network.link_type, "node 9", "node 9")]
    blocks += [pcapng.packet(0, at, data, pcapng.INBOUND) for at, data in enumerate(frames)]
    path = tmp_path / "air.pcapng"
    path.write_bytes(b"".join(blocks))
    to_one, to_all = columns(tshark, path)
    assert (to_one[:2], to_all[:2]) == (("node 2", "node 5"), ("node 2", "all"))


def test_what_a_frame_does_not_say_of_its_ends_its_interface_does(tmp_path, monkeypatch):
    """As of a kind whose layout has no sender or no recipient, where others have both."""
    network, frames = networks()["flooding"], []
    known = (*network.frames.LAYOUTS, (3, "to", (("dest", 0, 8, 0),)), (4, "no", ()))
    monkeypatch.setattr(network.frames, "LAYOUTS", known)
    for kind in (3, 4):
        frame = plain.make("Frame", network.fields.FRAME)()
        frame.kind, frame.dest = kind, 5
        frames.append(Codec(known, network.frames.KIND_BITS).encode(frame))
    blocks = [pcapng.section(), pcapng.interface(network.link_type, "node 2")]
    blocks += [pcapng.packet(0, 0, data, way) for data in frames
               for way in (pcapng.OUTBOUND, pcapng.INBOUND)]  # fmt: skip
    path = tmp_path / "air.pcapng"
    path.write_bytes(b"".join(blocks))
    assert [said[:2] for said in columns(runner(tmp_path / "home"), path)] == [
        ("node 2", "node 5"), ("", "node 5"), ("node 2", ""), ("", "node 2"),
    ]  # fmt: skip


def test_the_list_of_packets_says_who_sends_what_to_whom(tmp_path, tshark):
    beacon = plain.make("Frame", skin_fields.FRAME)()
    beacon.kind, beacon.dist, beacon.sq = skin.BEACON, 3, 12
    cable = pcapng.interface(networks()["skin"].link_type, "c4 E", "cell 4 port 1; c4 E to c5 W")
    out, into = pcapng.OUTBOUND, pcapng.INBOUND
    blocks = [pcapng.section(), cable]
    blocks += [pcapng.packet(0, at, skin.encode(beacon), way) for at, way in enumerate((out, into))]
    path = tmp_path / "skin.pcapng"
    path.write_bytes(b"".join(blocks))
    sent, came = columns(tshark, path)
    assert sent == ("c4 E", "c5 W", "beacon: dist 3, sq 12, load 0, size 0, parent 0")
    assert came == ("c5 W", "c4 E", sent[2])
    report = plain.make("Frame", radio_fields.FRAME)()
    report.kind, report.window = radio_const.REPORT, 4
    data = plain.make("Frame", radio_fields.FRAME)()
    data.kind, data.source = radio_const.DATA, 7
    blocks = [
        pcapng.section(),
        pcapng.interface(networks()["radio"].link_type, "station 2", "station 2"),
    ]
    blocks += [pcapng.packet(0, 0, radio.encode(report), out)]
    blocks += [pcapng.packet(0, 1, radio.encode(data), into)]
    path.write_bytes(b"".join(blocks))
    sent, came = columns(tshark, path)
    assert sent[:2] == ("station 2", "all")
    assert "window 4" in sent[2]
    assert came[:2] == ("station 7", "all")
    alarm, _ = mesh_record(mesh_const.ALARM, 0, [5], bytes([12] + [0] * 17))
    alarm.link_src, alarm.link_dst, alarm.origin, alarm.dest, alarm.seq = 3, 255, 5, 254, 77
    capture = capture_of(tmp_path / "mesh.pcapng", "mesh", [mesh.encode(alarm)])
    ((source, to, info),) = columns(tshark, capture)
    assert (source, to) == ("node 3", "all")
    assert info.startswith("alarm: robot 12, ")
    assert info.endswith("(5 > monitor, seq 77)")


@pytest.mark.parametrize("kind", FRAMES)
def test_damage_is_flagged_as_the_decoders_find_it(kind, tmp_path, tshark):
    wire = {"skin": skin, "mesh": mesh, "radio": radio}[kind]
    fields = {"skin": skin_fields, "mesh": mesh_fields, "radio": radio_fields}[kind].FRAME
    made = []
    for data, _expected in FRAMES[kind]():
        flipped = bytearray(data)
        flipped[DRAW.randrange(len(data))] ^= 1 << DRAW.randrange(8)
        body = data[: DRAW.randrange(len(data))]
        made += [bytes(flipped), body, data + b"\1", DRAW.randbytes(DRAW.randint(1, 60))]
        # A right CRC behind what is no frame, or one of an unknown type.
        made.append(crc.seal(bytearray(body + b"\0\0")))
        made.append(crc.seal(bytearray([DRAW.randrange(256), *data[1:], 0, 0])[: len(data)]))
    made = [data for data in made if not seal.is_sealed(data)]
    capture = capture_of(tmp_path / "damaged.pcapng", kind, made)
    bad_crc, malformed = f"innervate.{kind}.bad_crc", f"innervate.{kind}.malformed"
    found = fields_of(tshark, capture, ["frame.number", bad_crc, malformed])
    frame = plain.make("Frame", fields)()
    reasons = [wire.REASONS[wire.decode(data, frame)] for data in made]
    assert {"crc", "length", "kind"} <= set(reasons)
    for data, reason, said in zip(made, reasons, found, strict=True):
        flags = [name for name in (bad_crc, malformed) if name in said]
        assert bool(flags) == (reason != "ok"), (data.hex(), reason, said)
        if reason == "crc":
            assert bad_crc in said, data.hex()


def test_a_sealed_frame_is_no_damage(tmp_path, tshark):
    data = seal.header(seal.FRAME, 513, 77) + bytes(40)
    capture = capture_of(tmp_path / "sealed.pcapng", "mesh", [data])
    names = ["innervate.mesh.sealed." + name for name in ("kind", "index", "counter")]
    found = fields_of(tshark, capture, [*names, "innervate.mesh.malformed"])
    assert found == [dict(zip(names, (["0xc3"], ["0x00000201"], ["77"]), strict=True))]
