"""Handshakes of the Noise Protocol Framework, revision 34: 25519, ChaChaPoly, SHA256.

Names are the framework's (https://noiseprotocol.org/noise.html). It is imported only by nodes that
have keys, for `cryptography` is.
"""

from __future__ import annotations

import hmac
from collections.abc import Callable
from hashlib import sha256
from typing import NamedTuple

from cryptography.exceptions import InvalidTag
from cryptography.hazmat.primitives.asymmetric.x25519 import X25519PrivateKey, X25519PublicKey
from cryptography.hazmat.primitives.ciphers.aead import ChaCha20Poly1305

KEY_BYTES = 32
TAG_BYTES = 16
NO_NONCE = bytes(4)


class Pattern(NamedTuple):
    """What the messages of a handshake are made of.

    Attributes:
        name: as in the name of the protocol.
        messages: the tokens of each; the initiator's first. A psk0 stands in front of them all.
    """

    name: str
    messages: tuple[tuple[str, ...], ...]


NETWORK = Pattern("NNpsk0", (("e",), ("e", "ee")))
IDENTITY = Pattern("XXpsk0", (("e",), ("e", "ee", "s", "es"), ("s", "se")))


class Broken(Exception):
    """A message that nobody who may has made."""


def nonce(counter: int) -> bytes:
    """The cipher's nonce for a counter."""
    return NO_NONCE + counter.to_bytes(8, "little")


def public(private: bytes) -> bytes:
    """The public key of a private one (X25519)."""
    return X25519PrivateKey.from_private_bytes(private).public_key().public_bytes_raw()


class Symmetric:
    """The chaining key, the hash of all that was said, and the key of payloads.

    Args:
        pattern: of the handshake.
        prologue: what both sides know already, and must agree on.
        psk: the shared key, for patterns that have one.
    """

    def __init__(self, pattern: Pattern, prologue: bytes, psk: bytes = b"") -> None:
        name = f"Noise_{pattern.name}_25519_ChaChaPoly_SHA256".encode()
        self.has_psk = bool(psk)
        self.h = name.ljust(32, b"\0") if len(name) <= 32 else sha256(name).digest()
        self.ck = self.h
        self.k = b""
        self.n = 0
        self.mix_hash(prologue)
        if "psk0" in pattern.name:  # the shared key is the first thing that is mixed in
            self.mix_key_and_hash(psk)

    def copy(self) -> Symmetric:
        """The same, to go on from."""
        other = object.__new__(Symmetric)
        other.__dict__.update(self.__dict__)
        return other

    def mix_hash(self, data: bytes) -> None:
        """Both sides have seen this."""
        self.h = sha256(self.h + data).digest()

    def mix_key(self, secret: bytes) -> None:
        """Whoever goes on knows this."""
        self.ck, self.k = _hkdf(self.ck, secret, 2)
        self.n = 0

    def mix_key_and_hash(self, secret: bytes) -> None:
        """Both of them, for shared keys."""
        self.ck, said, self.k = _hkdf(self.ck, secret, 3)
        self.mix_hash(said)
        self.n = 0

    def encrypt(self, plain: bytes) -> bytes:
        """Encrypt under all that was said, as far as there is a key yet."""
        out = plain
        if self.k:
            out = ChaCha20Poly1305(self.k).encrypt(nonce(self.n), plain, self.h)
            self.n += 1
        self.mix_hash(out)
        return out

    def decrypt(self, data: bytes) -> bytes:
        """The reverse; Broken if it was made by somebody else, or for other words."""
        plain = data
        if self.k:
            try:
                plain = ChaCha20Poly1305(self.k).decrypt(nonce(self.n), data, self.h)
            except InvalidTag:
                raise Broken from None
            self.n += 1
        self.mix_hash(data)
        return plain


class Handshake:
    """One side of a handshake.

    Args:
        pattern: its messages.
        state: begun with the prologue and the shared key.
        is_initiator: True = we write the first message.
        draw: random bytes for the ephemeral key.
        static: our private key, where the pattern sends one.
        psk: the shared key, where it comes later than at the beginning.

    Attributes:
        far_static: the other's public key, once it was sent.
        is_done: no more messages are to come.
    """

    def __init__(
        self,
        pattern: Pattern,
        state: Symmetric,
        is_initiator: bool,
        draw: Callable[[int], bytes],
        static: bytes = b"",
        psk: bytes = b"",
    ) -> None:
        self._messages = pattern.messages
        self._state = state.copy()
        self._is_initiator = is_initiator
        self._draw = draw
        self._keys = {"s": static, "e": b""}
        self._far = {"s": b"", "e": b""}
        self._psk = psk
        self._at = 0

    @property
    def far_static(self) -> bytes:
        """The other's public key; empty as long as it is not known."""
        return self._far["s"]

    @property
    def is_done(self) -> bool:
        """True when all messages were written and read."""
        return self._at == len(self._messages)

    @property
    def hash(self) -> bytes:
        """The hash of all that was said."""
        return self._state.h

    def write(self, payload: bytes) -> bytes:
        """The next message, which is ours, with a payload."""
        out = b""
        for token in self._messages[self._at]:
            if token == "e":
                self._keys["e"] = self._draw(KEY_BYTES)
                own = public(self._keys["e"])
                self._mix_ephemeral(own)
                out += own
            elif token == "s":
                out += self._state.encrypt(public(self._keys["s"]))
            else:
                self._mix(token)
        self._at += 1
        return out + self._state.encrypt(payload)

    def read(self, data: bytes) -> bytes:
        """The payload of the next message, the other's.

        Raises:
            Broken: it is none; this handshake cannot go on.
        """
        for token in self._messages[self._at]:
            if token not in ("e", "s"):
                self._mix(token)
                continue
            size = KEY_BYTES + (TAG_BYTES if token == "s" and self._state.k else 0)
            part, data = data[:size], data[size:]
            if len(part) < size:
                raise Broken
            if token == "e":
                self._far["e"] = part
                self._mix_ephemeral(part)
            else:
                self._far["s"] = self._state.decrypt(part)
        self._at += 1
        return self._state.decrypt(data)

    def split(self) -> tuple[bytes, bytes]:
        """The keys of what we send, and of what we receive."""
        assert self.is_done
        first, second = _hkdf(self._state.ck, b"", 2)
        return (first, second) if self._is_initiator else (second, first)

    def _mix_ephemeral(self, key: bytes) -> None:
        self._state.mix_hash(key)
        if self._state.has_psk:
            self._state.mix_key(key)

    def _mix(self, token: str) -> None:
        if token == "psk":
            self._state.mix_key_and_hash(self._psk)
            return
        ours, theirs = token[not self._is_initiator], token[self._is_initiator]
        try:
            private = X25519PrivateKey.from_private_bytes(self._keys[ours])
            far = X25519PublicKey.from_public_bytes(self._far[theirs])
            secret = private.exchange(far)
        except ValueError:  # a point of low order
            raise Broken from None
        self._state.mix_key(secret)


def _hkdf(ck: bytes, secret: bytes, count: int) -> tuple[bytes, ...]:
    key = hmac.digest(ck, secret, "sha256")
    out: list[bytes] = []
    for k in range(count):
        last = out[-1] if out else b""
        out.append(hmac.digest(key, last + bytes([k + 1]), "sha256"))
    return tuple(out)
