"""Identities: keys of one node, and a certificate by which its network's authority knows them.

A node proves that it has the private keys; nobody needs a list of all. What was given to a node
that is lost is put out by a list of serial numbers that the authority signs.
"""

import struct
from pathlib import Path
from typing import NamedTuple

from cryptography.exceptions import InvalidSignature
from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey, Ed25519PublicKey

from innervate.live import noise, plain
from innervate.live.errors import LiveError
from innervate.live.machine import machine

SIGNATURE_BYTES = 64
CERTIFICATE = struct.Struct(">I32s64s")  # serial, key of signatures, the authority's signature
SIGNED = struct.Struct(">HI32s32s")  # number, serial, key of handshakes, key of signatures
REVOKED = struct.Struct(">IH")  # version, how many serials follow
REVOKED_MAX = 64
FOR_NODES = b"innervate certificate 1\0"
FOR_REVOKED = b"innervate revoked 1\0"
NONE = "not a node's identity; make one with: innervate live enrol"
SIZES = {"authority": 32, "shared": 32, "exchange": 32, "signing": 32, "signature": 64}
NUMBERS = {"number": 65_534, "serial": 2**32 - 1}  # the greatest


class Identity(NamedTuple):
    """What a node's own file holds.

    Attributes:
        number: the node's.
        serial: of its certificate.
        authority: public key of who enrols nodes (Ed25519).
        shared: known to all nodes of the network: keeps strangers from making work.
        exchange: private key of handshakes (X25519).
        signing: private key of what it says to a group (Ed25519).
        signature: of the authority, on number, serial and both public keys.
    """

    number: int
    serial: int
    authority: bytes
    shared: bytes
    exchange: bytes
    signing: bytes
    signature: bytes

    @property
    def certificate(self) -> bytes:
        """What others are shown of it."""
        return CERTIFICATE.pack(self.serial, signing_public(self.signing), self.signature)

    def text(self) -> str:
        """The file that holds it."""
        lines = ["# Whoever has this file is this node. Made by: innervate live enrol"]
        lines += [f"number = {self.number}", f"serial = {self.serial}"]
        lines += [f'{name} = "{getattr(self, name).hex()}"' for name in SIZES]
        return "\n".join(lines) + "\n"


class Revoked(NamedTuple):
    """Which serials are put out.

    Attributes:
        version: a list with a greater one takes this one's place.
        serials: of certificates.
        data: as it is handed on, signed; empty = there is no list yet.
    """

    version: int = 0
    serials: frozenset[int] = frozenset()
    data: bytes = b""


def signing_public(private: bytes) -> bytes:
    """The public key of a private one (Ed25519)."""
    return Ed25519PrivateKey.from_private_bytes(private).public_key().public_bytes_raw()


def is_signed(key: bytes, signature: bytes, data: bytes) -> bool:
    """True if the owner of a public key has signed this."""
    try:
        Ed25519PublicKey.from_public_bytes(key).verify(signature, data)
    except (InvalidSignature, ValueError):
        return False
    return True


def enrol(authority: bytes, number: int, serial: int, shared: bytes) -> Identity:
    """A new identity, with keys that are drawn now; `authority` is its private key."""
    exchange, signing = (machine().chance.randbytes(32) for _ in range(2))
    signed = SIGNED.pack(number, serial, noise.public(exchange), signing_public(signing))
    signature = Ed25519PrivateKey.from_private_bytes(authority).sign(FOR_NODES + signed)
    public = signing_public(authority)
    return Identity(number, serial, public, shared, exchange, signing, signature)


def check(authority: bytes, number: int, exchange: bytes, certificate: bytes) -> tuple[int, bytes]:
    """(serial, key of signatures) of a certificate that was shown with a number and a key.

    Raises:
        ValueError: the authority has not said that these belong together.
    """
    if len(certificate) != CERTIFICATE.size:
        raise ValueError("no certificate")
    serial, signing, signature = CERTIFICATE.unpack(certificate)
    if not is_signed(
        authority, signature, FOR_NODES + SIGNED.pack(number, serial, exchange, signing)
    ):
        raise ValueError("not of our authority")
    return serial, signing


def revoke(authority: bytes, version: int, serials: frozenset[int]) -> Revoked:
    """A list of certificates that are put out, signed."""
    body = REVOKED.pack(version, len(serials))
    body += b"".join(serial.to_bytes(4, "big") for serial in sorted(serials))
    signature = Ed25519PrivateKey.from_private_bytes(authority).sign(FOR_REVOKED + body)
    return Revoked(version, serials, body + signature)


def read_revoked(authority: bytes, data: bytes) -> Revoked:
    """A list that somebody hands on; ValueError if the authority has not signed it."""
    body, signature = data[:-SIGNATURE_BYTES], data[-SIGNATURE_BYTES:]
    if len(body) < REVOKED.size:
        raise ValueError("no list of revoked nodes")
    version, count = REVOKED.unpack_from(body)
    if count > REVOKED_MAX or len(body) != REVOKED.size + 4 * count:
        raise ValueError("no list of revoked nodes")
    if not is_signed(authority, signature, FOR_REVOKED + body):
        raise ValueError("a list of revoked nodes that our authority has not signed")
    rest = body[REVOKED.size :]
    serials = (int.from_bytes(rest[k : k + 4], "big") for k in range(0, len(rest), 4))
    return Revoked(version, frozenset(serials), data)


def load(path: Path, number: int) -> Identity:
    """The identity of a node.

    Raises:
        LiveError: the file cannot be read, is none, or is another node's.
    """
    text = plain.text(path, NONE, "the identity ")
    try:
        raw = plain.read(text)
        found, serial = (plain.whole(raw, name, most) for name, most in NUMBERS.items())
        keys = {name: plain.octets(raw, name, size) for name, size in SIZES.items()}
        own = Identity(found, serial, **keys)
        public = noise.public(own.exchange)
    except ValueError as error:
        raise LiveError(f"{path}: {error}; {NONE}") from None
    try:
        check(own.authority, own.number, public, own.certificate)
    except ValueError:
        raise LiveError(
            f"{path}: signature: not authority's on number, serial, exchange and signing; {NONE}"
        ) from None
    if own.number != number:
        raise LiveError(f"{path}: the identity of node {own.number}, but number = {number} here")
    return own
