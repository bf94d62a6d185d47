"""Coder, lines and driver in C: against Python's, with bytes at will, and how large they are."""

import ctypes
import random
import shutil
from pathlib import Path

import pytest

from boards.errors import BoardFailed
from boards.firmware.native import WARNINGS, run
from innervate.firmware import library, tools
from innervate.firmware.errors import FirmwareError
from innervate.firmware.packed import Packed
from innervate.networks.skin import frames as skin_frames
from innervate.networks.skin.live.items import Frame
from innervate.wire import cobs, crc

HERE = Path(__file__).parent
SANITIZERS = ("-fsanitize=address,undefined", "-fno-sanitize-recover=all", "-g", "-O1")
M0 = (*tools.CORTEX_M0, "-DBOARD_UARTS=4", "-DBOARD_RING=16")


def needs(*names):
    for name in names:
        if shutil.which(name) is None:
            pytest.skip(f"{name} is not installed")


@pytest.fixture(scope="module")
def files():
    return library.made_of("skin", [])


@pytest.fixture(scope="module")
def folder(files, tmp_path_factory):
    made = tmp_path_factory.mktemp("skin")
    library.write(files, made)
    return made


@pytest.fixture(scope="module")
def native(folder):
    needs("gcc")
    sources = [folder / name for name in ("skin.c", "skin_wire.c", "innervate_wire.c")]
    run(["gcc", "-std=c99", "-O1", "-fPIC", "-shared", *sources, "-o", folder / "wire.so"])
    return ctypes.CDLL(str(folder / "wire.so"))


def drawn(draw):
    frame = Frame()
    frame.kind = draw.choice(list(skin_frames.FIELDS))
    for name, many, bits, signed in skin_frames.FIELDS[frame.kind]:
        low = -(1 << (bits - 1)) if signed else 0
        values = [draw.choice((low, low + (1 << bits) - 1, draw.randrange(low, low + (1 << bits))))
                  for _ in range(max(1, many))]  # fmt: skip
        if name:
            setattr(frame, name, values if many else values[0])
    return frame


def test_c_codes_frames_byte_by_byte_as_python_does(native, files):
    draw, packed = random.Random(1), Packed(files.library.records["frame"])
    for _ in range(3000):
        frame, data = drawn(draw), ctypes.create_string_buffer(skin_frames.SIZE_MAX)
        size = native.skin_encode(packed.of(frame), data)
        assert data.raw[:size] == skin_frames.encode(frame)
        read, other = ctypes.create_string_buffer(packed.size), Frame()
        assert native.skin_decode(data, size, read) == skin_frames.decode(data.raw[:size], other)
        packed.put(read.raw, frame)
        for name in ("kind", *(field[0] for field in skin_frames.FIELDS[frame.kind] if field[0])):
            assert getattr(frame, name) == getattr(other, name), name


def test_c_refuses_bytes_for_the_same_reasons(native):
    draw, read = random.Random(2), ctypes.create_string_buffer(64)
    seen = set()
    for _ in range(6000):
        data = bytearray(draw.randbytes(draw.choice((1, 2, 8, 9, 20, 21, 30))))
        if len(data) > 2 and draw.random() < 0.6:
            crc.seal(data)
        if draw.random() < 0.2:
            data = bytearray(skin_frames.encode(drawn(draw)))
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


def fuzzed(folder, pieces):
    sources = [*sorted(folder.glob("*.c")), HERE / "fuzz.c"]
    run(["gcc", "-std=c99", *SANITIZERS, "-I", folder, *sources, "-o", folder / "fuzz"])
    return [int(word) for word in run([folder / "fuzz", str(pieces)]).split()]


def test_bytes_at_will_do_no_harm(folder):
    needs("gcc")
    sent, delivered, dropped, _, broken = fuzzed(folder, 100_000)
    assert min(sent, delivered, dropped) > 100
    assert not broken


def test_a_driver_that_reads_too_far_is_found(folder, tmp_path):
    needs("gcc")
    for path in folder.glob("*.[ch]"):
        text = path.read_text()
        (tmp_path / path.name).write_text(text.replace("count > SKIN_SIZE_MAX + 1 ? -1 : ", ""))
        (tmp_path / path.name).write_text(
            text.replace("size > SKIN_SIZE_MAX) {", "size > 4 * SKIN_SIZE_MAX) {").replace(
                "line->heard < SKIN_SIZE_MAX + 2", "line->heard < 255"
            )
        )
    with pytest.raises(BoardFailed, match=r"out of bounds|overflow"):
        fuzzed(tmp_path, 20_000)


def test_compilers_and_cppcheck_have_nothing_to_say(folder):
    needs("gcc", "clang", "cppcheck", "arm-none-eabi-gcc")
    beside = sorted(folder.glob("*.c"))
    for compiler in (["gcc", "-std=c99", "-pedantic"], ["clang", "-std=c99", "-pedantic"],
                     ["g++", "-x", "c++"]):  # fmt: skip
        run([*compiler, *WARNINGS, "-fsyntax-only", "-I", folder, *beside])
    board = sorted((folder / "bare").glob("*.c"))
    run(["arm-none-eabi-gcc", *tools.CORTEX_M3, "-std=gnu99", "-ffreestanding", *WARNINGS,
         "-fsyntax-only", "-I", folder, *board])  # fmt: skip
    run(["cppcheck", "-q", "--enable=warning,performance,portability", "--error-exitcode=1",
         "-I", folder, *beside, *board])  # fmt: skip


def test_a_cell_is_as_small_as_it_has_to_be(folder, tmp_path):
    needs("arm-none-eabi-gcc", "arm-none-eabi-size")
    image = tools.image(folder, "skin", tmp_path, "small", M0)
    said = run(["arm-none-eabi-size", image]).splitlines()[1].split()
    text, data, bss = map(int, said[:3])
    assert text + data <= 6 * 1024
    assert data + bss <= 1024


def test_a_compiler_that_is_missing_or_finds_fault_is_one_line(folder, tmp_path, monkeypatch):
    needs("arm-none-eabi-gcc")
    shutil.copytree(folder, tmp_path / "bad")
    (tmp_path / "bad/skin.c").write_text("int x = ;\n")
    with pytest.raises(FirmwareError, match=r"^arm-none-eabi-gcc: .*error: expected expression"):
        tools.image(tmp_path / "bad", "skin", tmp_path)
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(FirmwareError, match="apt install gcc-arm-none-eabi"):
        tools.image(folder, "skin", tmp_path)
