"""Sealed frames in C against a live node's session, and what sealing asks of a maker."""

import ctypes
import hashlib
import random

import pytest
from cryptography.hazmat.primitives.asymmetric.x25519 import X25519PrivateKey, X25519PublicKey
from cryptography.hazmat.primitives.ciphers.aead import AESGCM, ChaCha20Poly1305

from innervate.live import noise
from innervate.live import session as sessions
from innervate.wire import seal
from tests.firmware import in_c

OUT, IN = bytes(range(32)), bytes(range(32, 64))
FRAME = seal.FRAME


def pair(native, is_aes=False):
    crypto = in_c.crypto_of(native, in_c.drawn(1), is_aes)
    key = ctypes.c_uint8 * 32
    ours = in_c.Session(ctypes.pointer(crypto), key(*OUT), key(*IN), 77, 0x89ABCDEF)
    return ours, sessions.Session(0x89ABCDEF, 77, (IN, OUT), None, False)


@pytest.fixture
def both(native):
    return native, *pair(native)


def sealed(native, ours, data):
    frame = ctypes.create_string_buffer(bytes(9) + data + bytes(16), len(data) + 25)
    size = native.innervate_close(ctypes.byref(ours), FRAME, frame, len(data))
    return frame.raw[:size]


def read(native, ours, data):
    frame = ctypes.create_string_buffer(data, len(data))
    count = native.innervate_open(ctypes.byref(ours), frame, len(data))
    return None if count < 0 else frame.raw[9 : 9 + count]


def test_a_live_nodes_session_opens_what_c_seals(both):
    native, ours, theirs = both
    draw = random.Random(1)
    for counter in range(200):
        data = draw.randbytes(draw.randrange(200))
        made = sealed(native, ours, data)
        assert seal.fields(made) == (FRAME, 0x89ABCDEF, counter)
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


def test_frames_sealed_with_aes_are_aes_256_gcm_under_noises_nonce(native):
    ours, _ = pair(native, is_aes=True)
    for counter in range(3):
        made = sealed(native, ours, b"a sample")
        nonce = bytes(4) + counter.to_bytes(8, "big")
        assert AESGCM(OUT).decrypt(nonce, made[9:], made[:9]) == b"a sample"
    back = in_c.Session(ours.crypto, ours.key_in, ours.key_out, 0x89ABCDEF, 77)
    assert read(native, back, sealed(native, ours, b"and another")) == b"and another"
    assert read(native, back, made[:-1] + b"\0") is None


def test_the_examples_cipher_is_another_implementations(native):
    draw = random.Random(3)
    for size in (*range(70), 127, 128, 129, 500):
        key, nonce, head = draw.randbytes(32), draw.randbytes(12), draw.randbytes(size % 41)
        data = draw.randbytes(size) if size % 7 else bytes([255]) * size  # sums that carry far
        wanted = ChaCha20Poly1305(key).encrypt(nonce, data, head)
        lock = in_c.Lock((ctypes.c_uint8 * 32)(*key), (ctypes.c_uint8 * 12)(*nonce),
                         (ctypes.c_uint8 * max(1, len(head)))(*head), len(head))  # fmt: skip
        place = ctypes.create_string_buffer(data + bytes(16), size + 16)
        native.innervate_example_close(ctypes.byref(lock), place, size)
        assert place.raw == wanted
        assert native.innervate_example_open(ctypes.byref(lock), place, size) == 1
        assert place.raw[:size] == data
        wrong = bytearray(wanted)
        wrong[draw.randrange(size + 16)] ^= 1 << draw.randrange(8)
        place = ctypes.create_string_buffer(bytes(wrong), size + 16)
        assert native.innervate_example_open(ctypes.byref(lock), place, size) == 0


def test_the_examples_hashes_are_pythons(native):
    draw, out = random.Random(4), ctypes.create_string_buffer(32)
    for size in range(270):
        data, key = draw.randbytes(size), draw.randbytes(32)
        native.innervate_example_sha256(out, data, size)
        assert out.raw == hashlib.sha256(data).digest()
        for wanted in (16, 32):
            native.innervate_example_blake2s(out, wanted, key, data, size)
            made = hashlib.blake2s(data, key=key, digest_size=wanted).digest()
            assert out.raw[:wanted] == made


# RFC 7748, 5.2 and 6.1: scalar, point, what comes of it.
CURVE = [
    ("a546e36bf0527c9d3b16154b82465edd62144c0ac1fc5a18506a2244ba449ac4",
     "e6db6867583030db3594c1a424b15f7c726624ec26b3353b10a903a6d0ab1c4c",
     "c3da55379de9c6908e94ea4df28d084f32eccf03491c71f754b4075577a28552"),
    ("4b66e9d4d1b4673c5ad22691957d6af5c11b6421e0ea01d42ca4169e7918ba0d",
     "e5210f12786811d3f4b7959d0538ae2c31dbe7106fc03c3efc4cd549c715a493",
     "95cbde9476e8907d7aade45cb4b873f88b595a68799fa152e6f8f7647aac7957"),
]  # fmt: skip


def curve(native, scalar, point):
    out = ctypes.create_string_buffer(32)
    is_some = native.innervate_example_x25519(out, scalar, point)
    return out.raw, is_some


def test_the_examples_curve_is_the_rfcs(native):
    for case in CURVE:
        scalar, point, wanted = map(bytes.fromhex, case)
        assert curve(native, scalar, point) == (wanted, 1)
    draw = random.Random(5)
    for _ in range(40):
        secret, other = draw.randbytes(32), draw.randbytes(32)
        assert curve(native, secret, (9).to_bytes(32, "little"))[0] == noise.public(secret)
        exchanged = X25519PrivateKey.from_private_bytes(secret).exchange(
            X25519PublicKey.from_public_bytes(other)
        )
        assert curve(native, secret, other) == (exchanged, 1)


def test_a_point_that_says_nothing_is_found(native):
    modulus = 2**255 - 19
    for point in (0, 1, modulus - 1, modulus, modulus + 1):
        assert curve(native, bytes(range(32)), point.to_bytes(32, "little"))[1] == 0
    for point in (modulus + 2, 2**255 - 1, 2**256 - 1):  # no number below it: the rest of it
        said = (point % 2**255 % modulus).to_bytes(32, "little")
        assert curve(native, bytes(range(32)), point.to_bytes(32, "little")) == curve(
            native, bytes(range(32)), said
        )
