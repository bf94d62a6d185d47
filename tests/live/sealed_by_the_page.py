"""The sealed side of a path as somebody else would write it, from docs/wire.md alone.

For a key that all nodes have, with `cryptography` and nothing of ours. It begins every handshake
itself, leaves those of others unanswered, and knows one session at a time.
"""

import hashlib
import hmac
import os
import struct

from cryptography.hazmat.primitives.asymmetric.x25519 import X25519PrivateKey, X25519PublicKey
from cryptography.hazmat.primitives.ciphers.aead import ChaCha20Poly1305

NAME = b"Noise_NNpsk0_25519_ChaChaPoly_SHA256"
PROLOGUE, MESH = b"innervate 2 network ", b"\1"
FIRST, SECOND, FRAME, CONTROL = 0xD0, 0xC1, 0xC3, 0xC5
ARE_YOU_THERE, I_AM = b"\0", b"\1"
ANYBODY = 0xFFFF


def hkdf(chaining, secret, count):
    made, last = hmac.digest(chaining, secret, "sha256"), b""
    found = []
    for k in range(count):
        last = hmac.digest(made, last + bytes((k + 1,)), "sha256")
        found.append(last)
    return found


def nonce(counter):
    return bytes(4) + counter.to_bytes(8, "little")


class Noise:
    """The initiator of NNpsk0; names as in the Noise Protocol Framework."""

    def __init__(self, psk):
        self.h = self.ck = hashlib.sha256(NAME).digest()
        self.mix_hash(PROLOGUE + MESH)
        self.ck, said, self.k = hkdf(self.ck, psk, 3)
        self.mix_hash(said)
        self.n, self.e = 0, X25519PrivateKey.generate()

    def mix_hash(self, data):
        self.h = hashlib.sha256(self.h + data).digest()

    def mix_key(self, secret):
        (self.ck, self.k), self.n = hkdf(self.ck, secret, 2), 0

    def ephemeral(self, public):
        self.mix_hash(public)
        self.mix_key(public)  # as patterns with a psk do

    def first(self, payload):
        public = self.e.public_key().public_bytes_raw()
        self.ephemeral(public)
        sealed = ChaCha20Poly1305(self.k).encrypt(nonce(0), payload, self.h)
        self.mix_hash(sealed)
        return public + sealed

    def second(self, message):
        """The payload, then the keys of what we send and of what we receive."""
        far, sealed = message[:32], message[32:]
        self.ephemeral(far)
        self.mix_key(self.e.exchange(X25519PublicKey.from_public_bytes(far)))
        payload = ChaCha20Poly1305(self.k).decrypt(nonce(0), sealed, self.h)
        return payload, hkdf(self.ck, b"", 2)


class SealedEnd:
    """A cable's end whose frames are sealed; `take(self, frame)` gets those that come in."""

    def __init__(self, end, number, psk, key, take):
        self.end, self.number, self.psk, self.key, self.take = end, number, psk, key, take
        self.mac_key = hashlib.blake2s(b"innervate mac", key=psk).digest()
        self.life, self.counter, self.far = os.urandom(8), 0, None

    def marked(self, data):
        return data + hashlib.blake2s(data, key=self.mac_key, digest_size=16).digest()

    def call(self):
        self.index, self.noise = os.urandom(4), Noise(self.psk)
        about = struct.pack(">HH", self.number, ANYBODY) + self.life + self.index + b"\0\0"
        self.end.send(self.marked(bytes((FIRST + self.key,)) + self.noise.first(about)))

    def send(self, frame, kind=FRAME):
        if self.far is None:
            return  # lost, as on any cable
        head = bytes((kind,)) + self.far + struct.pack(">I", self.counter)
        self.end.send(head + self.out.encrypt(nonce(self.counter), frame, head))
        self.counter += 1

    def came(self, _path, data):
        if data[0] == SECOND and data[1:5] == self.index:
            assert self.marked(data[:-16]) == data
            about, (out, into) = self.noise.second(data[5:-16])
            self.who, self.for_whom = struct.unpack(">HH", about[:4])
            self.far, self.counter = about[12:16], 0
            self.out, self.into = ChaCha20Poly1305(out), ChaCha20Poly1305(into)
            self.send(ARE_YOU_THERE, CONTROL)
        elif data[0] in (FRAME, CONTROL) and self.far is not None and data[1:5] == self.index:
            counter = int.from_bytes(data[5:9], "big")
            plain = self.into.decrypt(nonce(counter), data[9:], data[:9])
            if data[0] == FRAME:
                self.take(self, plain)
            elif plain == ARE_YOU_THERE:
                self.send(I_AM, CONTROL)
