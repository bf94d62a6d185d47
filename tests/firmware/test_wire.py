"""Coder, lines and driver in C: against Python's, with bytes at will, and how large they are."""

import ctypes
import random
import shutil
from pathlib import Path

import pytest

from boards.errors import BoardFailed
from boards.firmware import measure
from boards.firmware.native import WARNINGS, run
from innervate.dialect import plain
from innervate.firmware import library, tools
from innervate.firmware.errors import FirmwareError
from innervate.firmware.packed import Packed
from innervate.networks.mesh import frames as mesh_frames
from innervate.networks.mesh import payloads as mesh_payloads
from innervate.networks.mesh.protocol import fields as mesh_fields
from innervate.networks.mesh.protocol.constants import ACK
from innervate.networks.radio import frames as radio_frames
from innervate.networks.radio.live.stack import Frame as RadioFrame
from innervate.networks.radio.protocol import fields as radio_fields
from innervate.networks.radio.protocol.constants import CRR, DATA, OPEN
from innervate.networks.skin import frames as skin_frames
from innervate.networks.skin.live.items import Frame
from innervate.wire import cobs, crc
from tests.firmware.made import files_of

HERE = Path(__file__).parent
MeshFrame = plain.make("Frame", mesh_fields.FRAME)
SEALED = ("sealed-skin", "sealed-mesh")
SANITIZERS = ("-fsanitize=address,undefined", "-fno-sanitize-recover=all", "-g")


def needs(*names):
    for name in names:
        if shutil.which(name) is None:
            pytest.skip(f"{name} is not installed")


class Folders(dict):
    """Where the libraries are written that are asked for."""

    def __init__(self, new):
        self.new = new

    def __missing__(self, role):
        self[role] = self.new(role)
        library.write(files_of(role.removeprefix("sealed-"), role in SEALED), self[role])
        return self[role]


@pytest.fixture(scope="module")
def folders(tmp_path_factory):
    return Folders(tmp_path_factory.mktemp)


@pytest.fixture(scope="module")
def folder(folders):
    return folders["skin"]


@pytest.fixture(scope="module")
def native(folder):
    needs("gcc")
    sources = [folder / name for name in ("skin.c", "skin_wire.c", "innervate_wire.c")]
    run(["gcc", "-std=c99", "-O1", "-fPIC", "-shared", *sources, "-o", folder / "wire.so"])
    return ctypes.CDLL(str(folder / "wire.so"))


def drawn(draw, module, frame):
    """A frame of any kind, its numbers at the edges of their bits more often than chance has it."""
    frame.kind = draw.choice(list(module.FIELDS))
    for name, many, bits, signed in module.FIELDS[frame.kind]:
        low = -(1 << (bits - 1)) if signed else 0
        values = [draw.choice((low, low + (1 << bits) - 1, draw.randrange(low, low + (1 << bits))))
                  for _ in range(max(1, many))]  # fmt: skip
        if name:
            setattr(frame, name, values if many else values[0])
    return frame


def drawn_mesh(draw, frame):
    """One that may be sound: bytes of the payload are small, its length is a likely one."""
    frame.kind = draw.choice([*mesh_payloads.FIELDS, ACK])
    for name, _many, bits, signed in (
        mesh_frames.HOP_ACK if frame.kind == ACK else mesh_frames.COMMON
    ):
        setattr(frame, name, draw.randrange(1 << bits) - (signed << (bits - 1)))
    frame.flags = draw.choice((0, 8, 16, 24, 255))
    frame.path_len = draw.choice((0, 1, 3, 24))
    frame.path = list(draw.randbytes(24))
    size = mesh_payloads.SIZES.get(frame.kind, draw.randrange(40))
    frame.length = draw.choice((size, size, 3 * draw.randrange(5), draw.randrange(115)))
    frame.body = draw.choices((0, 0, 1, 2, 3, draw.randrange(256)), k=114)
    return frame


def values(frame, fields):
    """What of a frame is used, by name."""
    found = {name: getattr(frame, name) for name in fields if name not in ("path", "body")}
    for name, count in (("path", "path_len"), ("body", "length")):
        if name in fields:
            found[name] = list(getattr(frame, name)[: getattr(frame, count)])
    return found


def test_c_codes_frames_byte_by_byte_as_python_does(native):
    draw, packed = random.Random(1), Packed(files_of("skin").library.records["frame"])
    for _ in range(3000):
        frame = drawn(draw, skin_frames, Frame())
        data, other = ctypes.create_string_buffer(skin_frames.SIZE_MAX), Frame()
        size = native.skin_encode(packed.of(frame), data)
        assert data.raw[:size] == skin_frames.encode(frame)
        read = ctypes.create_string_buffer(packed.size)
        assert native.skin_decode(data, size, read) == skin_frames.decode(data.raw[:size], other)
        packed.put(read.raw, frame)
        for name in ("kind", *(field[0] for field in skin_frames.FIELDS[frame.kind] if field[0])):
            assert getattr(frame, name) == getattr(other, name), name


def shared(folder, role):
    needs("gcc")
    made = folder / "wire.so"
    sources = [folder / name for name in (f"{role}_wire.c", "innervate_wire.c")]
    run(["gcc", "-std=c99", "-O1", "-fPIC", "-shared", "-fsanitize=undefined,bounds",
         "-fno-sanitize-recover=all", *sources, "-o", made])  # fmt: skip
    return ctypes.CDLL(str(made)), Packed(files_of(role).library.records["frame"])


def test_c_codes_packets_and_acks_of_a_mesh_as_python_does(folders):
    native, packed = shared(folders["mesh"], "mesh")
    draw, reasons, fields = random.Random(5), set(), [field[0] for field in mesh_fields.FRAME]
    for _ in range(1500):
        frame, data = drawn_mesh(draw, MeshFrame()), ctypes.create_string_buffer(200)
        try:
            wanted = mesh_frames.encode(frame)
        except ValueError:
            wanted = b""
        size = native.mesh_encode(packed.of(frame), data)
        assert data.raw[:size] == wanted
        if draw.random() < 0.3 and wanted:
            wanted = bytearray(wanted)
            wanted[draw.randrange(len(wanted))] ^= 1 << draw.randrange(8)
            if draw.random() < 0.8:
                crc.seal(wanted)
        why, read, other = mesh_frames.decode(wanted, MeshFrame()), MeshFrame(), MeshFrame()
        place = ctypes.create_string_buffer(packed.size)
        assert native.mesh_decode(bytes(wanted), len(wanted), place) == why
        reasons.add(why)
        if why == 0:
            mesh_frames.decode(wanted, other)
            packed.put(place.raw, read)
            assert values(read, fields) == values(other, fields)
    assert reasons == set(range(len(mesh_frames.REASONS)))


def test_c_codes_frames_of_a_radio_as_python_does(folders):
    native, packed = shared(folders["radio"], "radio")
    draw, reasons, most = random.Random(6), set(), 18
    for _ in range(3000):
        frame, data = RadioFrame(), ctypes.create_string_buffer(64)
        drawn(draw, radio_frames, frame)
        if draw.random() < 0.1:
            frame.kind, frame.slots = CRR, 1
        payload = draw.randbytes(draw.randrange(most + 1))
        payload = payload if frame.kind in (DATA, OPEN) else b""
        size = native.radio_encode(packed.of(frame), payload, len(payload), data)
        wanted = radio_frames.encode(frame, payload)
        assert data.raw[:size] == wanted
        if draw.random() < 0.4:
            less = draw.choice((0, 0, 3))
            wanted = bytearray(wanted[: max(1, len(wanted) - less)])
            wanted[draw.randrange(len(wanted))] ^= 1 << draw.randrange(8)
            if draw.random() < 0.7 and len(wanted) > 2:
                crc.seal(wanted)
        place, read, other = ctypes.create_string_buffer(packed.size), RadioFrame(), RadioFrame()
        why = radio_frames.decode(wanted, other)
        assert native.radio_decode(bytes(wanted), len(wanted), place) == why
        reasons.add(why)
        if why == 0:
            packed.put(place.raw, read)
            names = [field[0] for field in radio_fields.FRAME]
            assert values(read, names) == values(other, names)
    assert reasons == set(range(len(radio_frames.REASONS)))


def test_c_refuses_bytes_for_the_same_reasons(native):
    draw, read = random.Random(2), ctypes.create_string_buffer(64)
    seen = set()
    for _ in range(6000):
        data = bytearray(draw.randbytes(draw.choice((1, 2, 8, 9, 20, 21, 30))))
        if len(data) > 2 and draw.random() < 0.6:
            crc.seal(data)
        if draw.random() < 0.2:
            data = bytearray(skin_frames.encode(drawn(draw, skin_frames, Frame())))
            data[draw.randrange(len(data))] ^= 1 << draw.randrange(8)
        why = skin_frames.decode(data, Frame())
        assert native.skin_decode(bytes(data), len(data), read) == why
        seen.add(why)
    assert seen == {0, 1, 2, 3}


def test_lines_are_stuffed_as_pythons_are(native):
    draw = random.Random(3)
    for _ in range(2000):
        data = bytes(draw.choice((0, 0, 1, 255, draw.randrange(256)))
                     for _ in range(draw.randrange(254)))  # fmt: skip
        line = ctypes.create_string_buffer(len(data) + 2)
        assert native.innervate_stuff(data, len(data), line) == len(data) + 2
        assert line.raw == cobs.encode(data)
        assert native.innervate_unstuff(line, len(data) + 1) == len(data)
        assert line.raw[: len(data)] == data
    for bad in (b"\x05\x01", b"\x02"):
        assert native.innervate_unstuff(ctypes.create_string_buffer(bad), len(bad)) == -1


def fuzzed(folder, pieces, role="skin", *more):
    (folder / "fuzz").mkdir(exist_ok=True)
    name = role.removeprefix("sealed-")
    (folder / "fuzz/fuzz.c").write_text(library.renamed((HERE / "fuzz.c").read_text(), name))
    sources = [*sorted(folder.glob("*.c")), *folder.glob("crypto/*.c"), folder / "fuzz/fuzz.c"]
    run(["gcc", "-std=c99", *SANITIZERS, *ASKED[role], "-I", folder, *sources,
         "-o", folder / "fuzz/fuzz"])  # fmt: skip
    return [int(word) for word in run([folder / "fuzz/fuzz", str(pieces), *more]).split()]


ASKED = {"skin": ("-DSKIN", "-DKINDS=4"), "mesh": ("-DMESH", "-DKINDS=13"),
         "radio": ("-DAIR", "-DKINDS=4")}  # fmt: skip
ASKED |= {"sealed-skin": (*ASKED["skin"], "-DSEALED", "-DKIND=2"),
          "sealed-mesh": (*ASKED["mesh"], "-DSEALED", "-DKIND=1")}  # fmt: skip


@pytest.mark.parametrize(("role", "pieces"), [("skin", 30_000), ("mesh", 3000),
                                              ("radio", 10_000),
                                              ("sealed-skin", 3000)])  # fmt: skip
def test_bytes_at_will_do_no_harm(role, pieces, folders):
    needs("gcc")
    sent, delivered, dropped, _, opened, pretended, broken = fuzzed(folders[role], pieces, role)
    assert min(sent, delivered, dropped) > 40
    assert (opened > 40) == (role in SEALED)
    assert not pretended
    assert not broken


@pytest.mark.slow
@pytest.mark.parametrize("more", [("skin",), ("mesh",), ("mesh", "leads"), ("radio",),
                                  ("sealed-skin",), ("sealed-mesh",)])  # fmt: skip
def test_a_hundred_thousand_pieces_do_no_harm(more, folders):
    needs("gcc")
    sent, delivered, *_, pretended, broken = fuzzed(folders[more[0]], 100_000, *more)
    assert min(sent, delivered) > 100
    assert not pretended
    assert not broken


def test_a_driver_that_reads_too_far_is_found(folder, tmp_path):
    needs("gcc")
    for path in folder.glob("*.[ch]"):
        text = path.read_text()
        (tmp_path / path.name).write_text(text.replace("count > SKIN_PIECE_MAX + 1 ? -1 : ", ""))
        (tmp_path / path.name).write_text(
            text.replace("line->heard < SKIN_PIECE_MAX + 2", "line->heard < 255")
        )
    with pytest.raises(BoardFailed, match=r"out of bounds|overflow"):
        fuzzed(tmp_path, 20_000)


@pytest.mark.parametrize("role", ["skin", "mesh", "radio", SEALED[0],
                                  pytest.param(SEALED[1], marks=pytest.mark.slow)])  # fmt: skip
def test_compilers_and_cppcheck_have_nothing_to_say(role, folders):
    needs("gcc", "clang", "cppcheck", "arm-none-eabi-gcc")
    folder = folders[role]
    beside = [*sorted(folder.glob("*.c")), *sorted(folder.glob("crypto/*.c"))]
    if role in SEALED:  # the protocol is that which was looked at
        beside.remove(folder / f"{role.removeprefix('sealed-')}.c")
    for compiler in (["gcc", "-std=c99", "-pedantic"], ["clang", "-std=c99", "-pedantic"],
                     ["g++", "-x", "c++"]):  # fmt: skip
        run([*compiler, *WARNINGS, "-fsyntax-only", "-I", folder, *beside])
    board = sorted((folder / "bare").glob("*.c"))
    run(["arm-none-eabi-gcc", *tools.CORTEX_M3, "-std=gnu99", "-ffreestanding", *WARNINGS,
         "-DKEY=1,2,3", "-fsyntax-only", "-I", folder, *board])  # fmt: skip
    run(["cppcheck", "-q", "--enable=warning,performance,portability", "--error-exitcode=1",
         "-DKEY=1", "-I", folder, *beside, *board])  # fmt: skip


# A mesh's node that leads is the larger one, and held to the same bounds.
@pytest.mark.parametrize(
    "image", ["skin", "radio", pytest.param("mesh", marks=pytest.mark.slow), *measure.OF_MESH]
)
def test_a_node_is_as_small_as_it_has_to_be(image, folders, tmp_path):
    """With coder, driver, port layer, vectors, and the deepest stack with an interrupt on it."""
    needs("arm-none-eabi-gcc", "arm-none-eabi-size")
    role = image.removeprefix(measure.LEADING)
    flash, ram, stack = measure.whole(image, folders[role], tmp_path)
    flash_kb, ram_kb = {"skin": (6, 1), "radio": (16, 2), "mesh": (32, 12)}[role]
    assert flash <= flash_kb * 1024
    assert ram + stack <= ram_kb * 1024


def test_a_compiler_that_is_missing_or_finds_fault_is_one_line(folder, tmp_path, monkeypatch):
    needs("arm-none-eabi-gcc")
    shutil.copytree(folder, tmp_path / "bad")
    (tmp_path / "bad/skin.c").write_text("int x = ;\n")
    with pytest.raises(FirmwareError, match=r"^arm-none-eabi-gcc: .*error: expected expression"):
        tools.image(tmp_path / "bad", "skin", tmp_path)
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(FirmwareError, match="apt install gcc-arm-none-eabi"):
        tools.image(folder, "skin", tmp_path)
