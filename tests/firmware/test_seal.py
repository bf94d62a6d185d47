"""Sealed frames in C against a live node's session; the cipher is one that a maker has."""

import ctypes
import random
import shutil

import pytest
from cryptography.exceptions import InvalidTag
from cryptography.hazmat.primitives.ciphers.aead import ChaCha20Poly1305

from boards.firmware.native import SANITIZED, WARNINGS, run
from innervate.firmware import library
from innervate.live.session import Session
from innervate.wire import seal

BYTES = ctypes.POINTER(ctypes.c_uint8)
CLOSE = ctypes.CFUNCTYPE(None, ctypes.c_void_p, BYTES, BYTES, BYTES, ctypes.c_int32, BYTES)
OPEN = ctypes.CFUNCTYPE(ctypes.c_int32, ctypes.c_void_p, BYTES, BYTES, BYTES, ctypes.c_int32, BYTES)
KEYS = {1: bytes(range(32)), 2: bytes(range(32, 64))}


class Cipher(ctypes.Structure):
    _fields_ = (("close", CLOSE), ("open", OPEN))


class InC(ctypes.Structure):
    _fields_ = (
        ("cipher", ctypes.POINTER(Cipher)), ("key_out", ctypes.c_void_p),
        ("key_in", ctypes.c_void_p), ("own", ctypes.c_uint32), ("far", ctypes.c_uint32),
        ("counter", ctypes.c_uint32), ("highest", ctypes.c_uint32), ("window", ctypes.c_uint32),
    )  # fmt: skip


@CLOSE
def close(key, nonce, head, data, count, tag):
    made = ChaCha20Poly1305(KEYS[key]).encrypt(bytes(nonce[:12]), bytes(data[:count]),
                                               bytes(head[:9]))  # fmt: skip
    for i in range(count):
        data[i] = made[i]
    for i in range(16):
        tag[i] = made[count + i]


@OPEN
def opened(key, nonce, head, data, count, tag):
    try:
        made = ChaCha20Poly1305(KEYS[key]).decrypt(
            bytes(nonce[:12]), bytes(data[:count]) + bytes(tag[:16]), bytes(head[:9])
        )
    except InvalidTag:
        return 0
    for i in range(count):
        data[i] = made[i]
    return 1


@pytest.fixture
def native(tmp_path):
    if shutil.which("gcc") is None:
        pytest.skip("gcc is not installed")
    for name in library.SEAL:
        (tmp_path / name).write_text(library.shipped(name))
    made = tmp_path / "seal.so"
    run(["gcc", "-std=c99", "-pedantic", "-fPIC", "-shared", *WARNINGS, *SANITIZED,
         tmp_path / "innervate_seal.c", "-o", made])  # fmt: skip
    return ctypes.CDLL(str(made))


@pytest.fixture
def both(native):
    cipher = Cipher(close, opened)
    ours = InC(ctypes.pointer(cipher), 1, 2, own=77, far=0x89ABCDEF)
    theirs = Session(0x89ABCDEF, 77, (KEYS[2], KEYS[1]), None, 0, False)
    return native, ours, theirs


def sealed(native, ours, data):
    frame = ctypes.create_string_buffer(bytes(9) + data + bytes(16), len(data) + 25)
    size = native.innervate_close(ctypes.byref(ours), frame, len(data))
    return frame.raw[:size]


def read(native, ours, data):
    frame = ctypes.create_string_buffer(data, len(data))
    count = native.innervate_open(ctypes.byref(ours), frame, len(data))
    return None if count < 0 else frame.raw[9 : 9 + count]


def test_a_live_nodes_session_opens_what_c_seals(both):
    native, ours, theirs = both
    draw = random.Random(1)
    for counter in range(200):
        data = draw.randbytes(draw.randrange(40))
        made = sealed(native, ours, data)
        assert seal.fields(made) == (seal.FRAME, 0x89ABCDEF, counter)
        assert theirs.open(counter, made) == data


def test_c_opens_what_a_live_nodes_session_seals_once_and_in_any_order(both):
    native, ours, theirs = both
    frames = [(data, theirs.close(data)) for data in (bytes([i] * (i % 9)) for i in range(100))]
    window = seal.Window()
    for i in random.Random(2).choices(range(100), k=600):
        data, made = frames[i]
        fresh = window.is_new(i) and window.highest - i < 32
        assert read(native, ours, made) == (data if fresh else None)
        if fresh:
            window.take(i)


def test_what_is_not_genuine_is_refused_and_changes_nothing(both):
    native, ours, theirs = both
    made = theirs.close(b"a sample")
    for place in range(len(made)):
        wrong = bytearray(made)
        wrong[place] ^= 1
        assert read(native, ours, bytes(wrong)) is None
    assert read(native, ours, made[:24]) is None
    assert (ours.highest, ours.window) == (0, 0)
    assert read(native, ours, made) == b"a sample"
    ours.counter = seal.COUNTER_MAX - 1000
    assert sealed(native, ours, b"x") == b""
