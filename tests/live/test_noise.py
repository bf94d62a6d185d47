"""Handshakes against vectors: cacophony's, which other implementations play, too.

That of XXpsk0, which is not among them, is what the package noiseprotocol 0.3.1 says with the keys
of XXpsk3; with these it says what was published of XXpsk3.
"""

import json
import secrets
from pathlib import Path

import pytest
from cryptography.hazmat.primitives.ciphers.aead import ChaCha20Poly1305

from innervate.live import noise
from innervate.live.noise import Broken, Handshake, Pattern, Symmetric

VECTORS = json.loads((Path(__file__).parents[1] / "fixtures" / "noise.json").read_text())
XX = (("e",), ("e", "ee", "s", "es"), ("s", "se"))
PATTERNS = {
    "NNpsk0": noise.NETWORK,
    "XXpsk0": noise.IDENTITY,
    "XX": Pattern("XX", XX),
    "XXpsk3": Pattern("XXpsk3", (*XX[:2], ("s", "se", "psk"))),
}


def side(vector, name, which):
    take = {key: bytes.fromhex(vector[f"{which}_{key}"]) for key in ("prologue", "ephemeral")}
    psk = bytes.fromhex(vector.get(f"{which}_psks", [""])[0])
    static = bytes.fromhex(vector.get(f"{which}_static", ""))
    state = Symmetric(PATTERNS[name], take["prologue"], psk)
    ours = which == "init"
    return Handshake(PATTERNS[name], state, ours, lambda _count: take["ephemeral"], static, psk)


@pytest.mark.parametrize("name", PATTERNS)
def test_vectors(name):
    vector = VECTORS[name]
    sides = [side(vector, name, which) for which in ("init", "resp")]
    messages = [{key: bytes.fromhex(value) for key, value in one.items()}
                for one in vector["messages"]]  # fmt: skip
    count = len(PATTERNS[name].messages)
    for k, message in enumerate(messages[:count]):
        writer, reader = sides[k % 2], sides[1 - k % 2]
        assert writer.write(message["payload"]) == message["ciphertext"]
        assert reader.read(message["ciphertext"]) == message["payload"]
    assert sides[0].hash == sides[1].hash == bytes.fromhex(vector["handshake_hash"])
    (a_send, a_take), (b_send, b_take) = (one.split() for one in sides)
    assert (a_send, a_take) == (b_take, b_send)
    for k, message in enumerate(messages[count:], count):
        key = (a_send, b_send)[k % 2]
        counter = noise.nonce((k - count) // 2)
        assert (
            ChaCha20Poly1305(key).encrypt(counter, message["payload"], b"")
            == (message["ciphertext"])
        )


def test_identities_and_a_shared_key_together():
    """Each side learns the other's key, and what one sends with, the other takes with."""
    draws = iter(bytes([k]) * 32 for k in range(1, 5))
    state = Symmetric(noise.IDENTITY, b"here", bytes(32))
    a, b = (Handshake(noise.IDENTITY, state, first, lambda _count: next(draws), bytes([key]) * 32)
            for first, key in ((True, 70), (False, 80)))  # fmt: skip
    for writer, reader in ((a, b), (b, a), (a, b)):
        assert reader.read(writer.write(b"payload")) == b"payload"
    assert a.split() == b.split()[::-1]
    assert (a.far_static, b.far_static) == tuple(noise.public(bytes([key]) * 32)
                                                 for key in (80, 70))  # fmt: skip


@pytest.mark.parametrize("at", [0, 31, 32, 40, -1])
@pytest.mark.parametrize("name", ["NNpsk0", "XXpsk0"])
def test_no_byte_of_a_handshake_can_be_changed(name, at):
    pattern = {"NNpsk0": noise.NETWORK, "XXpsk0": noise.IDENTITY}[name]
    for k in range(len(pattern.messages)):
        state = Symmetric(pattern, b"", bytes(32))
        sides = [Handshake(pattern, state, first, _draw, bytes([9 + first]) * 32)
                 for first in (True, False)]  # fmt: skip
        for turn in range(k):
            sides[1 - turn % 2].read(sides[turn % 2].write(b"12345678"))
        data = bytearray(sides[k % 2].write(b"12345678"))
        data[at] ^= 1
        with pytest.raises(Broken):
            sides[1 - k % 2].read(bytes(data))


@pytest.mark.parametrize("far", [bytes(32), b"\1" + bytes(31), b"short", b""])
def test_points_of_low_order_and_short_messages_are_refused(far):
    state = Symmetric(noise.NETWORK, b"", bytes(32))

    def answer():
        b = Handshake(noise.NETWORK, state, False, _draw)
        b.read(far)
        b.write(b"")

    def go_on():
        a = Handshake(noise.NETWORK, state, True, _draw)
        a.write(b"")
        a.read(far.ljust(64, b"\0"))

    for do in (answer, go_on):
        with pytest.raises(Broken):
            do()


def _draw(count):
    return secrets.token_bytes(count)
