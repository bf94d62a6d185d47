"""Sealing in C, called from Python: what a maker gives it, and the far end of a line."""

import ctypes
import random
import shutil

import pytest
from cryptography.exceptions import InvalidTag
from cryptography.hazmat.primitives.ciphers.aead import AESGCM

from boards.firmware.native import SANITIZED, WARNINGS, run
from innervate.firmware import library

I32, BYTES = ctypes.c_int32, ctypes.POINTER(ctypes.c_uint8)
ROOM = 4096  # more bytes than any of the structs has
SAY_MAX, HEAD = 87, 9


class Lock(ctypes.Structure):
    _fields_ = (("key", BYTES), ("nonce", ctypes.c_uint8 * 12), ("head", BYTES),
                ("head_count", I32))  # fmt: skip


CLOSE = ctypes.CFUNCTYPE(None, ctypes.POINTER(Lock), BYTES, I32)
OPEN = ctypes.CFUNCTYPE(I32, ctypes.POINTER(Lock), BYTES, I32)
RANDOM = ctypes.CFUNCTYPE(None, BYTES, I32)
ALGORITHMS = ("close", "open", "x25519", "sha256", "blake2s")


class Crypto(ctypes.Structure):
    _fields_ = (("is_aes", ctypes.c_uint8), *((name, ctypes.c_void_p) for name in ALGORITHMS),
                ("random", ctypes.c_void_p))  # fmt: skip


class Keys(ctypes.Structure):
    _fields_ = (("crypto", ctypes.POINTER(Crypto)), ("number", ctypes.c_uint8),
                ("key", ctypes.c_uint8 * 32))  # fmt: skip


class Session(ctypes.Structure):
    _fields_ = (("crypto", ctypes.POINTER(Crypto)), ("key_out", ctypes.c_uint8 * 32),
                ("key_in", ctypes.c_uint8 * 32),
                *((name, ctypes.c_uint32) for name in
                  ("own", "far", "counter", "highest", "window")))  # fmt: skip


def pointer(function):
    return ctypes.cast(function, ctypes.c_void_p)


def built(folder):
    """All that seals, and the example of what it asks for, as a library of this machine."""
    if shutil.which("gcc") is None:
        pytest.skip("gcc is not installed")
    for name in (*library.SEAL, *library.EXAMPLE):
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text(library.shipped(name))
    made = folder / "seal.so"
    run(["gcc", "-std=c99", "-pedantic", "-O1", "-fPIC", "-shared", *WARNINGS, *SANITIZED,
         "-I", folder, *folder.glob("*.c"), *folder.glob("crypto/*.c"), "-o", made])  # fmt: skip
    return ctypes.CDLL(str(made))


@CLOSE
def close_aes(lock, data, count):
    one = lock.contents
    made = AESGCM(bytes(one.key[:32])).encrypt(
        bytes(one.nonce), bytes(data[:count]), bytes(one.head[: one.head_count])
    )
    ctypes.memmove(data, made, len(made))


@OPEN
def open_aes(lock, data, count):
    one = lock.contents
    try:
        made = AESGCM(bytes(one.key[:32])).decrypt(
            bytes(one.nonce), bytes(data[: count + 16]), bytes(one.head[: one.head_count])
        )
    except InvalidTag:
        return 0
    ctypes.memmove(data, made, len(made))
    return 1


def drawn(seed, taken=()):
    """What draws random bytes: first those that are given, then from a seed."""
    draw, first = random.Random(seed), list(taken)

    @RANDOM
    def draws(out, count):
        ctypes.memmove(out, first.pop(0) if first else draw.randbytes(count), count)

    return draws


def crypto_of(native, draws, is_aes=False):
    """A maker's algorithms: the example's, or with AES, which another library has."""
    found = Crypto(is_aes=is_aes, random=pointer(draws))
    for name in ALGORITHMS:
        setattr(found, name, pointer(getattr(native, f"innervate_example_{name}")))
    if is_aes:
        found.close, found.open = pointer(close_aes), pointer(open_aes)
    found.kept = draws  # as long as it is called
    return found


def keys_of(crypto, key, number=1):
    return Keys(ctypes.pointer(crypto), number, (ctypes.c_uint8 * 32)(*key))


class Far:
    """One end of a line in C: hears and says bytes, whatever becomes of them."""

    def __init__(self, native, number, key, seed, is_aes=False, network=1):
        self.native = native
        self.keys = keys_of(crypto_of(native, drawn(seed), is_aes), key)
        self.memory = ctypes.create_string_buffer(ROOM)
        self.got, self.said, self.refused = [], [], 0
        self.send = lambda data: None
        life = random.Random(seed + 1).randbytes(8)
        native.innervate_contact_begin(self.memory, ctypes.byref(self.keys), network, number, life)

    @property
    def is_up(self):
        return bool(self.native.innervate_contact_is_up(self.memory))

    def beat(self, now_us):
        out = ctypes.create_string_buffer(SAY_MAX)
        count = self.native.innervate_contact_beat(self.memory, now_us % 2**30, out)
        self._say(out.raw[:count])

    def hear(self, data):
        place, out = ctypes.create_string_buffer(data, len(data)), ctypes.create_string_buffer(87)
        said, who = I32(), I32()
        count = self.native.innervate_contact_take(
            self.memory, place, len(data), out, ctypes.byref(said), ctypes.byref(who)
        )
        self.refused += count < 0
        if count > 0:
            self.got.append((who.value, place.raw[HEAD : HEAD + count]))
        self._say(out.raw[: said.value])

    def frame(self, data):
        place = ctypes.create_string_buffer(bytes(HEAD) + data + bytes(16), len(data) + 25)
        count = self.native.innervate_contact_close(self.memory, place, len(data))
        self._say(place.raw[:count])

    def _say(self, data):
        if data:
            self.said.append(data)
            self.send(data)
