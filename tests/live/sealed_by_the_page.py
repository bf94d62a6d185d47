"""The sealed side of a path as somebody else would write it, from docs/wire.md alone.

With a key that all nodes have or an identity, by `cryptography` and nothing of ours. It begins
every handshake itself, leaves those of others unanswered, and knows one session at a time.
"""

import hashlib
import hmac
import os
import struct
import tomllib

from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey, Ed25519PublicKey
from cryptography.hazmat.primitives.asymmetric.x25519 import X25519PrivateKey, X25519PublicKey
from cryptography.hazmat.primitives.ciphers.aead import ChaCha20Poly1305

NAME = b"Noise_%s_25519_ChaChaPoly_SHA256"
PROLOGUE, MESH = b"innervate 2 network ", b"\1"
CERTIFICATE = b"innervate certificate 1\0"
FIRST, SECOND, THIRD, FRAME, CONTROL = 0xD0, 0xC1, 0xC2, 0xC3, 0xC5
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
    """The initiator of NNpsk0, or with a static key of XXpsk0; names as in the framework."""

    def __init__(self, psk, static=None):
        self.h = self.ck = hashlib.sha256(NAME % (b"XXpsk0" if static else b"NNpsk0")).digest()
        self.mix_hash(PROLOGUE + MESH)
        self.ck, said, self.k = hkdf(self.ck, psk, 3)
        self.mix_hash(said)
        self.n, self.e, self.s, self.far_s = 0, X25519PrivateKey.generate(), static, b""

    def mix_hash(self, data):
        self.h = hashlib.sha256(self.h + data).digest()

    def mix_key(self, secret):
        (self.ck, self.k), self.n = hkdf(self.ck, secret, 2), 0

    def ephemeral(self, public):
        self.mix_hash(public)
        self.mix_key(public)  # as patterns with a psk do

    def encrypt(self, plain):
        sealed = ChaCha20Poly1305(self.k).encrypt(nonce(self.n), plain, self.h)
        self.mix_hash(sealed)
        self.n += 1
        return sealed

    def decrypt(self, sealed):
        plain = ChaCha20Poly1305(self.k).decrypt(nonce(self.n), sealed, self.h)
        self.mix_hash(sealed)
        self.n += 1
        return plain

    def first(self, payload):
        public = self.e.public_key().public_bytes_raw()
        self.ephemeral(public)
        return public + self.encrypt(payload)

    def second(self, message):
        self.far_e, sealed = X25519PublicKey.from_public_bytes(message[:32]), message[32:]
        self.ephemeral(message[:32])
        self.mix_key(self.e.exchange(self.far_e))
        if self.s:
            self.far_s, sealed = self.decrypt(sealed[:48]), sealed[48:]
            self.mix_key(self.e.exchange(X25519PublicKey.from_public_bytes(self.far_s)))
        return self.decrypt(sealed)

    def third(self, payload):
        sealed = self.encrypt(self.s.public_key().public_bytes_raw())
        self.mix_key(self.s.exchange(self.far_e))
        return sealed + self.encrypt(payload)

    def split(self):
        """The ciphers of what we send, and of what we receive."""
        return map(ChaCha20Poly1305, hkdf(self.ck, b"", 2))


class Identity:
    """What an identity's file holds, as its lines say."""

    def __init__(self, text):
        told = tomllib.loads(text)
        keys = {name: bytes.fromhex(text) for name, text in told.items() if isinstance(text, str)}
        self.shared, self.authority = keys["shared"], keys["authority"]
        self.exchange = X25519PrivateKey.from_private_bytes(keys["exchange"])
        signing = Ed25519PrivateKey.from_private_bytes(keys["signing"])
        public = signing.public_key().public_bytes_raw()
        self.certificate = struct.pack(">I", told["serial"]) + public + keys["signature"]

    def check(self, number, exchange, certificate):
        """That the authority has signed the certificate of a neighbour, with its key."""
        said, signature = certificate[:36], certificate[36:]
        signed = CERTIFICATE + struct.pack(">H", number) + said[:4] + exchange + said[4:]
        Ed25519PublicKey.from_public_bytes(self.authority).verify(signature, signed)


class SealedEnd:
    """A cable's end whose frames are sealed; `take(self, frame)` gets those that come in."""

    def __init__(self, end, number, psk, key, take, identity=None):
        self.end, self.number, self.psk, self.key, self.take = end, number, psk, key, take
        self.identity = identity
        self.mac_key = hashlib.blake2s(b"innervate mac", key=psk).digest()
        self.life, self.counter, self.far = os.urandom(8), 0, None

    def marked(self, data):
        return data + hashlib.blake2s(data, key=self.mac_key, digest_size=16).digest()

    def about(self, whom):
        return struct.pack(">HH", self.number, whom) + self.life + self.index + b"\0\0"

    def call(self):
        static = self.identity and self.identity.exchange
        self.index, self.noise = os.urandom(4), Noise(self.psk, static)
        message = self.noise.first(self.about(ANYBODY))
        self.end.send(self.marked(bytes((FIRST + self.key,)) + message))

    def send(self, frame, kind=FRAME):
        if self.far is None:
            return  # lost, as on any cable
        head = bytes((kind,)) + self.far + struct.pack(">I", self.counter)
        self.end.send(head + self.out.encrypt(nonce(self.counter), frame, head))
        self.counter += 1

    def came(self, _path, data):
        if data[0] == SECOND and data[1:5] == self.index:
            assert self.marked(data[:-16]) == data
            about = self.noise.second(data[5:-16])
            self.who, self.for_whom = struct.unpack(">HH", about[:4])
            self.far, self.counter = about[12:16], 0
            if self.identity:
                self.identity.check(self.who, self.noise.far_s, about[-100:])
                message = self.noise.third(self.about(self.who) + self.identity.certificate)
                self.end.send(self.marked(bytes((THIRD,)) + self.far + message))
            self.out, self.into = self.noise.split()
            self.send(ARE_YOU_THERE, CONTROL)
        elif data[0] in (FRAME, CONTROL) and self.far is not None and data[1:5] == self.index:
            counter = int.from_bytes(data[5:9], "big")
            plain = self.into.decrypt(nonce(counter), data[9:], data[:9])
            if data[0] == FRAME:
                self.take(self, plain)
            elif plain == ARE_YOU_THERE:
                self.send(I_AM, CONTROL)
